// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "error/level_mesh.h"
#include "error/metrics.h"
#include "isoatlas/run_control.h"
#include "isosurface/isosurface.h"

namespace isoatlas::detail {

/// The data of the surface that measuring needs and that do not change.
struct MeasuredSurface {
  const Surfels& surfels;
  std::span<const Vec3>
      original_points;  ///< per c-vertex, its original point, unaffected by later moves; metric
  const CVertexGraph& graph;
  Vec3 spacing;
  const Isosurface* isosurface;  ///< none: only c-vertices are known
  const RunControl* control;     ///< tested for cancellation, if there is one
  void check_cancelled() const {
    if (control != nullptr) control->check_cancelled();
  }
};

/// Finds, for the c-vertices of some cells, the closest points of the mesh. `out` lists them cell
/// by cell in the order of `cells`. Parallel over cells.
void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh,
                  std::span<const CellId> cells, std::vector<ClosestPoint>& out);

/// An upper bound of a cell's distance from the mesh, and the c-vertex where it occurs.
struct Farthest {
  float distance = 0;
  CVertexId at = kNone;
  bool operator==(const Farthest&) const = default;
};

/// One point of the surface per face, between c-vertices: the face's node, where the surface
/// intersects a grid edge. Creases and tips protrude most there. Computed on first use.
class FaceNodes {
 public:
  FaceNodes(const SurfaceComplex& complex, const Isosurface& isosurface);

  /// Calls visit(point, face) for every face whose first corner is `v`; the point is metric. Calls
  /// for different c-vertices may run in parallel.
  template <class Visit>
  void for_each_at(CVertexId v, Visit visit) const {
    for (const FaceId face : faces_of_.of(v)) visit(point(face), complex_.faces[face]);
  }

 private:
  Vec3 point(FaceId face) const;

  const SurfaceComplex& complex_;
  const Isosurface& isosurface_;
  CsrAdjacency faces_of_;  // per c-vertex, the faces with their first corner there
  mutable std::vector<Vec3> points_;
  mutable std::vector<std::uint8_t> is_known_;
};

enum class Thoroughness { quick, exact };

struct CellDistance {
  Farthest farthest;
  bool is_from_own = false;  ///< the triangles around the cell's own vertex were sufficient
};

/// Per cell of `cells`, the largest distance of its c-vertices and face nodes from the mesh.
/// Cheaper than find_closest(), since a distance up to `exact_above` is only known to be no larger
/// than the returned value. If quick, once one c-vertex of a cell is farther than that, the other
/// c-vertices and the nodes are not tested. Parallel over cells.
/// @param face_nodes  none: only c-vertices are tested
std::vector<CellDistance> find_farthest(const MeasuredSurface& surface, const LevelMesh& mesh,
                                        std::span<const CellId> cells, double exact_above,
                                        Thoroughness thoroughness, const FaceNodes* face_nodes);

/// Per cell of `cells`, the largest distance from its face nodes to the mesh, with the corner of
/// the node's face that is farthest from the cell's vertex. A distance up to `exact_above` is only
/// known to be no larger than the returned value. Parallel over cells.
/// @param farthest  per cell of `cells`, a distance that is already known: only larger ones are
///                  searched for; empty: none is known
std::vector<Farthest> measure_face_nodes(const MeasuredSurface& surface,
                                         const FaceNodes& face_nodes, const LevelMesh& mesh,
                                         std::span<const CellId> cells, double exact_above,
                                         std::vector<Farthest> farthest = {});

}  // namespace isoatlas::detail
