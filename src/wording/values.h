// SPDX-License-Identifier: Apache-2.0
// Parses typed numbers and lengths.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The text without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// The text in lower case, with "-" for "_" and without blanks at both ends. Names are compared in
/// this form.
std::string plain_word(std::string_view text);

/// The number that the text consists of, except for blanks at its ends; absent if it is not a
/// number. Independent of the locale.
template <class Number>
std::optional<Number> parse_whole(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Throws Error(bad_argument): "expected ..., got '...'".
[[noreturn]] void refuse_value(std::string_view expected, std::string_view text);

/// refuse_value() for a number with fractions. If it has a decimal comma, the message contains the
/// number with a decimal point.
[[noreturn]] void refuse_fraction(std::string_view expected, std::string_view text);

/// Parses a finite number. Throws Error(bad_argument).
double parse_finite(std::string_view text);

/// Parses three numbers that are separated by commas.
/// @param expected  for the error message
/// @param accept    returns whether a number is allowed
/// @throws Error(bad_argument)
template <class Number, class Accept>
std::array<Number, 3> parse_triple(std::string_view text, const char* expected, Accept accept) {
  std::array<Number, 3> triple{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = rest.find(',');
    const auto number = parse_whole<Number>(rest.substr(0, comma));
    const bool is_last = comma == std::string_view::npos;
    if (!number || !accept(*number) || is_last != (i == 2)) refuse_value(expected, text);
    triple[i] = *number;
    if (!is_last) rest.remove_prefix(comma + 1);
  }
  return triple;
}

/// Converts a length to world units.
/// @param unit  the unit of `value`; `unknown`: it is in world units already
/// @throws Error(bad_argument) if the volume states no unit to convert to
double world_length(double value, LengthUnit unit, const Grid& grid);

/// A length as typed: "2.5" in the world's unit, "2.5mm" with a unit, "3vx" in voxels.
struct TypedLength {
  double value = 0;
  bool in_voxels = false;
  LengthUnit unit = LengthUnit::unknown;

  /// @throws Error(bad_argument) as world_length()
  double in_world(const Grid& grid) const {
    return in_voxels ? value * grid.smallest_spacing() : world_length(value, unit, grid);
  }
};

/// Parses a length; absent unless `text` is a finite length, 0 or more.
std::optional<TypedLength> length_of(std::string_view text);

/// A size in space (a volume) as typed: "2.5" in the world's unit cubed, "2.5mm3" with a unit,
/// "10vx" in voxels.
struct SpaceSize {
  double value = 0;
  bool in_voxels = false;
  LengthUnit unit = LengthUnit::unknown;

  /// @throws Error(bad_argument) as world_length()
  double in_world(const Grid& grid) const;
};

/// Parses a size in space; absent unless `text` is a finite size, 0 or more.
std::optional<SpaceSize> space_size_of(std::string_view text);

}  // namespace isoatlas::detail
