// SPDX-License-Identifier: Apache-2.0
#include "files/text_scanner.h"

#include "files/file_error.h"
#include "files/number_text.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

// Line ends are \n, \r\n (whose \r counts as a blank), or \r in files of old Macs. The first line
// end in the text decides which.
char line_end_of(std::string_view text) {
  const std::size_t first = text.find_first_of("\r\n");
  const bool is_old_mac =
      first < text.size() && text[first] == '\r' && !text.substr(first).starts_with("\r\n");
  return is_old_mac ? '\r' : '\n';
}

}  // namespace

TextScanner::TextScanner(std::string_view text, std::filesystem::path path,
                         std::size_t lines_before)
    : rest_(text),
      line_end_(line_end_of(text)),
      line_number_(lines_before),
      path_(std::move(path)) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);  // byte order mark of UTF-8
}

bool TextScanner::next_line() {
  if (rest_.empty()) {
    line_ = {};
    return false;
  }
  const std::size_t end = rest_.find(line_end_);
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++line_number_;
  return true;
}

std::string_view TextScanner::word() {
  const std::size_t first = line_.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    line_ = {};
    return {};
  }
  line_.remove_prefix(first);
  const std::string_view word = line_.substr(0, line_.find_first_of(kBlanks));
  line_.remove_prefix(word.size());
  return word;
}

std::string_view TextScanner::next_word() {
  for (;;) {
    if (const std::string_view found = word(); !found.empty()) {
      return found;
    }
    if (!next_line()) {
      throw error("the file ends here, expected more data");
    }
  }
}

double TextScanner::number(std::string_view what) { return to_number(word(), what); }

std::int64_t TextScanner::integer(std::string_view what) { return to_integer(word(), what); }

double TextScanner::to_number(std::string_view word, std::string_view what) const {
  double value = 0;
  if (!parse_number(word, value)) {
    throw error("found '" + one_line(word, 40) + "', expected " + std::string(what));
  }
  return value;
}

std::int64_t TextScanner::to_integer(std::string_view word, std::string_view what) const {
  std::int64_t value = 0;
  if (!parse_number(word, value)) {
    throw error("found '" + one_line(word, 40) + "', expected " + std::string(what));
  }
  return value;
}

Error TextScanner::error(std::string_view what) const {
  return bad_file(path_, "line " + std::to_string(line_number_) + ": " + std::string(what));
}

}  // namespace isoatlas::detail::io
