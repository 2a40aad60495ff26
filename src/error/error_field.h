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

/// Everything of the surface that measuring needs and that does not change.
struct MeasuredSurface {
  const Surfels& surfels;
  std::span<const Vec3> found;  ///< per c-vertex, the point that it was found at, whatever was moved since; spacing applied
  const CVertexGraph& graph;
  Vec3 spacing;
  const Isosurface* isosurface;  ///< none: the c-vertices are all that is known
  const RunControl* control;     ///< asked now and then whether to stop; none: nobody is
  void check_cancelled() const {
    if (control != nullptr) control->check_cancelled();
  }
};

/// Finds, for the c-vertices of some cells, the closest points of the mesh: out[i] belongs to the i-th c-vertex of the cells
/// taken one after the other. Parallel over cells.
void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out);

/// How far a cell is from the mesh at most, and the c-vertex there.
struct Farthest {
  float distance = 0;
  CVertexId at = kNone;
  bool operator==(const Farthest&) const = default;
};

/// Points of the surface between c-vertices, one per face: its node, where the surface meets a grid edge, which is where creases
/// and tips stand out most. Found when first asked for.
class BetweenPoints {
 public:
  BetweenPoints(const SurfaceComplex& complex, const Isosurface& isosurface);

  /// Calls visit(point, face), spacing applied, for every face whose first corner is `v`. Calls for different c-vertices may overlap.
  template <class Visit>
  void for_each_at(CVertexId v, Visit visit) const {
    for (const FaceId face : faces_of_.of(v)) visit(point(face), complex_.faces[face]);
  }

 private:
  Vec3 point(FaceId face) const;

  const SurfaceComplex& complex_;
  const Isosurface& isosurface_;
  Buckets faces_of_;  // per c-vertex, the faces with their first corner there
  mutable std::vector<Vec3> points_;
  mutable std::vector<std::uint8_t> known_;
};

enum class Thoroughness { quick, exact };

struct CellDistance {
  Farthest farthest;
  bool is_from_own = false;  ///< the triangles around the cell's own vertex were enough; those around its neighbours were not looked at
};

/// Per cell of `cells`, the farthest of its c-vertices and of the points between them from the mesh: cheaper than find_closest(), since a
/// distance up to `enough` is only known to be no larger than what is returned. If quick, only some c-vertices are looked at of a cell with
/// one that is farther than that, and no points between. Parallel over cells.
/// @param between  none: only c-vertices are looked at
std::vector<CellDistance> find_farthest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, double enough,
                                        Thoroughness thoroughness, const BetweenPoints* between);

/// Per cell of `cells`, the largest distance from the points between its c-vertices to the mesh, with the corner of its face
/// that is farthest from the cell's vertex; a distance up to `enough` is only known to be no larger than what is returned. Parallel over
/// cells.
/// @param most  per cell of `cells`, a distance that is known already: only larger ones are looked for; empty: none is
std::vector<Farthest> measure_between(const MeasuredSurface& surface, const BetweenPoints& between, const LevelMesh& mesh,
                                      std::span<const CellId> cells, double enough, std::vector<Farthest> most = {});

}  // namespace isoatlas::detail
