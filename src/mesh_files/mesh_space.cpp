// SPDX-License-Identifier: Apache-2.0
// The space of the coordinates that a mesh file states. As in 3D Slicer: "SPACE=RAS" in a comment
// or in the header, in .vtp a text field of that name.

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "mesh_files/formats.h"

namespace isoatlas::detail::io {
namespace {

constexpr std::size_t kCommentBytes = 4096;  // bytes; comments are at the beginning of a file
constexpr std::string_view kKey = "SPACE=";

std::string space_in_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kCommentBytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  std::size_t found = text.find(kKey);
  while (found != std::string::npos && found > 0 &&
         std::isalnum(static_cast<unsigned char>(text[found - 1])) != 0) {
    found = text.find(kKey, found + 1);  // skips COLORSPACE=
  }
  if (found == std::string::npos) return {};
  const auto first = text.begin() + static_cast<std::ptrdiff_t>(found + kKey.size());
  return {first,
          std::find_if_not(first, text.end(), [](unsigned char c) { return std::isalpha(c); })};
}

}  // namespace

MeshFileInfo info_in_text(const std::filesystem::path& path) {
  return {.space = space_in_text(path), .comment = ""};
}

}  // namespace isoatlas::detail::io
