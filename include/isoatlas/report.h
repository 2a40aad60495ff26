// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/certificate.h"
#include "isoatlas/component_extents.h"
#include "isoatlas/export.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// The topology of a surface with several components.
struct TopologySummary {
  std::size_t components = 0;
  std::int64_t euler_characteristic = 0, genus = 0, boundary_loops = 0;  ///< sums over components
  /// The components with the same genus and number of boundary loops.
  struct Kind {
    std::int64_t genus = 0, boundary_loops = 0;  ///< of one component
    std::size_t count = 0;                       ///< number of such components
    friend bool operator==(const Kind&, const Kind&) = default;
  };
  std::vector<Kind> kinds;  ///< sorted by genus, then by number of boundary loops
  friend bool operator==(const TopologySummary&, const TopologySummary&) = default;
};

/// Adds up the topology of components and groups them by kind. O(n log n)
ISOATLAS_API TopologySummary summarize(const std::vector<ComponentTopology>& components);

/// The time that a stage of extract() took.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// A Voronoi cell that violates a bound and cannot become smaller, because its disk contains hardly
/// more than its site (paper, section 3.4). A volume with finer samples would help there.
struct CellAtLimit {
  Vec3 position;      ///< position of the cell's mesh vertex, in the space of the mesh
  double excess = 0;  ///< the largest ratio of metric to bound, above 1
};

/// A triangle with an aspect ratio below the requested one or below 1/3, or with an angle above 150
/// degrees, that could not be improved.
struct BadTriangle {
  Vec3 position;                                 ///< centroid, in the space of the mesh
  double aspect_ratio = 0;                       ///< shortest edge / longest edge
  double largest_angle = 0;                      ///< degrees
  ShapeObstacle obstacle = ShapeObstacle::none;  ///< why its vertices were not moved
};

/// The caps that close a level on the volume boundary (Border::closed).
struct CapSummary {
  std::size_t triangles = 0;
  double area = 0;  ///< world units squared
};

/// The report about one level: topology, shape, errors, constraints, and the work it took.
struct ISOATLAS_API LevelReport {
  std::size_t vertices = 0, triangles = 0;
  TopologySummary topology;       ///< counted independently on the output triangles
  CertificateReport certificate;  ///< certificate of the partition of the level
  /// Present with Border::closed. `quality`, `metrics`, distances and `bad_triangles` do not
  /// include the caps; counts, topology and self-intersections do.
  std::optional<CapSummary> caps;
  /// Closed components whose orientation differs from that on the isosurface, or that lie inside
  /// another component than there. With self-intersections allowed, only the orientation is
  /// compared (docs/theory/02-certificate.md).
  std::size_t inverted_components = 0;
  MeshQuality quality;  ///< lengths in world units, for every space of the mesh
  /// Area and volume in world units, for every space of the mesh; bounds in the space of the mesh.
  MeshExtent extent;
  /// The metrics in the order of Quantity. Absent if extract() made only level 0, without
  /// constraints and without measuring.
  std::optional<std::array<MetricSummary, kMetricCount>> metrics;
  /// The constraints of the level in the given order. For max_distance, `reached` is the larger of
  /// the metric and the measured distance.
  std::vector<ConstraintResult> constraints;
  /// A proved upper bound of the two-sided distance between mesh and isosurface, for all points of
  /// both; world units (docs/theory/05-refinement.md). Absent if distances are only sampled.
  std::optional<double> distance_at_most;
  std::vector<CellAtLimit> at_limit;  ///< worst first
  std::size_t refine_rounds = 0;      ///< rounds of refinement; 0 for level 0
  std::size_t flips = 0;              ///< edges flipped to improve triangles
  std::size_t moves = 0;              ///< vertices moved to another c-vertex to improve triangles
  std::size_t displacements = 0;  ///< vertices displaced in their grid cells to improve triangles
  std::vector<BadTriangle> bad_triangles;  ///< those that remain, worst first
  /// Number of pairs of intersecting triangles, counted on the output mesh; absent if
  /// ExtractOptions::allow_self_intersections is set. See self_intersections().
  std::optional<std::size_t> self_intersections;
  /// Positions near the first ten such pairs, in the space of the mesh.
  std::vector<Vec3> self_intersection_positions;
  std::size_t sites_for_intersections = 0;  ///< sites added to separate intersecting triangles
  std::optional<Measurement> measured;      ///< present if ExtractOptions::measure_samples is not 0
  /// Largest distance in world units by which a file rounds a position of this level. It is 0 after
  /// extract(). Code that writes files sets it and adds it to the lengths in `metrics`,
  /// `distance_at_most` and `constraints`.
  double rounding = 0;
  double seconds = 0;  ///< time for this level

