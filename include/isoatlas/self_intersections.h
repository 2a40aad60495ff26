// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas {

using TrianglePair =
    std::pair<std::uint32_t, std::uint32_t>;  ///< indices of two triangles, the smaller one first

struct SelfIntersectionOptions {
  /// Only pairs with at least one of these triangles, in any order, may be listed twice; none: all
  /// pairs. For looking again after a local change: what it costs beyond O(V + T) depends on the
  /// length of the list.
  std::optional<std::span<const std::uint32_t>> involving;
};

/// All pairs of triangles that have a point in common besides what their shared corners say they
/// have: decided exactly.
///
/// Corners are shared if they are the same index; vertices at the same place are two vertices. A
/// pair is listed if
///  - it shares no corner, and the triangles have any point in common, be it one corner touching;
///  - it shares one corner, and they have another point in common;
///  - it shares two, and they have a point in common that is not on the edge between those: one is
///  folded flat onto the other;
///  - it shares all three: one triangle twice.
/// A triangle without area, or with a corner used twice, counts as the segment or the point that
/// its corners span, by the same rules. So if there is no such triangle and no such pair, the mesh
/// is embedded: no two of its points are at the same place.
///
/// @param positions  V x 3, finite; any doubles, subnormal ones and the largest included
/// @param triangles  T x 3, corners < V
/// @return  sorted
/// @throws  Error(bad_argument) if a coordinate is not finite, a corner or a listed triangle out of
/// range; Error(cancelled)
/// @post    the same pairs for any number of threads
/// @cost    O(V + T log T) and a few exact tests per pair of triangles whose boxes meet; 24 bytes
/// per vertex, about 25 per triangle
ISOATLAS_API std::vector<TrianglePair> self_intersections(
    std::span<const Vec3> positions, std::span<const Triangle> triangles,
    const SelfIntersectionOptions& options = {}, const RunControl& control = {});

/// Near where two triangles meet: the middle of what their boxes have in common. To find the place,
/// not to compute with it.
ISOATLAS_API Vec3 intersection_position(std::span<const Vec3> positions, const Triangle& a,
                                        const Triangle& b);

}  // namespace isoatlas
