// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "isoatlas/export.h"

namespace isoatlas {

/// Reads a whole file. O(bytes)
/// @throws Error(bad_file) if it cannot be read
ISOATLAS_API std::string read_text_file(const std::filesystem::path& path);

/// Writes a file completely or not at all: a temporary file next to `path` is renamed when it is
/// complete. O(bytes)
/// @throws Error(bad_file) if it cannot be written
ISOATLAS_API void write_text_file(const std::string& text, const std::filesystem::path& path);

}  // namespace isoatlas
