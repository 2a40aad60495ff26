// SPDX-License-Identifier: Apache-2.0
// ZIP archives by libzip. The packages of 3MF and of office programs are ZIP archives.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas::detail::io {

/// The bytes of an archive with these parts (name, content), compressed, in this order. Every part
/// has the same date, so equal parts give equal bytes. @throws Error(bad_file) naming `path` if
/// libzip fails
std::string zip_bytes(const std::vector<std::pair<std::string, std::string>>& parts,
                      const std::filesystem::path& path);

/// Reads parts of an archive.
class ZipReader {
 public:
  /// @throws Error(bad_file) if the file is not a ZIP archive
  explicit ZipReader(const std::filesystem::path& path);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  /// The whole content of a part; its checksum is verified.
  /// @throws Error(bad_file) if the part is missing or damaged; Error(out_of_memory) if it is
  /// larger than `most_bytes`
  std::string part(const std::string& name, std::uint64_t most_bytes) const;

  /// The first `bytes` bytes of a part, or all of a shorter part.
  std::string beginning_of_part(const std::string& name, std::uint64_t bytes) const;

 private:
  struct Archive;
  std::filesystem::path path_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace isoatlas::detail::io
