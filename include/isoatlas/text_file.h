// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "isoatlas/export.h"

namespace isoatlas {

/// Reads text. Throws Error(bad_file).
ISOATLAS_API std::string read_text_file(const std::filesystem::path& path);

/// Writes text whole or not at all (beside, then rename). Throws Error(bad_file).
ISOATLAS_API void write_text_file(const std::string& text, const std::filesystem::path& path);

}  // namespace isoatlas
