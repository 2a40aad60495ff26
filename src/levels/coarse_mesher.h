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

/// Level 0.
struct CoarseLevel {
  TriangleMesh mesh;  ///< in sample-index coordinates
  MeshTopology topology;
  VertexPlacement placement;    ///< on the surface
  std::vector<CVertexId> site;  ///< per cell, on the coarser complex, if there is one
  std::vector<float> radius;    ///< per c-vertex there, of a disk about it
};

/// Stage one: a covering, certified, and the mesh of level 0. Lengths are in voxels. To be called in the order below.
class CoarseMesher {
 public:
  /// @param surface  divided where nothing else helps against triangles that meet
  /// @param written  what must not meet
  /// @param coarser  what to work on, made finer where triangles meet; without c-vertices: the surface itself
  CoarseMesher(AdaptiveSurface& surface, Coarsened& coarser, const CoveringOptions& cover, const ExtractOptions& options,
               WrittenPositions written);

  void cover(const RunControl& control);
  void certify(LevelReport& report, const RunControl& control);
  /// Turns components outward, moves vertices away from each other and takes triangles apart that meet where they should not.
  void mesh(LevelReport& report, const RunControl& control);

  /// Returns level 0 and frees the regions of the coarser complex. Call nothing else afterwards.
  CoarseLevel take_level();

 private:
  struct Stand {
    Stand(const SurfaceComplex& on, const CoveringOptions& options, const RunControl& control);
    void continue_on(const RunControl& control);
    const SurfaceComplex& complex;
    std::vector<Vec3> positions;  // of its c-vertices when the graph was made
    CVertexGraph graph;
    Covering covering;
    CertifiedDual dual;
  };
  std::vector<CVertexId> sites() const;  ///< per vertex, its c-vertex on the surface
  bool is_coarser() const { return !coarser_.representative.empty(); }
  class Dual;
  void relax_vertices(const RunControl& control);
  void take_mesh();
  std::vector<ComponentId> components() const;                                                   ///< per vertex
  std::vector<std::uint8_t> turned_components(std::span<const ComponentId> component_of) const;  ///< per component, 1 if it is inside out
  Nesting nesting(std::span<const ComponentId> component_of) const;
  std::vector<std::uint8_t> must_go_back(std::span<const std::uint32_t> moved, std::span<const Vec3> before, std::span<Vec3> positions,
                                         std::span<const std::uint32_t> look, std::span<const ComponentId> component_of,
                                         const RunControl& control);
  bool mend_turned_components(int round, CertificateReport& certificate);
  std::vector<CVertexId> regions_to_cut(std::span<const CellId> cells) const;
  bool make_finer(std::span<const CellId> cells, const RunControl& control);

  AdaptiveSurface& surface_;
  Coarsened& coarser_;
  const CoveringOptions& cover_;
  const ExtractOptions& options_;
  std::unique_ptr<Stand> stand_;
  IntersectionTracker meeting_;
  bool were_regions_cut_ = false;
  TriangleMesh mesh_;
  MeshTopology topology_;
  VertexPlacement placement_;
};

}  // namespace isoatlas::detail
