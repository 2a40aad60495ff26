// SPDX-License-Identifier: Apache-2.0
// ZIP archives, by libzip, as the packages that 3MF and office programs keep their parts in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas::detail::io {

/// The bytes of an archive with these parts (name, content), compressed, in this order. Every part
/// has the same date, so the same parts give the same bytes. @throws Error(bad_file) naming `path`
/// if libzip fails
std::string zip_bytes(const std::vector<std::pair<std::string, std::string>>& parts,
                      const std::filesystem::path& path);

/// Reads parts of an archive.
class ZipReader {
 public:
  /// @throws Error(bad_file) if the file is no ZIP archive
  explicit ZipReader(const std::filesystem::path& path);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  /// The whole content of a part; its checksum is checked.
  /// @throws Error(bad_file) if there is no such part, or it is damaged; Error(out_of_memory) if it
  /// has more than `most_bytes` bytes
  std::string part(const std::string& name, std::uint64_t most_bytes) const;

  /// At most so many bytes of its beginning.
  std::string beginning_of_part(const std::string& name, std::uint64_t bytes) const;

 private:
  struct Archive;
  std::filesystem::path path_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace isoatlas::detail::io
