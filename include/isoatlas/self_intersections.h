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

/// The indices of two triangles, the smaller index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Options of self_intersections().
struct SelfIntersectionOptions {
  /// Find only pairs with at least one of these triangles, for a test after a local change; absent:
  /// all pairs. Any order; indices may be repeated. The cost beyond O(V + T) depends on the length
  /// of this list.
  std::optional<std::span<const std::uint32_t>> involving;
};

/// Finds all pairs of triangles that intersect: they have a common point that is not on a shared
/// corner or edge. The result is exact.
///
/// A corner is shared if both triangles use the same vertex index; two vertices at the same
/// position are different corners. A pair is in the result if
///  - the triangles share no corner and have any common point; touching in a point counts;
///  - they share one corner and have another common point;
///  - they share two corners and have a common point outside the edge between these: one triangle
///    is folded flat onto the other;
///  - they share all three corners.
///
/// A triangle without area, or with a repeated corner, counts as the segment or the point that its
/// corners span. If a mesh has no such triangle and no intersecting pair, it is embedded: distinct
/// points of the mesh have distinct positions.
///
/// @param positions  V x 3, finite; any doubles, including subnormal and the largest ones
/// @param triangles  T x 3, corners < V
/// @return  the pairs in increasing order
/// @throws  Error(bad_argument) if a coordinate is not finite, or if a corner or an index in
///          `options.involving` is out of range
/// @throws  Error(cancelled) if `control.cancel` was set
/// @post    the same pairs for any number of threads
/// @cost    O(V + T log T), and a few exact tests per pair of triangles whose bounding boxes
///          overlap; memory: 24 bytes per vertex and about 25 per triangle
ISOATLAS_API std::vector<TrianglePair> self_intersections(
    std::span<const Vec3> positions, std::span<const Triangle> triangles,
    const SelfIntersectionOptions& options = {}, const RunControl& control = {});

/// A position near the intersection of two triangles: the centre of the overlap of their bounding
/// boxes. Use it to find the place in a viewer, not for computations.
ISOATLAS_API Vec3 intersection_position(std::span<const Vec3> positions, const Triangle& a,
                                        const Triangle& b);

}  // namespace isoatlas
