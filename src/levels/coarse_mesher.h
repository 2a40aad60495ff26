// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "complex/coarsen.h"
#include "core/nesting.h"
#include "embedding/adaptive_surface.h"
#include "error/vertex_placement.h"
#include "geometry/intersection_tracker.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"
#include "voronoi/certified_dual.h"

namespace isoatlas::detail {

/// Level 0 and what refinement starts from.
struct CoarseLevel {
  TriangleMesh mesh;  ///< in sample-index coordinates
  MeshTopology topology;
  VertexPlacement placement;    ///< on the surface
  std::vector<CVertexId> site;  ///< per cell, on the coarser complex if there is one
  std::vector<float> radius;    ///< per c-vertex of that complex, the radius of a disk about it
};

/// Stage one: a certified covering and the mesh of level 0. Lengths are in voxels. The functions
/// must be called in the order below.
class CoarseMesher {
 public:
  /// @param surface  is subdivided where intersecting triangles cannot be resolved otherwise
  /// @param output_positions  computes the positions that must not intersect
  /// @param coarser  the complex to cover; is refined where triangles intersect; without
  ///                 c-vertices: the surface itself is covered
  CoarseMesher(AdaptiveSurface& surface, Coarsened& coarser, const CoveringOptions& cover,
               const ExtractOptions& options, OutputPositions output_positions);

  void cover(const RunControl& control);
  void certify(LevelReport& report, const RunControl& control);
  /// Orients components outward, moves vertices away from each other and resolves
  /// self-intersections.
  void mesh(LevelReport& report, const RunControl& control);

  /// Returns level 0 and frees the regions of the coarser complex. No other function may be called
  /// afterwards.
  CoarseLevel take_level();

 private:
  struct CoarseState {
    CoarseState(const SurfaceComplex& surface_complex, const CoveringOptions& options,
                const RunControl& control);
    void adapt_to(const RunControl& control);
    const SurfaceComplex& complex;
    std::vector<Vec3> positions;  // of its c-vertices when the graph was built
    CVertexGraph graph;
    Covering covering;
    CertifiedDual dual;
  };
  std::vector<CVertexId> sites() const;  ///< per vertex, its c-vertex on the surface
  bool is_coarser() const { return !coarser_.representative.empty(); }
  class Dual;
  bool is_next_to_shared_face(std::uint32_t vertex, std::span<const CVertexId> at,
                              const SlackRows<std::uint32_t>& triangles_of) const;
  void relax_vertices(const RunControl& control);
  void update_mesh();
  std::vector<ComponentId> components() const;  ///< per vertex
  std::vector<std::uint8_t> inverted_components(
      std::span<const ComponentId> component_of) const;  ///< per component, 1 if it is inverted
  Nesting nesting(std::span<const ComponentId> component_of) const;
  std::vector<std::uint8_t> find_moves_to_revert(std::span<const std::uint32_t> moved,
                                                 std::span<const Vec3> before,
                                                 std::span<Vec3> positions,
                                                 std::span<const std::uint32_t> check,
                                                 std::span<const ComponentId> component_of,
                                                 const RunControl& control);
  bool refine_inverted_components(int round, CertificateReport& certificate);
  std::vector<CVertexId> regions_to_split(std::span<const CellId> cells) const;
  bool refine_single_cells(std::span<const CellId> cells, const RunControl& control);

  AdaptiveSurface& surface_;
  Coarsened& coarser_;
  const CoveringOptions& cover_;
  const ExtractOptions& options_;
  std::unique_ptr<CoarseState> state_;
  IntersectionTracker tracker_;
  bool were_regions_split_ = false;
  TriangleMesh mesh_;
  MeshTopology topology_;
  VertexPlacement placement_;
};

}  // namespace isoatlas::detail
