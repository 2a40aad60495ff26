// SPDX-License-Identifier: Apache-2.0
// Words and lines of a file that may also hold binary data; only a part of it is in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::io {

class FileText {
 public:
  static constexpr std::size_t kLongestWord = 1024;

  /// Reads the bytes of the file in [begin, end).
  /// @throws Error(bad_file) if the file cannot be opened
  explicit FileText(const std::filesystem::path& path, std::uint64_t begin = 0,
                    std::uint64_t end = std::numeric_limits<std::int64_t>::max());

  /// The next word, delimited by blanks and line ends, valid until the next call; empty at the end.
  /// Words longer than kLongestWord are cut.
  std::string_view word();

  /// The rest of the line without its end, \n or \r\n; at most kLongestWord bytes of it.
  std::string line();

  /// The position of the first byte that neither word() nor line() has returned.
  std::uint64_t position() const { return buffer_position_ + first_; }
  void seek(std::uint64_t position);

 private:
  bool fill();

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t end_;
  std::vector<char> buffer_;
  std::uint64_t buffer_position_ = 0;  // in the file
  std::size_t first_ = 0, last_ = 0;   // range of the unread bytes in the buffer
};

}  // namespace isoatlas::detail::io
