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

/// A surface complex with everything that refinement derives from it once.
struct SurfaceData {
  /// @param isosurface  the surface that the complex approximates; none: only its c-vertices are
  ///                    measured
  /// @param adaptive  decides which vertices may be displaced from their c-vertices; none: all but
  ///                  those on the boundary
  /// @param run_control  tested for cancellation; none: that of `adaptive`, if there is one
  explicit SurfaceData(const SurfaceComplex& surface, const Isosurface* isosurface = nullptr,
                       const AdaptiveSurface* adaptive = nullptr,
                       const RunControl* run_control = nullptr);

  /// To be called after the complex has got more c-vertices or has moved some. Afterwards
  /// everything that depends on this data must adapt_to() the change.
  /// @return per c-vertex, 1 if it has moved or its row in G has changed
  std::vector<std::uint8_t> rebuild();

  const SurfaceComplex& complex;
  const Isosurface* isosurface;
  Surfels surfels;
  std::vector<Vec3> original_points;  ///< per c-vertex, its original point if some differ from the
                                      ///< surfels; otherwise empty
  CVertexGraph graph;
  std::vector<float>
      farthest_neighbour;  ///< per c-vertex, the distance to its farthest neighbour in G
  std::optional<FaceNodes> face_nodes;
  const AdaptiveSurface* adaptive_surface;
  mutable std::optional<GridCellIndex> grid_cell_index;  ///< made by the first proof
  const RunControl* control;  ///< tested for cancellation, if there is one

  /// Whether a vertex may be displaced from the c-vertex, within its grid cell.
  bool is_movable(CVertexId v) const {
    return adaptive_surface != nullptr ? adaptive_surface->is_movable(v) : !graph.on_boundary[v];
  }
  /// Whether a vertex at the c-vertex is on a face that a block shares with others. Such vertices
  /// are half a voxel apart, so the triangles at them cannot be well shaped: their shape is no
  /// reason to change or to refine the mesh.
  bool is_on_shared_face(CVertexId v) const { return graph.on_boundary[v] == kOnSharedFace; }
  void check_cancelled() const { measured_surface().check_cancelled(); }
  void report_continuing() const {
    if (control != nullptr) isoatlas::detail::report_continuing(*control);
  }
  MeasuredSurface measured_surface() const {
    return {surfels,    original_points.empty() ? surfels.point : original_points,
            graph,      complex.spacing,
            isosurface, control};
  }
};

/// The error of one cell, relative to its bounds.
struct CellError {
  double excess = 0;  ///< largest metric / bound; a bound is violated if this is larger than 1
  double upper_bound =
      0;  ///< upper bound of `excess`; exact values are not computed for cells within bounds
  CVertexId worst = kNone;  ///< if the distance violates its bound: a c-vertex where the cell is
                            ///< farthest from the mesh
};

using MetricValues = std::array<double, kMetricCount>;

/// A covering with its certified dual and its errors. All are updated incrementally while sites are
/// inserted. Copies are independent.
class MeasuredCovering {
 public:
  MeasuredCovering(const SurfaceData& surface_data, const CoveringOptions& options,
                   std::span<const CVertexId> sites, std::span<const Covering::Radius> radii,
                   const RunControl& control);
  MeasuredCovering(const MeasuredCovering& other);

  /// The points of the vertices, without normal offsets.
  std::vector<Vec3> base_points() const;
  /// Adapts to a surface that was subdivided, after SurfaceData::rebuild(). Vertices keep their
  /// points, have their c-vertices there now, and become the sites.
  /// @param changed  result of SurfaceData::rebuild()
  /// @param before   base_points() before the subdivision
  void adapt_to(std::span<const std::uint8_t> changed, std::span<const Vec3> before,
                const RunControl& control);

  /// Removes all sites but the first `count`, which reverts everything done since there were so
  /// many. @pre update() has been called
  void remove_sites(std::uint32_t count, const RunControl& control = {});

  /// Sets the metrics and their bounds. Everything will be measured again, unless nothing has
  /// changed.
  /// @param exact_above_share  share of a bound up to which a distance from the mesh need not be
  ///                           exact. Smaller values save measuring again each time bounds are
  ///                           tightened
  void set_bounds(std::span<const Constraint> metrics, Placement mode,
                  double exact_above_share = 1);

  /// Multiplies all bounds (for ratios, their difference from 1) by `share` < 1. Only cells that
  /// violate a bound because of this will be measured again.
  void tighten_bounds(double share);

  /// Covers, certifies and repairs, places vertices and measures wherever something has changed.
  void update(CertificateReport& report, const RunControl& control);

  /// update() of all cells.
  void update_all(CertificateReport& report, const RunControl& control);

  /// Completes the errors of these cells: update() stops measuring a cell once a bound is violated.
  /// @pre update() has been called
  void complete_errors(std::span<const CellId> cells);

  /// For all cells whose samples satisfy the bound on the distance: proves that no point of their
  /// triangles is farther from the isosurface, and no point of their isosurface is farther from the
  /// mesh. A proof is valid until the cell is measured again. Where it fails, the cell gets an
  /// error above the bound. @pre update() or remesh() has been called
  /// @return number of cells for which it fails
  std::size_t prove();
  bool is_proved() const;
  void clear_proofs() { proved_.assign(proved_.size(), 0); }
  bool is_within_bounds() const;
  /// The bound on the distance, if there is one.
  std::optional<double> distance_bound() const;

