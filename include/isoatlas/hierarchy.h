// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"

namespace isoatlas {

/// Nested levels of detail. Every vertex is stored once, ordered by the level that brought it; a
/// level uses a prefix of the vertices and has triangles of its own. So a vertex of a coarse level
/// is in every finer level, at the same index.
struct ISOATLAS_API Hierarchy {
  struct Level {
    std::uint32_t vertex_count =
        0;  ///< the level's vertices are [0, vertex_count); never less than in the level before
    std::vector<Triangle> triangles;  ///< T x 3, corners < vertex_count
    std::vector<Vec3> own_positions;  ///< with Placement::balanced, vertex_count positions for this
                                      ///< level; else, and in level 0, empty
    /// Per vertex the largest distance between its cell's part of the isosurface and the mesh, both
    /// ways, in world units: what `max-distance` bounds. Empty if nothing was measured.
    std::vector<float> distance;
  };

  std::vector<Vec3> positions;        ///< V x 3, on the isosurface, the same in all levels
  std::vector<std::uint32_t> parent;  ///< per vertex, the vertex of the level before in whose cell
                                      ///< it was placed; in level 0 itself
  std::vector<Level> levels;          ///< coarse to fine, at least one after extract()
  /// Translation of float32 positions in a .glb; none: the writer derives one from the mesh.
  /// extract() sets it for volumes far from the origin, because it tests the rounded coordinates
  /// before a file exists.
  std::optional<Vec3> float32_origin;

  /// The first level that has the vertex. Throws Error(bad_argument) if none has it.
  std::uint32_t level_of(std::uint32_t vertex) const;
  /// The triangles of a level with its vertices: `own_positions` if it has them, else its prefix of
  /// `positions`.
  TriangleMesh mesh(std::size_t level) const;
  /// The same without a copy; valid as long as the hierarchy exists and does not change.
  MeshView view(std::size_t level) const;
};

/// Levels that come as meshes of their own, coarse to fine, as one: `own_positions` where a level's
/// vertices are not, bit by bit, the first ones of the finest level; no parents. @pre there are
/// levels
ISOATLAS_API Hierarchy hierarchy_of(std::vector<TriangleMesh> levels);

}  // namespace isoatlas
