// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::io {

/// What VTK's XML readers do not survive or notice, checked before they see the file (.vtp): an end that is
/// missing (they return whatever was in memory), compressed blocks of size zero (they divide by it), and more or larger
/// blocks than the file can hold (they allocate them), and arrays of a type there is none of (they use a null pointer).
///
/// Call it under LibraryMessages. Throws Error(bad_file).
void require_readable_vtk_xml(const std::filesystem::path& path);

}  // namespace isoatlas::io
