// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::detail::io {

/// The folder for temporary files: $TMPDIR, otherwise /tmp.
std::filesystem::path temporary_folder();

/// Makes a file there for reading and writing, and deletes it at once, so that nothing is left
/// however this process ends.
/// @return its descriptor, which the caller closes; negative if it cannot be made (errno)
int open_unnamed_file();

}  // namespace isoatlas::detail::io
