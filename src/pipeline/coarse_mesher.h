// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "cover/repair.h"
#include "embed/meeting_triangles.h"
#include "isoatlas/extract.h"
#include "partition/coarsen.h"
#include "subdivide/adaptive_surface.h"

namespace isoatlas {

/// Stage one: a covering, certified, and the mesh of level 0. Lengths are in voxels. To be called in the order below.
class CoarseMesher {
 public:
  /// @param surface  divided where nothing else helps against triangles that meet
  /// @param coarser  what to work on as long as it is fine enough; without c-vertices: the surface itself
  CoarseMesher(AdaptiveSurface& surface, const Coarsened& coarser, const CoveringOptions& cover, const ExtractOptions& options);

  void cover(const RunControl& control);
  void certify(LevelReport& report, const RunControl& control);
  /// Turns components outward, moves vertices away from each other and takes triangles apart that meet where they should not.
  void mesh(LevelReport& report, const RunControl& control);

  TriangleMesh& mesh() { return mesh_; }  ///< in sample-index coordinates
  const MeshTopology& topology() const { return topology_; }
  const std::vector<Vec3>& shift() const { return shift_; }  ///< per vertex, how far it is from its c-vertex; spacing applied
  std::vector<CVertexId> sites() const;                       ///< per vertex, its c-vertex on the surface
  const Covering& rough() const { return rough_->covering; }  ///< on the coarser complex, if there is one
  /// On the surface itself: sites are those of rough(), then more. None if rough() is all there is.
  const Covering* fine() const { return fine_ ? &fine_->covering : nullptr; }

 private:
  struct Stand {
    Stand(const SurfaceComplex& on, const CoveringOptions& options);
    const SurfaceComplex& complex;
    CVertexGraph graph;
    Covering covering;
    CertifiedDual dual;
  };
  Stand& stand() { return fine_ ? *fine_ : *rough_; }
  const Stand& stand() const { return fine_ ? *fine_ : *rough_; }
  bool is_on_coarser() const { return !fine_ && !coarser_.representative.empty(); }
  void relax_vertices();
  bool part(LevelReport& report, const RunControl& control);
  void stand_on_surface(const RunControl& control);

  AdaptiveSurface& surface_;
  const Coarsened& coarser_;
  const CoveringOptions& cover_;
  const ExtractOptions& options_;
  std::unique_ptr<Stand> rough_, fine_;
  MeetingTriangles meeting_;
  TriangleMesh mesh_;
  MeshTopology topology_;
  std::vector<Vec3> shift_;
  std::vector<std::uint8_t> stays_;  // per vertex, 1 if it must not be moved
};

}  // namespace isoatlas
