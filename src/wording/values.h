// SPDX-License-Identifier: Apache-2.0
// Numbers and lengths as people type them.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Without the blanks at both ends.
std::string_view trimmed(std::string_view text);

/// In lower case, "-" for "_", without the blanks at both ends: names are compared like this.
std::string plain_word(std::string_view text);

/// A number that is the whole text but for blanks at its ends, whatever the locale; none if it is
/// not.
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

/// The same of a number with fractions: says what to write where a comma stands for the decimal
/// point.
[[noreturn]] void refuse_fraction(std::string_view expected, std::string_view text);

/// A finite number. Throws Error(bad_argument).
double parse_finite(std::string_view text);

/// Three numbers between commas, each as `accept` wants it. Throws Error(bad_argument); `expected`
/// is for its message.
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

/// `value` of `unit` as a length in the unit of the volume's world; unit `unknown`: the world's
/// own.
/// @throws Error(bad_argument) if the volume states no unit to convert to
double world_length(double value, LengthUnit unit, const Grid& grid);

/// A length as typed: "2.5" in the world's unit, "2.5mm" in a unit of its own, "3vx" in voxels.
struct TypedLength {
  double value = 0;
  bool in_voxels = false;
  LengthUnit unit = LengthUnit::unknown;

  /// @throws Error(bad_argument) as world_length()
  double in_world(const Grid& grid) const {
    return in_voxels ? value * grid.smallest_spacing() : world_length(value, unit, grid);
  }
};

/// None unless `text` is a finite length, 0 or more.
std::optional<TypedLength> length_of(std::string_view text);

/// The size of a piece of space as typed: "2.5" in the world's unit cubed, "2.5mm3" in a unit of
/// its own, "10vx" in voxels.
struct SpaceSize {
  double value = 0;
  bool in_voxels = false;
  LengthUnit unit = LengthUnit::unknown;

  /// @throws Error(bad_argument) as world_length()
  double in_world(const Grid& grid) const;
};

/// None unless `text` is a finite size, 0 or more.
std::optional<SpaceSize> space_size_of(std::string_view text);

}  // namespace isoatlas::detail
