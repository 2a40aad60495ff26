// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// The indices of a triangle's vertices, counter-clockwise as seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// An indexed triangle mesh. Both arrays are contiguous (V x 3 double, T x 3 uint32), so that other
/// libraries can view them without a copy.
struct TriangleMesh {
  std::vector<Vec3> positions;      ///< V x 3
  std::vector<Triangle> triangles;  ///< T x 3, corners < V
};

/// A triangle mesh that does not own its arrays. It is valid as long as the arrays are.
struct MeshView {
  std::span<const Vec3> positions;      ///< V x 3
  std::span<const Triangle> triangles;  ///< T x 3, corners < V

  MeshView() = default;
  MeshView(std::span<const Vec3> vertex_positions, std::span<const Triangle> corners)
      : positions(vertex_positions), triangles(corners) {}
  MeshView(const TriangleMesh& mesh) : positions(mesh.positions), triangles(mesh.triangles) {}
};

/// Transforms a mesh from sample-index coordinates to another space. If the grid is mirrored, the
/// corners of each triangle are reordered, so that triangles stay counter-clockwise as seen from
/// outside. O(V + T)
ISOATLAS_API void transform_to(TriangleMesh& mesh, const Grid& grid, Space space);

/// The topology of one connected component of an oriented 2-manifold, with or without boundary.
struct ComponentTopology {
  std::int64_t euler_characteristic = 0;
  std::int64_t boundary_loops = 0;
  /// The genus of the component if each boundary loop is capped by a disk.
  std::int64_t genus() const { return (2 - boundary_loops - euler_characteristic) / 2; }
  friend auto operator<=>(const ComponentTopology&, const ComponentTopology&) = default;
};

/// The topology of a list of triangles, from the vertex indices alone. Positions are not used.
struct ISOATLAS_API MeshTopology {
  std::size_t vertices = 0, edges = 0, triangles = 0;
  std::size_t unused_vertices = 0;        ///< vertices in no triangle
  std::size_t degenerate_triangles = 0;   ///< triangles with two corners at the same vertex
  std::size_t non_manifold_edges = 0;     ///< edges in three or more triangles
  std::size_t non_manifold_vertices = 0;  ///< vertices whose triangles form more than one fan
  /// Edges whose two triangles run along them in the same direction.
  std::size_t inconsistent_edges = 0;
  std::size_t boundary_edges = 0;  ///< edges in one triangle
  /// Per vertex, the index of its component; 0xFFFFFFFF for unused vertices. Components are
  /// numbered in the order of their smallest vertex.
  std::vector<std::uint32_t> component_of_vertex;
  /// The topology of each component; meaningful only if is_manifold() and is_oriented().
  std::vector<ComponentTopology> components;

  /// True if the triangles are a 2-manifold, with or without boundary.
  bool is_manifold() const {
    return degenerate_triangles == 0 && non_manifold_edges == 0 && non_manifold_vertices == 0;
  }
  /// True if the orientations of all adjacent triangles agree.
  bool is_oriented() const { return inconsistent_edges == 0; }
  std::int64_t euler_characteristic() const;  ///< sum over the components
  std::int64_t genus() const;                 ///< sum over the components
  std::int64_t boundary_loops() const;        ///< sum over the components
};

/// Counts edges, fans, components and boundary loops of any list of triangles.
/// @throws Error(bad_argument) if a corner is out of range; Error(cancelled)
/// @cost   O(T log T)
ISOATLAS_API MeshTopology mesh_topology(const MeshView& mesh, const RunControl& control = {});

/// Statistics of the shape of a mesh's triangles. The aspect ratio of a triangle is its shortest
/// edge divided by its longest edge (paper, section 1). Angles are in degrees.
struct MeshQuality {
  std::size_t triangles = 0;
  double aspect_min = 0, aspect_p01 = 0, aspect_median = 0;
  double aspect_share_below_third = 0;  ///< fraction of triangles with an aspect ratio < 1/3
  std::array<std::size_t, 20> aspect_histogram{};  ///< bins of width 0.05 over [0, 1]
  double angle_min = 0, angle_max = 0;
  /// Triangles with an angle above 150 degrees (caps). Their aspect ratio may be good.
  std::size_t angles_above_150 = 0;
  /// Dihedral angle of two triangles that share an edge, measured on the inner side, in (0, 360):
  /// small at a sharp ridge, large in a sharp groove. Both are 180 if no triangles share an edge.
  double dihedral_min = 180, dihedral_max = 180;
  double edge_min = 0, edge_max = 0;  ///< edge lengths, in the units of the positions
  std::size_t zero_area_triangles = 0;
};

/// Measures the shape of the triangles of a mesh.
/// @param mesh  corners < V
/// @throws Error(cancelled) if `control.cancel` was set
/// @cost   O(V + T log T)
ISOATLAS_API MeshQuality mesh_quality(const MeshView& mesh, const RunControl& control = {});

}  // namespace isoatlas
