// SPDX-License-Identifier: Apache-2.0
// The space and the unit of the coordinates that a mesh file states. As in 3D Slicer: "SPACE=RAS"
// in a comment or in the header, in .vtp a text field of that name. "UNIT=mm" is our own addition.

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "isoatlas/length_unit.h"
#include "mesh_files/formats.h"

namespace isoatlas::detail::io {
namespace {

constexpr std::size_t kCommentBytes = 4096;  // bytes; comments are at the beginning of a file

std::string beginning_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kCommentBytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

/// The letters after the first `key`, such as "SPACE="; empty if it is missing.
std::string word_after(std::string_view key, const std::string& text) {
  std::size_t found = text.find(key);
  while (found != std::string::npos && found > 0 &&
         std::isalnum(static_cast<unsigned char>(text[found - 1])) != 0) {
    found = text.find(key, found + 1);  // skips COLORSPACE=
  }
  if (found == std::string::npos) return {};
  const auto first = text.begin() + static_cast<std::ptrdiff_t>(found + key.size());
  return {first,
          std::find_if_not(first, text.end(), [](unsigned char c) { return std::isalpha(c); })};
}

}  // namespace

MeshFileInfo info_in_text(const std::filesystem::path& path) {
  const std::string text = beginning_of(path);
  return {.space = word_after("SPACE=", text),
          .comment = "",
          .unit = length_unit_named(word_after("UNIT=", text))};
}

}  // namespace isoatlas::detail::io
