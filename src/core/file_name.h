// SPDX-License-Identifier: Apache-2.0
// Names of files and words, compared without regard to case.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/ranges.h"

namespace isoatlas::detail {

/// The text with ASCII letters in lower case; all other bytes are unchanged, in every locale.
inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

/// The extension in lower case, with its dot: ".nrrd"; empty if the name has none.
inline std::string lower_case_extension(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

/// Whether the file's name, in any case, ends with one of `extensions`, which are separated by
/// blanks: ".nii .nii.gz".
inline bool has_extension(const std::filesystem::path& path, std::string_view extensions) {
  const std::string file_name = lower_case(path.filename().string());
  while (!extensions.empty()) {
    const std::string_view extension = extensions.substr(0, extensions.find(' '));
    if (file_name.ends_with(extension)) return true;
    extensions.remove_prefix(std::min(extension.size() + 1, extensions.size()));
  }
  return false;
}

}  // namespace isoatlas::detail
