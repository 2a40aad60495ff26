// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "isoatlas/self_intersections.h"

namespace isoatlas {

/// Whether a pair of triangles is looked for; called with their numbers, from several threads.
using PairTest = std::function<bool(std::uint32_t, std::uint32_t)>;

/// The pairs of triangles with overlapping boxes that pass a test. A triangle's box is that of its corners, larger by `margin` on all sides.
/// @param involving  only pairs with at least one of these triangles; none: all pairs
/// @return sorted, the smaller number first
/// @cost  as self_intersections()
std::vector<TrianglePair> find_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles, double margin,
                                     std::optional<std::span<const std::uint32_t>> involving, const PairTest& is_wanted,
                                     const RunControl& control);

}  // namespace isoatlas
