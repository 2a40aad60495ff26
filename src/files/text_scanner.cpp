// SPDX-License-Identifier: Apache-2.0
#include "files/text_scanner.h"

#include <charconv>

#include "files/file_error.h"

namespace isoatlas::io {

namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

template <class Number>
bool parse(std::string_view word, Number& value) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);  // from_chars takes no plus sign
  }
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

}  // namespace

bool TextScanner::next_line() {
  if (rest_.empty()) {
    line_ = {};
    return false;
  }
  const std::size_t end = rest_.find('\n');
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
      throw error("the file ends here, more data was promised");
    }
  }
}

double TextScanner::number(std::string_view what) { return to_number(word(), what); }

std::int64_t TextScanner::integer(std::string_view what) { return to_integer(word(), what); }

double TextScanner::to_number(std::string_view word, std::string_view what) const {
  double value = 0;
  if (!parse(word, value)) {
    throw error("found '" + one_line(word, 40) + "', expected " + std::string(what));
  }
  return value;
}

std::int64_t TextScanner::to_integer(std::string_view word, std::string_view what) const {
  std::int64_t value = 0;
  if (!parse(word, value)) {
    throw error("found '" + one_line(word, 40) + "', expected " + std::string(what));
  }
  return value;
}

Error TextScanner::error(std::string_view what) const {
  return bad_file(path_, "line " + std::to_string(line_number_) + ": " + std::string(what));
}

}  // namespace isoatlas::io