  /// True if all constraints are satisfied, except for default ones (Constraint::is_default).
  bool all_satisfied() const;
};

/// A component whose size was compared with ExtractOptions::components.
struct RankedComponent {
  Vec3 position;         ///< position of its first c-vertex in scan order, in the mesh's space
  std::size_t part = 0;  ///< rank of its part by size, from 0; see ComponentChoice
  double size = 0;       ///< size of its part, world units cubed; see ComponentChoice
  std::size_t c_vertices = 0;
  ComponentTopology topology;
};

/// How the mesh of a volume was merged from those of its blocks; see merge_blocks().
struct BlockSummary {
  Size3 block_size;              ///< grid cells of a block along each axis
  Size3 counts;                  ///< blocks along each axis
  std::size_t with_surface = 0;  ///< blocks that contain a part of the surface
  /// Vertices on shared faces, and edges there: each edge has a triangle in two blocks.
  std::size_t seam_vertices = 0, seam_edges = 0;
  /// Vertices near shared faces that were in the meshes of blocks and are in no merged level.
  std::size_t removed_vertices = 0;
};

/// The report about a run of extract() or of merge_blocks(), which adds up those of the blocks.
struct ExtractReport {
  std::size_t c_vertices = 0;       ///< number of c-vertices of the reference surface complex
  std::size_t faces = 0;            ///< number of faces of the reference surface complex
  std::size_t double_segments = 0;  ///< double segments, split to make the dual simplicial
  std::size_t tunnels = 0;          ///< grid cells with a tunnel; 0 with Topology::faces
  std::vector<std::size_t> coarser_c_vertices;  ///< numbers of c-vertices of the coarser complexes
  /// Counted on the reference surface, without dropped components; with Border::closed, on the
  /// reference surface and its caps. After merge_blocks() it is counted on level 0, whose Euler
  /// characteristic is compared with that of the blocks' reference surfaces.
  TopologySummary reference;
  /// The components that ExtractOptions::components keeps and drops, largest first; both are empty
  /// if the options keep all.
  std::vector<RankedComponent> kept, dropped;
  /// Adaptive supersampling: the number of subdivisions, each of all faces around one c-vertex. The
  /// complex is subdivided where triangles intersect and where a bound is violated.
  std::size_t subdivided_c_vertices = 0;
  std::size_t added_c_vertices = 0;  ///< c-vertices added by subdivision
  /// Largest depth of an added c-vertex: 1 more than that of the c-vertex around which faces were
  /// subdivided. C-vertices of the full complex have depth 0.
  int max_subdivision_depth = 0;
  /// Certificate of the partition into the blocks of the coarser complex; `repair_rounds` counts
  /// the rounds in which blocks were checked and cut.
  CertificateReport coarsening;
  std::optional<BlockSummary> blocks;  ///< present if the volume was meshed in blocks
  std::vector<LevelReport> levels;     ///< coarse to fine
  /// Times in this order: surface, components, coarsen, cover, certify, mesh, check, refine.
  std::vector<StageTime> seconds;
  double total_seconds = 0;  ///< from the volume in memory to the checked levels
};

}  // namespace isoatlas
