// SPDX-License-Identifier: Apache-2.0
#include "wording/choices.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "isoatlas/error.h"
#include "wording/values.h"

namespace isoatlas::detail {
namespace {

template <class Value, std::size_t count>
Value choose(const std::pair<std::string_view, Value> (&choices)[count], std::string_view text) {
  const std::string word = plain_word(text);
  std::string names;
  for (const auto& [name, value] : choices) {
    if (name == word) return value;
    names.append(names.empty() ? "" : ", ").append(name);
  }
  throw Error(ErrorCode::bad_argument,
              "expected one of " + names + ", got '" + std::string(text) + "'");
}

}  // namespace

Inside parse_inside(std::string_view text) {
  return choose<Inside>({{"above", Inside::above}, {"below", Inside::below}}, text);
}

Topology parse_topology(std::string_view text) {
  return choose<Topology>({{"trilinear", Topology::trilinear}, {"faces", Topology::faces}}, text);
}

Interpolation parse_interpolation(std::string_view text) {
  return choose<Interpolation>(
      {{"trilinear", Interpolation::trilinear}, {"tricubic", Interpolation::tricubic}}, text);
}

NonFinite parse_non_finite(std::string_view text) {
  return choose<NonFinite>({{"below", NonFinite::below}, {"above", NonFinite::above}}, text);
}

Space parse_space(std::string_view text) {
  return choose<Space>({{"lps", Space::lps}, {"ras", Space::ras}, {"voxel", Space::voxel}}, text);
}

CoveringStrategy parse_covering(std::string_view text) {
  return choose<CoveringStrategy>(
      {{"sizing-field", CoveringStrategy::sizing_field}, {"halving", CoveringStrategy::halving}},
      text);
}

Border parse_border(std::string_view text) {
  return choose<Border>({{"open", Border::open}, {"closed", Border::closed}}, text);
}

Placement parse_placement(std::string_view text) {
  return choose<Placement>({{"surface", Placement::surface}, {"balanced", Placement::balanced}},
                           text);
}

SampleType parse_sample_type(std::string_view text) {
  using enum SampleType;
  return choose<SampleType>({{name(int8), int8},
                             {name(uint8), uint8},
                             {name(int16), int16},
                             {name(uint16), uint16},
                             {name(int32), int32},
                             {name(uint32), uint32},
                             {name(int64), int64},
                             {name(uint64), uint64},
                             {name(float32), float32},
                             {name(float64), float64}},
                            text);
}

bool parse_is_big_endian(std::string_view text) {
  return choose<bool>({{"little", false}, {"big", true}}, text);
}

}  // namespace isoatlas::detail
