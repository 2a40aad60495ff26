// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/length_unit.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/file_name.h"
#include "core/ranges.h"

namespace isoatlas {
using namespace detail;

namespace {

struct UnitNames {
  LengthUnit unit;
  std::string_view symbol;
  double metres;
  std::array<std::string_view, 7> words;  ///< lower case, singular; the symbol is one too
};

// µ is U+00B5 (micro sign) or U+03BC (Greek mu); ImageJ writes the first as the byte B5 or as the
// escape \u00B5.
constexpr std::array kUnits{
    UnitNames{LengthUnit::unknown, "", 0, {}},
    UnitNames{
        LengthUnit::angstrom, "A", 1e-10, {"angstrom", "\u00e5", "\u00c5", "\u212b", "ångström"}},
    UnitNames{LengthUnit::nanometre, "nm", 1e-9, {"nanometre", "nanometer"}},
    UnitNames{LengthUnit::micrometre,
              "um",
              1e-6,
              {"micrometre", "micrometer", "micron", "\u00b5m", "\u03bcm", "\xb5m", "\\u00b5m"}},
    UnitNames{LengthUnit::millimetre, "mm", 1e-3, {"millimetre", "millimeter"}},
    UnitNames{LengthUnit::centimetre, "cm", 1e-2, {"centimetre", "centimeter"}},
    UnitNames{LengthUnit::metre, "m", 1, {"metre", "meter"}},
    UnitNames{LengthUnit::inch, "in", 0.0254, {"inch", "\""}},
};

const UnitNames& names_of(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)]; }

}  // namespace

std::string_view symbol(LengthUnit unit) { return names_of(unit).symbol; }

double metres(LengthUnit unit) { return names_of(unit).metres; }

LengthUnit length_unit_named(std::string_view name) {
  const std::string word = lower_case(name);
  const auto matches = [](std::string_view found, const UnitNames& names) {
    return ranges::any_of(names.words,
                          [&](std::string_view w) { return !w.empty() && w == found; });
  };
  for (const UnitNames& names : kUnits) {
    if (names.unit == LengthUnit::unknown) continue;
    const std::string_view singular = word.size() > 3 && word.ends_with('s')
                                          ? std::string_view(word).substr(0, word.size() - 1)
                                          : word;
    // "A" is angstrom, "a" is nothing; all other symbols may be in any case.
    const bool is_symbol = names.unit == LengthUnit::angstrom ? name == names.symbol
                                                              : word == lower_case(names.symbol);
    if (is_symbol || matches(word, names) || matches(singular, names) ||
        (names.unit == LengthUnit::inch && word == "inches"))
      return names.unit;
  }
  return LengthUnit::unknown;
}

}  // namespace isoatlas
