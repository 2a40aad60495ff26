// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/whole_progress.h"
#include "embedding/adaptive_surface.h"
#include "error/error_field.h"
#include "error/surface_proof.h"
#include "error/triangle_errors.h"
#include "isoatlas/certificate.h"
#include "isoatlas/refine.h"
#include "voronoi/certified_dual.h"

namespace isoatlas::detail {

/// A surface complex with all that refinement derives from it once.
struct Ground {
  /// @param isosurface  what the complex stands for, to look between its c-vertices; none: only they count
  /// @param roaming  says which vertices may leave their c-vertices; none: all but those on the boundary
  /// @param control  asked now and then whether to stop; none: that of `roaming`, if there is one
  explicit Ground(const SurfaceComplex& surface, const Isosurface* isosurface = nullptr, const AdaptiveSurface* roaming = nullptr,
                  const RunControl* control = nullptr);

  /// The complex has more c-vertices, or they are elsewhere. What stands on the ground has to continue_on() it.
  /// @return per c-vertex, 1 if it is elsewhere or its row in G is not what it was
  std::vector<std::uint8_t> remake();

  const SurfaceComplex& complex;
  const Isosurface* isosurface;
  Surfels surfels;
  std::vector<Vec3> moved_from;  ///< per c-vertex, where it was found, if that may be elsewhere than its surfel; else empty
  CVertexGraph graph;
  std::vector<float> reach;  ///< per c-vertex, distance to its farthest neighbour in G
  std::optional<BetweenPoints> between;
  const AdaptiveSurface* roaming;
  mutable std::optional<GridCells> grid_cells;  ///< made by the first proof
  const RunControl* control;                    ///< asked now and then whether to stop; none: nobody is

  /// Whether a vertex may leave its c-vertex, within the grid cell.
  bool is_movable(CVertexId v) const { return roaming != nullptr ? roaming->is_movable(v) : !graph.on_boundary[v]; }
  void check_cancelled() const { measured().check_cancelled(); }
  void report_going_on() const {
    if (control != nullptr) isoatlas::detail::report_going_on(*control);
  }
  MeasuredSurface measured() const {
    return {surfels, moved_from.empty() ? surfels.point : moved_from, graph, complex.spacing, isosurface, control};
  }
};

/// What one cell's metrics say.
struct CellError {
  double excess = 0;        ///< worst of metric / bound; more than 1 is too much
  double at_most = 0;       ///< the excess is no more than this, if it is not more than 1: within bounds it need not be known better
  CVertexId worst = kNone;  ///< where it is farthest from the mesh, if distance is what is wrong: a c-vertex there
};

using MetricValues = std::array<double, kMetricCount>;

/// A covering with its certified dual and its errors, all kept up to date while sites are added: only what changed is looked at
/// again. Copies are independent.
class MeasuredCovering {
 public:
  MeasuredCovering(const Ground& ground, const CoveringOptions& options, std::span<const CVertexId> sites,
                   std::span<const Covering::Radius> radii, const RunControl& control);
  MeasuredCovering(const MeasuredCovering& other);

  /// Where the vertices are, but for what balancing does; spacing applied.
  std::vector<Vec3> base_points() const;
  /// Goes on where the ground was made anew, after the surface was divided: vertices stay where they are, are at their c-vertices now, and
  /// become the sites.
  /// @param changed  what Ground::remake() has returned
  /// @param before   base_points() before that
  void continue_on(std::span<const std::uint8_t> changed, std::span<const Vec3> before, const RunControl& control);

  /// Removes all sites but the first `count`, to take back what was done since there were so many. @pre update() has been called
  void remove_sites(std::uint32_t count, const RunControl& control = {});

  /// Which metrics count from now on, with their bounds; everything will be measured anew,
  /// unless they are what they were.
  /// @param near_enough  share of a bound up to which a distance from the mesh need not be known exactly: what is to be tightened
  ///                     wants to know more, so as not to be measured again each time
  void demand(std::span<const Constraint> metrics, Placement placement, double near_enough = 1);

  /// Multiplies all bounds (of ratios, what they are more than 1) by `share` < 1; only cells that this puts over a bound will be
  /// measured anew.
  void tighten(double share);

  /// Covers, certifies and repairs, places and measures what has changed.
  void update(CertificateReport& report, const RunControl& control);

  /// update() of everything, whatever has changed.
  void update_all(CertificateReport& report, const RunControl& control);

  /// Completes the errors of these cells: update() stops measuring a cell once a bound is violated. @pre update() has been called
  void measure_fully(std::span<const CellId> cells);

