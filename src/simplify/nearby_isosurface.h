// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "error/surface_proof.h"
#include "error/triangle_errors.h"
#include "isosurface/isosurface.h"
#include "simplify/collapsing_mesh.h"

namespace isoatlas::detail {

/// The isosurface near a part of a mesh, and which triangles prove that it is no farther than a
/// bound from the mesh: for each grid cell some triangles, so that every point of the isosurface
/// there is near one of them. Points are metric.
class NearbyIsosurface {
 public:
  /// A volume that contains all triangles that may change, with some margin.
  struct Window {
    Vec3 first;                     ///< its first sample, in the coordinates of the mesh
    const SurfaceComplex& complex;  ///< its surface
    const Isosurface& isosurface;
  };

  /// @param region  the triangles that may change, sorted
  /// @param bound   on the distance
  /// @cost  O(C + R log R) for C grid cells with a surface and R triangles
  NearbyIsosurface(const CollapsingMesh& mesh, const Window& window,
                   std::span<const std::uint32_t> region, double bound, const RunControl& control);

  /// Whether the isosurface near a triangle could not be proved to be near the mesh: it must not
  /// change.
  bool is_fixed(std::uint32_t triangle) const { return is_fixed_[number_of(triangle)] != 0; }

  /// The grid cells whose proof depends on one of these triangles, sorted.
  std::vector<std::uint32_t> cells_that_need(std::span<const std::uint32_t> triangles) const;
  /// The triangles that prove a grid cell, sorted.
  std::span<const std::uint32_t> triangles_of(std::uint32_t cell) const { return proof_[cell]; }

  /// Proves one grid cell with some triangles of the mesh. May be called by several threads.
  /// @param proof  gets those that are needed, sorted
  /// @return false if some point of the isosurface may be farther than the bound from all of them
  bool prove(std::uint32_t cell, std::span<const std::uint32_t> triangles,
             std::vector<std::uint32_t>& proof) const;
  /// From now on these triangles prove the grid cell.
  void set_proof(std::uint32_t cell, std::vector<std::uint32_t> proof);

  /// Whether all points of a triangle are proved to be within the bound of the isosurface. May be
  /// called by several threads.
  bool is_near(std::uint32_t triangle) const;

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(proof_.size()); }
  /// The largest distance of a c-vertex of the grid cell from the triangles that prove it, and the
  /// corner of these that is nearest there.
  struct Sample {
    double distance = 0;
    std::uint32_t vertex = kNone;
  };
  Sample farthest_c_vertex(std::uint32_t cell) const;

 private:
  std::size_t number_of(std::uint32_t triangle) const;
  std::array<Vec3, 3> corners(const Triangle& t) const;
  bool is_in_region(std::uint32_t triangle) const;
  void prove_all(const RunControl& control);

  const CollapsingMesh& mesh_;
  const Isosurface& isosurface_;
  Vec3 spacing_, origin_;  // origin: metric position of the window's first sample
  std::span<const std::uint32_t> region_;
  double bound_;
  GridCellIndex index_;
  const SurfaceComplex& complex_;
  std::vector<GridCellIndex::Key> keys_;              // per grid cell whose proof needs the region
  std::vector<std::vector<std::uint32_t>> proof_;     // per such grid cell
  std::vector<std::vector<std::uint32_t>> cells_of_;  // per triangle of the region
  std::vector<std::uint8_t> is_fixed_;                // per triangle of the region
};

}  // namespace isoatlas::detail
