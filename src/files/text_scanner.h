// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::detail::io {

/// Reads a text file by lines and blank-separated words, for readers whose errors name the line.
/// The text must outlive the scanner. Numbers are read the same in every locale.
class TextScanner {
 public:
  /// @param lines_before  number of lines of the file before `text`
  TextScanner(std::string_view text, std::filesystem::path path, std::size_t lines_before = 0);

  /// Advances to the next line; false at the end of the text.
  bool next_line();

  /// The next word of this line; empty at its end.
  std::string_view word();

  /// The next word of the text, on this line or a later one. Throws Error(bad_file) at the end of
  /// the text.
  std::string_view next_word();

  /// The next word of this line as a number. Throws Error(bad_file) naming `what` if it is not one.
  double number(std::string_view what);
  std::int64_t integer(std::string_view what);

  double to_number(std::string_view word, std::string_view what) const;
  std::int64_t to_integer(std::string_view word, std::string_view what) const;

  /// "<path>: line 12: <what>"
  Error error(std::string_view what) const;

  /// The number of this line in the file, from 1.
  std::size_t line_number() const { return line_number_; }

  /// The number of bytes after this line.
  std::size_t remaining() const { return rest_.size(); }

 private:
  std::string_view rest_;  // after this line
  std::string_view line_;  // what is left of this line
  char line_end_;
  std::size_t line_number_;
  std::filesystem::path path_;
};

}  // namespace isoatlas::detail::io
