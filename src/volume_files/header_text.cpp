// SPDX-License-Identifier: Apache-2.0
#include "volume_files/header_text.h"

#include <algorithm>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/number_text.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

template <class Number>
std::optional<Number> parsed(std::string_view word) {
  Number value{};
  return parse_number(word, value) ? std::optional(value) : std::nullopt;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string padded(std::int64_t number, std::string_view flags) {
  const bool pads_with_zeros = flags.starts_with('0');
  const auto width = static_cast<std::size_t>(integer_of(flags).value_or(0));
  std::string digits = std::to_string(number < 0 ? -number : number);
  const std::size_t length = digits.size() + (number < 0 ? 1 : 0);
  const std::string padding(
      std::min<std::size_t>(width, 64) > length ? std::min<std::size_t>(width, 64) - length : 0,
      pads_with_zeros ? '0' : ' ');
  const std::string sign = number < 0 ? "-" : "";
  return pads_with_zeros ? sign + padding + digits : padding + sign + digits;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos
             ? std::string_view()
             : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> words_of(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> words;
  for (std::size_t first = text.find_first_not_of(separators); first != std::string_view::npos;
       first = text.find_first_not_of(separators, first)) {
    const std::size_t end = std::min(text.find_first_of(separators, first), text.size());
    words.push_back(text.substr(first, end - first));
    first = end;
  }
  return words;
}

std::optional<double> number_of(std::string_view word) { return parsed<double>(word); }

std::optional<std::int64_t> integer_of(std::string_view word) { return parsed<std::int64_t>(word); }

std::optional<std::string> numbered_name(std::string_view pattern, std::int64_t number) {
  std::string name;
  std::size_t placeholders = 0;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '%') {
      name += pattern[i];
      continue;
    }
    std::size_t end = i + 1;
    while (end < pattern.size() && is_digit(pattern[end])) {
      ++end;
    }
    const char conversion = end < pattern.size() ? pattern[end] : '\0';
    if (conversion == '%' && end == i + 1) {
      name += '%';
    } else if (conversion == 'd' || conversion == 'i' || conversion == 'u') {
      name += padded(number, pattern.substr(i + 1, end - i - 1));
      ++placeholders;
    } else {
      return std::nullopt;
    }
    i = end;
  }
  return placeholders == 1 ? std::optional(name) : std::nullopt;
}

fs::path data_file_path(const fs::path& header_file, std::string_view name) {
  const fs::path path = header_file.parent_path() / name;
  std::error_code ignored;
  if (name.find('\\') == std::string_view::npos || fs::exists(path, ignored)) {
    return path;
  }
  std::string with_slashes(name);
  std::ranges::replace(with_slashes, '\\', '/');
  const fs::path other = header_file.parent_path() / with_slashes;
  return fs::exists(other, ignored) ? other : path;
}

std::string header_text(const fs::path& path, bool (*is_whole)(std::string_view text)) {
  constexpr std::size_t kFirst = std::size_t{1} << 16;
  constexpr std::size_t kMost = std::size_t{1} << 26;
  for (std::size_t limit = kFirst; limit <= kMost; limit *= 32) {
    std::string text = first_bytes(path, limit);
    if (text.size() < limit || is_whole(text)) {
      return text;
    }
  }
  throw bad_file(
      path, "has a header that does not end within the first " + std::to_string(kMost) + " bytes");
}

}  // namespace isoatlas::detail::io
