// SPDX-License-Identifier: Apache-2.0
#include "wording/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "core/file_name.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {

namespace {

// "1,5" -> "1.5"; empty if the text is not a number with one comma.
std::string with_decimal_point(std::string_view text) {
  std::string number(text);
  const std::size_t comma = number.find(',');
  if (comma == std::string::npos || number.find('.') != std::string::npos) return "";
  number[comma] = '.';
  const std::size_t end = number.find_last_of("0123456789") + 1;
  return end > comma && parse_whole<double>(number.substr(0, end)) ? number : "";
}

std::string without_blanks(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t') result += c;
  return result;
}

/// Parses a number, 0 or more, that is followed by "vx", or by a unit of length and `power`, or by
/// nothing.
template <class Measure>
std::optional<Measure> measure_of(std::string_view typed, std::string_view power) {
  const std::string text = without_blanks(typed);
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* const end = text.data() + text.size();
  Measure measure;
  const auto [unit_begin, error] = std::from_chars(begin, end, measure.value);
  if (error != std::errc{} || !std::isfinite(measure.value) || measure.value < 0)
    return std::nullopt;
  std::string_view unit(unit_begin, static_cast<std::size_t>(end - unit_begin));
  measure.in_voxels = unit == "vx" || unit == "VX";
  if (unit.empty() || measure.in_voxels) return measure;
  if (!unit.ends_with(power)) return std::nullopt;
  unit.remove_suffix(power.size());
  measure.unit = length_unit_named(unit);
  if (measure.unit == LengthUnit::unknown) return std::nullopt;
  return measure;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos
             ? std::string_view()
             : text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

std::string plain_word(std::string_view text) {
  std::string word = lower_case(trimmed(text));
  std::ranges::replace(word, '_', '-');
  return word;
}

void refuse_value(std::string_view expected, std::string_view text) {
  throw Error(ErrorCode::bad_argument,
              "expected " + std::string(expected) + ", got '" + std::string(text) + "'");
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

std::optional<TypedLength> length_of(std::string_view text) {
  return measure_of<TypedLength>(text, "");
}
std::optional<SpaceSize> space_size_of(std::string_view text) {
  return measure_of<SpaceSize>(text, "3");
}

double world_length(double value, LengthUnit unit, const Grid& grid) {
  if (unit == LengthUnit::unknown || unit == grid.unit) return value;
  if (grid.unit == LengthUnit::unknown) {
    throw Error(ErrorCode::bad_argument, std::string(symbol(unit)) +
                                             " cannot be converted, the volume states no unit; "
                                             "expected a number without a unit, voxels "
                                             "like 2vx, or a spacing with a unit like 0.5,0.5,2mm");
  }
  return value * (metres(unit) / metres(grid.unit));
}

double SpaceSize::in_world(const Grid& grid) const {
  if (in_voxels) return value * grid.spacing.x * grid.spacing.y * grid.spacing.z;
  const double edge = world_length(1, unit, grid);
  return value * edge * edge * edge;
}

}  // namespace isoatlas::detail
