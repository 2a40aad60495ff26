// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "isoatlas/export.h"

namespace isoatlas {

/// Unit of the world lengths of a volume. `unknown`: the volume does not state it.
enum class LengthUnit : std::uint8_t {
  unknown,
  angstrom,
  nanometre,
  micrometre,
  millimetre,
  centimetre,
  metre,
  inch
};

/// The symbol of a unit: "", "A", "nm", "um", "mm", "cm", "m" or "in".
ISOATLAS_API std::string_view symbol(LengthUnit unit);

/// Length of one unit in metres; 0 for `unknown`.
ISOATLAS_API double metres(LengthUnit unit);

/// The unit with a name: a symbol or a word, singular or plural, for example "mm", "millimeters",
/// "µm", "um" or "micron". Case is ignored, except that "a" is not the angstrom "A".
/// @return `unknown` if there is no such unit
ISOATLAS_API LengthUnit length_unit_named(std::string_view name);

}  // namespace isoatlas
