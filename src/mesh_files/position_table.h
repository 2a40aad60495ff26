// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::io {

/// Numbers positions in the order of their first appearance; equal positions get the same number. 0
/// and -0 are equal.
///
/// Floats are compared as floats, not converted to double: g++ 12 with -O2 removes the conversions
/// of a double to float and back, so positions that are equal as floats would compare as different.
template <class Coordinate>
class PositionTable {
 public:
  using Position = std::array<Coordinate, 3>;

  explicit PositionTable(std::size_t most_positions)
      : slots_(std::bit_ceil(std::max<std::size_t>(16, 2 * most_positions)), kEmpty) {}

  std::uint32_t number_of(const Position& position) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(position) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kEmpty) {
        slots_[slot] = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(position);
        return slots_[slot];
      }
      if (positions_[slots_[slot]] == position) {
        return slots_[slot];
      }
    }
  }

  std::vector<Vec3> positions() const {
    std::vector<Vec3> result;
    result.reserve(positions_.size());
    for (const Position& p : positions_) {
      result.push_back({p[0], p[1], p[2]});
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xFFFF'FFFFU;
  using Bits = std::conditional_t<sizeof(Coordinate) == 4, std::uint32_t, std::uint64_t>;

  static std::uint64_t hash(const Position& position) {
    std::uint64_t h = 0;
    for (const Coordinate coordinate : position) {
      h ^= std::bit_cast<Bits>(coordinate + Coordinate{0});  // -0 + 0 is 0
      h *= 0x9E37'79B9'7F4A'7C15ULL;
      h ^= h >> 32;
    }
    return h;
  }

  std::vector<std::uint32_t> slots_;
  std::vector<Position> positions_;
};

}  // namespace isoatlas::detail::io
