// SPDX-License-Identifier: Apache-2.0
#include "wording/values.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "isoatlas/error.h"

namespace isoatlas {

namespace {

// "1,5" -> "1.5"; empty if the text is not a number with one comma in it.
std::string with_decimal_point(std::string_view text) {
  std::string number(text);
  const std::size_t comma = number.find(',');
  if (comma == std::string::npos || number.find('.') != std::string::npos) return "";
  number[comma] = '.';
  const std::size_t end = number.find_last_of("0123456789") + 1;
  return end > comma && parse_whole<double>(number.substr(0, end)) ? number : "";
}

// A number, 0 or more, with "vx" or the world's unit behind it, or nothing.
template <class Measure>
std::optional<Measure> measure_of(std::string_view text, std::string_view world_unit) {
  const std::string word = plain_word(text);
  text = word;
  const auto strip = [&text](std::string_view unit) {
    if (!text.ends_with(unit)) return false;
    text.remove_suffix(unit.size());
    return true;
  };
  Measure measure;
  measure.in_voxels = strip("vx");
  if (!measure.in_voxels) strip(world_unit);
  const auto value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value) || *value < 0) return std::nullopt;
  measure.value = *value;
  return measure;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view() : text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

std::string plain_word(std::string_view text) {
  std::string word(trimmed(text));
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return c == '_' ? '-' : static_cast<char>(std::tolower(c)); });
  return word;
}

void refuse_value(std::string_view expected, std::string_view text) {
  throw Error(ErrorCode::bad_argument, "expected " + std::string(expected) + ", got '" + std::string(text) + "'");
}

void refuse_fraction(std::string_view expected, std::string_view text) {
  const std::string number = with_decimal_point(trimmed(text));
  if (number.empty()) refuse_value(expected, text);
  refuse_value(std::string(expected) + ", with a decimal point (" + number + ")", text);
}

double parse_finite(std::string_view text) {
  const auto number = parse_whole<double>(text);
  if (!number || !std::isfinite(*number)) refuse_fraction("a finite number", text);
  return *number;
}

std::optional<Length> length_of(std::string_view text) { return measure_of<Length>(text, "mm"); }
std::optional<SpaceSize> space_size_of(std::string_view text) { return measure_of<SpaceSize>(text, "mm3"); }

}  // namespace isoatlas
