// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::io {

/// Walks through a text file by lines and blank-separated words, for readers whose errors name the line.
/// The text outlives the scanner. Numbers are read the same in every locale.
class TextScanner {
 public:
  TextScanner(std::string_view text, std::filesystem::path path) : rest_(text), path_(std::move(path)) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);  // byte order mark of UTF-8
  }

  /// Steps to the next line; false at the end of the text.
  bool next_line();

  /// The next word of this line; empty at its end.
  std::string_view word();

  /// The next word of the text, from later lines if need be. Throws Error(bad_file) at the end of the text.
  std::string_view next_word();

  /// The next word of this line as a number. Throws Error(bad_file) naming `what` if it is not one.
  double number(std::string_view what);
  std::int64_t integer(std::string_view what);

  double to_number(std::string_view word, std::string_view what) const;
  std::int64_t to_integer(std::string_view word, std::string_view what) const;

  /// "<path>: line 12: <what>"
  Error error(std::string_view what) const;

  /// Bytes after this line.
  std::size_t remaining() const { return rest_.size(); }

 private:
  std::string_view rest_;  // after this line
  std::string_view line_;  // what is left of this line
  std::size_t line_number_ = 0;
  std::filesystem::path path_;
};

}  // namespace isoatlas::io
