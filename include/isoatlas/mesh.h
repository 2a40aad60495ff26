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

using Triangle =
    std::array<std::uint32_t, 3>;  ///< vertex indices, counter-clockwise seen from outside

/// Vertices and triangles, both contiguous (V x 3 double, T x 3 uint32), so that other libraries
/// can view them without a copy.
struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// A mesh that does not own its arrays.
struct MeshView {
  std::span<const Vec3> positions;      ///< V x 3
  std::span<const Triangle> triangles;  ///< T x 3, corners < V

  MeshView() = default;
  MeshView(std::span<const Vec3> p, std::span<const Triangle> t) : positions(p), triangles(t) {}
  MeshView(const TriangleMesh& mesh) : positions(mesh.positions), triangles(mesh.triangles) {}
};

/// Moves a mesh from sample-index coordinates into another space, turning triangles over where the
/// map mirrors.
ISOATLAS_API void transform_to(TriangleMesh& mesh, const Grid& grid, Space space);

/// Topology of one connected component of a 2-manifold (with boundary).
struct ComponentTopology {
  std::int64_t euler_characteristic = 0;
  std::int64_t boundary_loops = 0;
  std::int64_t genus() const {
    return (2 - boundary_loops - euler_characteristic) / 2;
  }  ///< each loop counted as capped by a disk
  friend auto operator<=>(const ComponentTopology&, const ComponentTopology&) = default;
};

/// What can be said of any list of triangles by counting alone, no geometry.
struct ISOATLAS_API MeshTopology {
  std::size_t vertices = 0, edges = 0, triangles = 0;
  std::size_t unused_vertices = 0;
  std::size_t degenerate_triangles = 0;   ///< two corners are the same vertex
  std::size_t non_manifold_edges = 0;     ///< edges with three or more triangles
  std::size_t non_manifold_vertices = 0;  ///< vertices whose triangles are not one fan
  std::size_t inconsistent_edges =
      0;                           ///< edges whose two triangles run along them in the same sense
  std::size_t boundary_edges = 0;  ///< edges with one triangle
  std::vector<std::uint32_t> component_of_vertex;  ///< component index, numbered by smallest
                                                   ///< vertex; unused vertices: 0xFFFFFFFF
  std::vector<ComponentTopology>
      components;  ///< only meaningful where is_manifold() and is_oriented()

  bool is_manifold() const {
    return degenerate_triangles == 0 && non_manifold_edges == 0 && non_manifold_vertices == 0;
  }
  bool is_oriented() const { return inconsistent_edges == 0; }
  std::int64_t euler_characteristic() const;  ///< sums over components
  std::int64_t genus() const;
  std::int64_t boundary_loops() const;
};

/// Counts edges, fans, components and loops. O(T log T). Never throws on malformed input other than
/// Error(bad_argument) for a corner index out of range.
ISOATLAS_API MeshTopology mesh_topology(const MeshView& mesh, const RunControl& control = {});

/// Shape of the triangles of a mesh. Aspect ratio = shortest edge / longest edge (paper, section
/// 1), angles in degrees.
struct MeshQuality {
  std::size_t triangles = 0;
  double aspect_min = 0, aspect_p01 = 0, aspect_median = 0;
  double aspect_share_below_third = 0;  ///< fraction of triangles with aspect ratio < 1/3
  std::array<std::size_t, 20> aspect_histogram{};  ///< bins of width 0.05 over [0, 1]
  double angle_min = 0, angle_max = 0;
  std::size_t angles_above_150 =
      0;  ///< triangles with an angle above 150 degrees: caps, whatever their edges
  /// Between two triangles with an edge in common, through what is on the inner side of both, in
  /// (0, 360): small where the surface has a sharp ridge, large where it has a sharp groove. 180,
  /// 180 where no two triangles share an edge.
  double dihedral_min = 180, dihedral_max = 180;
  double edge_min = 0, edge_max = 0;  ///< edge lengths, in the mesh's own units
  std::size_t zero_area_triangles = 0;
};

ISOATLAS_API MeshQuality mesh_quality(const MeshView& mesh, const RunControl& control = {});

}  // namespace isoatlas
