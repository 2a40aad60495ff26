// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::io {

using LatticePoint = std::array<std::int64_t, 3>;

/// A mesh whose vertices are points of a lattice, in numbers of steps.
struct LatticeMesh {
  std::vector<LatticePoint> positions;
  std::vector<Triangle> triangles;
};

/// Rounds the vertices of a mesh to the nearest points of a lattice.
LatticeMesh on_lattice(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                       Vec3 origin, double step);

/// Whether a coordinate may change to another one.
using IsAllowed = std::function<bool(std::int64_t from, std::int64_t to)>;

/// Moves vertices that share a lattice point to free ones next to it, if there are any.
void separate(LatticeMesh& mesh, const IsAllowed& is_allowed);

/// The planes at which a mesh is cut, the same along all axes: the first one above a coordinate.
using PlaneAbove = std::function<std::int64_t(std::int64_t)>;

/// Cuts triangles at planes normal to the three axes, so that none extends to both sides of one.
/// Where a plane cuts an edge, both of its triangles get the same vertex: a lattice point on the
/// plane, the nearest one to the edge.
/// @cost  O(triangles of the result)
void cut_at_planes(LatticeMesh& mesh, const PlaneAbove& plane_above);

/// Removes triangles with two corners at one point, and makes vertices at one point the same.
void weld(LatticeMesh& mesh);

}  // namespace isoatlas::detail::io