  /// Proves of all cells that are within the bound on the distance, as far as their samples say, that no point of their triangles is
  /// farther from the isosurface, and no point of their isosurface from the mesh. What was proved stays so until it is measured again.
  /// Where the proof fails the cell has an error above the bound. @pre update() or remesh() has been called
  /// @return in how many cells
  std::size_t prove();
  bool is_proved() const;
  void forget_proofs() { proved_.assign(proved_.size(), 0); }
  bool is_within_bounds() const;
  /// The bound on the distance, if there is one.
  std::optional<double> distance_bound() const;

  /// All six metrics of every cell, complete. @pre update() has nothing to do
  std::vector<MetricValues> measure_metrics() const;

  /// A complete certificate. @pre update() has nothing to do
  void certify(CertificateReport& report, const RunControl& control) { dual_.certify(report, control); }

  const Ground& ground() const { return ground_; }
  Covering& covering() { return covering_; }
  const Covering& covering() const { return covering_; }
  const Partition& partition() const { return covering_.partition(); }
  const LevelMesh& mesh() const { return mesh_; }
  const std::vector<DualTriangle>& triangles() const { return dual_.triangles(); }
  const std::vector<CellError>& errors() const { return errors_; }
  const VertexPlacement& places() const { return places_; }
  /// Of vertices, in sample-index coordinates.
  std::vector<Vec3> positions() const { return vertex_positions(ground_.complex, ground_.surfels, places_); }

  /// Vertices of the cells before this one keep their anchors from now on.
  void freeze_anchors(CellId before) { frozen_ = before; }
  bool is_frozen(CellId c) const { return c < frozen_; }

  /// All vertices may be moved again, all edges flipped.
  void try_again() { places_.given_up.clear(); }

  /// Where vertices sit, to be changed; remesh() has to follow and be told.
  VertexPlacement& edit_places() { return places_; }
  /// Changes the mesh's triangles, until the next update(), and takes the places of its vertices, but for balancing; measures the cells
  /// again that this may concern.
  /// @param triangles  all of them; what is not in `edit` is as it was
  void remesh(std::span<const DualTriangle> triangles, const MeshEdit& edit, std::span<const CellId> concerned);

  /// How far the first vertices are from their c-vertices. @pre nothing was updated yet
  void displace(std::vector<Vec3> shift) { places_.shift = std::move(shift); }

 private:
  void keep_apart();
  void move_to(CellId cell, CVertexId c_vertex);
  CVertexId free_place_near(CVertexId start, CellId cell, const std::vector<std::uint8_t>& taken) const;
  std::vector<CellId> cells_to_measure(std::span<const std::uint8_t> renewed);
  void measure(std::vector<CellId> cells, Thoroughness thoroughness);
  void measure_between_c_vertices(std::span<const CellId> cells, double bound);
  void measure_from_triangles(std::span<const CellId> cells, double bound, Look look = Look::samples);
  void prove_surface(std::span<const CellId> cells, double bound);
  void add_distance(CellId cell, const Farthest& most, double bound);

  const Ground& ground_;
  Covering covering_;
  CertifiedDual dual_;
  std::vector<Constraint> demands_;
  Placement placement_ = Placement::surface;
  double near_enough_ = 1;
  LevelMesh mesh_;
  VertexPlacement places_;
  CellId frozen_ = 0;
  std::vector<std::uint8_t> proved_;  // per cell, 1 if its isosurface is proved to be within the bound
  std::vector<Farthest> from_mesh_;
  // Checked at each use, so copies share them.
  std::shared_ptr<TriangleErrors> sampled_triangles_ = std::make_shared<TriangleErrors>(),
                                  proved_triangles_ = std::make_shared<TriangleErrors>();
  std::vector<CellError> errors_;
  std::vector<std::uint8_t> stands_alone_;  // per cell, 1 if nothing but its c-vertices and triangles can put it over its bounds
  std::vector<CellId> moved_;               // whose vertices may be elsewhere than in mesh_
  bool all_moved_ = true;
  std::vector<std::uint8_t> stale_;  // per cell, 1 if the next update() has to measure it, whatever else it does
  bool all_stale_ = true;
};

/// All six metrics of every cell of a mesh.
/// @param known      what was found of the mesh's triangles before; none: nothing
/// @param is_proved  triangles need not be looked at, since they are known to be within the bound
std::vector<MetricValues> measure_metrics(const Ground& ground, const Covering& covering, const LevelMesh& mesh,
                                          TriangleErrors* known = nullptr, bool is_proved = false);
std::array<MetricSummary, kMetricCount> summarize(std::span<const MetricValues> values);

/// The bound times `by`; of a ratio, what it is more than 1.
Constraint scaled(Constraint c, double by);

/// How far over its bound a quantity is, so that different quantities can be compared: more than 1 is too much.
double excess_of(Quantity quantity, double value, double bound);

double longest_edge(const LevelMesh& mesh, CellId cell);

}  // namespace isoatlas::detail
