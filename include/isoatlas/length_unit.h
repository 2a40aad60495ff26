// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "isoatlas/export.h"

namespace isoatlas {

/// Unit of the lengths of a volume's world. `unknown`: the volume does not say.
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

ISOATLAS_API std::string_view symbol(
    LengthUnit unit);  ///< "", "A", "nm", "um", "mm", "cm", "m", "in"

/// Length of one unit in metres; 0 for `unknown`.
ISOATLAS_API double metres(LengthUnit unit);

/// The unit that a file or a person calls `name`: a symbol or a word, singular or plural, in any
/// case where no two units differ in case only ("mm", "MM", "millimeters", "µm", "um", "micron").
/// `unknown` if there is no such unit.
ISOATLAS_API LengthUnit length_unit_named(std::string_view name);

}  // namespace isoatlas
