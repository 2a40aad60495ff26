// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"

namespace isoatlas {

/// Nested levels of detail. Each vertex is stored once, and vertices are ordered by the first level
/// that contains them. A level has its own triangles and uses a prefix of the vertices: a vertex of
/// a coarse level is in every finer level, at the same index.
struct ISOATLAS_API Hierarchy {
  /// One level of detail.
  struct Level {
    /// The level has the vertices [0, vertex_count). It is at least that of the previous level.
    std::uint32_t vertex_count = 0;
    std::vector<Triangle> triangles;  ///< T x 3, corners < vertex_count
    /// With Placement::balanced, the vertex_count positions of this level; empty otherwise and in
    /// level 0.
    std::vector<Vec3> own_positions;
    /// Per vertex, the largest two-sided distance between the isosurface in its Voronoi cell and
    /// the mesh, in world units (Quantity::max_distance). Empty if it was not measured.
    std::vector<float> distance;
    /// The number of triangles at the end of `triangles` that are caps on the volume boundary
    /// (Border::closed).
    std::uint32_t cap_triangles = 0;
  };

  /// V x 3, on the isosurface and the same in all levels. Coordinates are in ExtractOptions::space.
  std::vector<Vec3> positions;
  /// Per vertex, the vertex of the previous level in whose Voronoi cell it was placed; for the
  /// vertices of level 0 the vertex itself. Empty if unknown.
  std::vector<std::uint32_t> parent;
  std::vector<Level> levels;  ///< coarse to fine; at least one after extract()
  /// Translation of the float32 positions in a .glb file; if absent, the writer computes one from
  /// the mesh. extract() sets it for volumes far from the origin, because it tests the rounded
  /// coordinates for self-intersections before a file exists.
  std::optional<Vec3> float32_origin;

  /// The coarsest level that contains a vertex.
  /// @throws Error(bad_argument) if no level contains it
  std::uint32_t level_of(std::uint32_t vertex) const;
  /// A copy of a level: its triangles, and its `own_positions` or its prefix of `positions`.
  /// @throws Error(bad_argument) if there is no such level; Error(out_of_memory)
  TriangleMesh mesh(std::size_t level) const;
  /// mesh() without a copy; valid until the hierarchy changes or is destroyed.
  MeshView view(std::size_t level) const;
};

/// Combines separate meshes into a hierarchy without parents. A level gets `own_positions` unless
/// its vertices are, bit by bit, a prefix of the vertices of the finest level.
/// @param levels  coarse to fine, at least one
/// @cost O(V + T)
ISOATLAS_API Hierarchy hierarchy_of(std::vector<TriangleMesh> levels);

}  // namespace isoatlas