  /// All six metrics of every cell, completely evaluated. @pre update() has nothing to do
  std::vector<MetricValues> measure_metrics() const;

  /// A complete certificate. @pre update() has nothing to do
  void certify(CertificateReport& report, const RunControl& control) {
    dual_.certify(report, control);
  }

  const SurfaceData& surface_data() const { return surface_data_; }
  Covering& covering() { return covering_; }
  const Covering& covering() const { return covering_; }
  const Partition& partition() const { return covering_.partition(); }
  const LevelMesh& mesh() const { return mesh_; }
  const std::vector<DualTriangle>& triangles() const { return dual_.triangles(); }
  const std::vector<CellError>& errors() const { return errors_; }
  const VertexPlacement& placement() const { return vertex_placement_; }
  /// Of the vertices, in sample-index coordinates.
  std::vector<Vec3> positions() const {
    return vertex_positions(surface_data_.complex, surface_data_.surfels, vertex_placement_);
  }

  /// From now on the vertices of the cells before this one keep their anchors.
  void fix_anchors(CellId before) { fixed_anchor_count_ = before; }
  bool has_fixed_anchor(CellId c) const { return c < fixed_anchor_count_; }

  /// Makes all vertices movable and all edges flippable again.
  void clear_fixed() { vertex_placement_.fixed.clear(); }

  /// The placement, for editing; a call of remesh() with the changes must follow.
  VertexPlacement& edit_vertex_placement() { return vertex_placement_; }
  /// Replaces triangles of the mesh, until the next update(), and updates the points of its
  /// vertices, without normal offsets. Measures the affected cells again.
  /// @param triangles  all of them; those not in `edit` are unchanged
  void remesh(std::span<const DualTriangle> triangles, const MeshEdit& edit,
              std::span<const CellId> affected);

  /// Sets the displacements of the first vertices. @pre update() was not called yet
  void set_displacement(std::vector<Vec3> displacement) {
    vertex_placement_.displacement = std::move(displacement);
  }

 private:
  void resolve_shared_anchors();
  void set_anchor(CellId cell, CVertexId c_vertex);
  CVertexId free_c_vertex_near(CVertexId start, CellId cell,
                               const std::vector<std::uint8_t>& taken) const;
  std::vector<CellId> cells_to_measure(std::span<const std::uint8_t> changed_cells);
  void measure(std::vector<CellId> cells, Thoroughness thoroughness);
  void measure_face_nodes_of(std::span<const CellId> cells, double bound);
  void measure_from_triangles(std::span<const CellId> cells, double bound,
                              Evidence evidence = Evidence::samples);
  void prove_surface(std::span<const CellId> cells, double bound);
  void add_error(CellId cell, const Farthest& farthest, double bound);

  const SurfaceData& surface_data_;
  Covering covering_;
  CertifiedDual dual_;
  std::vector<Constraint> bounds_;
  Placement placement_mode_ = Placement::surface;
  double exact_above_share_ = 1;
  LevelMesh mesh_;
  VertexPlacement vertex_placement_;
  CellId fixed_anchor_count_ = 0;
  std::vector<std::uint8_t>
      proved_;  // per cell, 1 if its isosurface is proved to be within the bound
  std::vector<Farthest> from_mesh_;
  // Entries are verified at each use, so copies can share them.
  std::shared_ptr<TriangleErrorCache> sampled_errors_ = std::make_shared<TriangleErrorCache>(),
                                      proved_errors_ = std::make_shared<TriangleErrorCache>();
  std::vector<CellError> errors_;
  std::vector<std::uint8_t> depends_on_own_data_only_;  // per cell, 1 if its error depends only on
                                                        // its own c-vertices and triangles
  std::vector<CellId> moved_;  // cells whose vertices may have moved since mesh_ was updated
  bool all_moved_ = true;
  std::vector<std::uint8_t>
      stale_;  // per cell, 1 if the next update() has to measure it in any case
  bool all_stale_ = true;
};

/// All six metrics of every cell of a mesh.
/// @param cache      errors of the mesh's triangles that were measured before; none: all are
///                   measured
/// @param is_proved  triangles are not measured, since they are proved to be within the bound
std::vector<MetricValues> measure_metrics(const SurfaceData& surface_data, const Covering& covering,
                                          const LevelMesh& mesh,
                                          TriangleErrorCache* cache = nullptr,
                                          bool is_proved = false);
std::array<MetricSummary, kMetricCount> summarize(std::span<const MetricValues> values);

/// The bound times `factor`; for a ratio, its difference from 1 is multiplied.
Constraint scaled(Constraint c, double factor);

/// A quantity relative to its bound, comparable between quantities: the bound is violated if this
/// is larger than 1.
double excess_of(Quantity quantity, double value, double bound);

double longest_edge(const LevelMesh& mesh, CellId cell);

}  // namespace isoatlas::detail
