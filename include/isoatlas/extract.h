// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/hierarchy.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// How stage one covers the surface by disks; certificate and repair have the last word either way (docs/theory/04-covering.md).
enum class CoveringStrategy : std::uint8_t {
  radius_field,  ///< a radius per c-vertex that grows by a third of the distance at most, sites farthest first
  halving,       ///< the paper's own: bins of radii R_g / 2^i, every radius halved until it fits its neighbours'
};

constexpr std::uint32_t kMostDivisions = 8;  ///< more often the surface is not divided for a bound

struct ExtractOptions {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
  Topology topology = Topology::trilinear;
  /// What is between samples, to place vertices, to measure distances and to supersample; not supersampled, the topology is the same.
  Interpolation interpolation = Interpolation::trilinear;
  /// The reference surface is that of the volume upsampled so many times along each axis by the interpolation. Voxels are those
  /// of the volume, and positions in its sample-index coordinates.
  std::uint32_t supersample = 1;
  /// How often the surface may be divided, in each refined level, where cells as small as they can be are over a bound; 0: never.
  std::uint32_t adaptive_supersample = 3;
  Space space = Space::lps;
  /// Largest disk radius R_g of the paper's stage one, world units; none: half the longest side of the volume.
  std::optional<double> max_radius;
  CoveringStrategy covering = CoveringStrategy::radius_field;
  /// Topological events that close again within this length do not limit a disk, world units; none: 1.5 voxels, with halving 0.
  std::optional<double> event_persistence;
  /// false puts c-vertices at the plain average of their nodes, as the paper has it (up to 0.2 voxel off the surface).
  bool vertices_on_surface = true;
  /// Components that are not meshed; nothing is left out unless asked for. The size of a component is the volume it encloses, with
  /// the volume's border as a cap where that cuts it open. Components that the cap connects count as one, a part.
  double min_component_size = 0;    ///< drop smaller ones, world units cubed
  std::size_t keep_components = 0;  ///< keep only so many largest parts (ties: first in scan order); 0 keeps all
  /// Level 0 is the coarse mesh of the paper's stage one; its constraints are only looked at, not worked for.
  LevelGoal coarse;
  /// One more level, refined from the one before, per entry.
  std::vector<LevelGoal> refine;
  Placement placement = Placement::surface;
  /// false: no level has self-intersections in the output space, nor after rounding to float32 if that moves positions by less than a
  /// thousandth of a voxel (docs/theory/06-self-intersections.md). Intersecting triangles are separated by smaller cells and finally by
  /// subdividing the surface complex. LevelReport::self_intersections counts what could not be separated.
  bool allow_self_intersections = false;
  /// Measure every level against the isosurface with that many samples in each direction; 0: do not.
  std::size_t measure_samples = 0;
};

/// Topology of one whole surface.
struct TopologySummary {
  std::size_t components = 0;
  std::int64_t euler_characteristic = 0, genus = 0, boundary_loops = 0;
  struct Kind {
    std::int64_t genus = 0, boundary_loops = 0;
    std::size_t count = 0;
    friend bool operator==(const Kind&, const Kind&) = default;
  };
  std::vector<Kind> kinds;  ///< the multiset of (genus, loops), sorted by genus, then loops
  friend bool operator==(const TopologySummary&, const TopologySummary&) = default;
};

TopologySummary summarize(const std::vector<ComponentTopology>& components);

/// What the certificate looked at, and what it took to pass (docs/theory/02-certificate.md).
struct CertificateReport {
  bool passed = false;
  std::size_t cells_checked = 0;    ///< every one a disk, with a triangle, meeting the boundary in at most one arc
  std::size_t arcs_checked = 0;     ///< pairs of adjacent cells, every pair meeting in exactly one arc
  std::size_t triples_checked = 0;  ///< triples of cells, every triple meeting in exactly one point
  std::size_t repair_rounds = 0;    ///< rounds of check-and-repair until it passed
  std::size_t repair_sites = 0;     ///< sites added by repair
};

struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// One metric over the cells of a level.
struct MetricSummary {
  double maximum = 0, mean = 0;  ///< unit as the quantity says
};

/// A constraint, and what became of it.
struct ConstraintResult {
  Constraint wanted;
  double reached = 0;
  bool met = false;
  std::string reason;  ///< if not met: what stood in its way, with figures
};

/// A cell that is over its bound and cannot be made smaller: it would no longer contain all neighbours of its site (paper, 3.4).
struct CellAtLimit {
  Vec3 position;      ///< of its vertex, in the mesh's space
  double excess = 0;  ///< worst of metric / bound
};

/// Why a badly shaped triangle could not be mended: what keeps the ends of its shortest edge where they are.
enum class ShapeObstacle {
  none,               ///< nothing in particular: no place within reach is better and within the bounds
  earlier_level,      ///< they are vertices of an earlier level
  self_intersection,  ///< elsewhere triangles would meet
  crowded,            ///< other pieces of the surface are in the same grid cell
};

/// A triangle below the aspect ratio that was asked for, or below 1/3, or with an angle above 150 degrees.
struct BadTriangle {
  Vec3 position;  ///< its centroid, in the mesh's space
  double aspect_ratio = 0;
  double largest_angle = 0;  ///< degrees
  ShapeObstacle obstacle = ShapeObstacle::none;
};

struct LevelReport {
  std::size_t vertices = 0, triangles = 0;
  TopologySummary topology;           ///< counted on the finished triangles, independently
  CertificateReport certificate;      ///< of the level's partition
  std::size_t turned_components = 0;  ///< components that still do not face outward on the whole, see docs/theory/02-certificate.md
  MeshQuality quality;                ///< measured in world units, whatever the mesh's space
  std::optional<std::array<MetricSummary, kMetricCount>> metrics;  ///< none for a coarse mesh that is all that was asked for
  /// In the order given. Of max-distance the larger one of the metric and of what was measured, if that was asked for.
  std::vector<ConstraintResult> constraints;
  /// Proved: no point of the mesh is farther from the isosurface, and none of the isosurface from the mesh; world units, see
  /// docs/theory/05-refinement.md. None: distances are only sampled.
  std::optional<double> distance_at_most;
  std::vector<CellAtLimit> at_limit;                               ///< worst first; supersampling would help there
  std::size_t refine_rounds = 0;
  /// For the triangles' shape: edges flipped, vertices moved to a better c-vertex, and vertices moved within their grid cells.
  std::size_t flips = 0, moves = 0, shifts = 0;
  std::vector<BadTriangle> bad_triangles;  ///< what is left, worst first
  /// Pairs of triangles that meet where they should not, counted on the finished mesh in the output's space; none: they are allowed.
  std::optional<std::size_t> self_intersections;
  std::vector<Vec3> self_intersection_places;  ///< near the first few of them, in the mesh's space
  std::size_t parting_sites = 0;        ///< sites added to take such triangles apart
  std::optional<Measurement> measured;  ///< if asked for
  /// Largest distance in world units by which a written file rounds a position of this level; 0 from extract(). What writes files sets it
  /// and adds it to the lengths in `metrics`, `distance_at_most` and `constraints`.
  double rounding = 0;
  double seconds = 0;

  bool all_met() const;  ///< all constraints but those that nobody asked for
};

/// A component whose size was looked at, to keep it or to leave it out.
struct RankedComponent {
  Vec3 position;         ///< of its first c-vertex in scan order, in the mesh's space
  std::size_t part = 0;  ///< its rank by size, from 0; components that the border's cap connects are one part
  double size = 0;       ///< of the part, see ExtractOptions::min_component_size, world units cubed
  std::size_t c_vertices = 0;
  ComponentTopology topology;
};

struct ExtractReport {
  std::size_t c_vertices = 0;  ///< of the reference surface complex
  std::size_t faces = 0;
  std::size_t double_segments = 0;              ///< places split so that the dual of G is simplicial
  std::size_t tunnels = 0;                      ///< cells with an annulus; 0 with Topology::faces
  std::vector<std::size_t> coarser_c_vertices;  ///< sizes of the certified coarser complexes
  TopologySummary reference;                    ///< counted on the reference surface complex, without what was dropped
  std::vector<RankedComponent> kept, dropped;   ///< as ExtractOptions asked, largest first; both empty if all were to be kept
  /// Adaptive supersampling: more c-vertices where triangles met, or where a bound could not be kept.
  std::size_t divided_c_vertices = 0;  ///< around which all faces were divided, every time counted
  std::size_t added_c_vertices = 0;
  int deepest_division = 0;      ///< how often faces were divided where that was done most often
  CertificateReport coarsening;  ///< certificate of the partition into blocks; repair_rounds are the rounds of check and cut
  std::vector<LevelReport> levels;
  std::vector<StageTime> seconds;  ///< in order: surface, components, coarsen, cover, certify, mesh, check, refine
  double total_seconds = 0;        ///< volume in memory to checked levels
};

struct Extraction {
  Hierarchy hierarchy;
  ExtractReport report;
  TriangleMesh mesh() const { return hierarchy.mesh(hierarchy.levels.size() - 1); }  ///< the finest level
  const LevelReport& finest() const { return report.levels.back(); }
};

/// Meshes the isosurface of a volume in nested levels: coarse, then refined; each with the topology of the reference surface, checked.
/// Constraints that cannot be met together are no error: see LevelReport::constraints.
///
/// @throws Error(bad_argument)  size < 2 along an axis, spacing not positive or different by more than 1e6 between axes, origin,
///                              direction or a corner of the volume not finite, fewer than 2^16 doubles to a voxel there, direction
///                              singular, isovalue not finite, max_radius <= 0, event_persistence < 0, supersample 0 or so large that
///                              there are too many samples, adaptive_supersample > kMostDivisions, min_component_size < 0 or not finite,
///                              a bound that its quantity cannot have
/// @throws Error(unsupported)   NaN or infinity while non_finite is `refuse` (message: count and first index); a direction that is
///                              not orthonormal, unless `refine` and `coarse` are empty and nothing is to be measured
/// @throws Error(empty_surface) no sample, or every sample, is inside (message: the range); every component was to be dropped
/// @throws Error(internal)      the finished mesh failed its own check: a bug; no mesh is returned
/// @throws Error(cancelled)     control.cancel was set
/// @post   same input, same bytes, for any number of threads
/// @cost   one pass over the volume, then O(C log C) for C c-vertices
/// @source Gavriliu, Carranza, Breen, Barr, IEEE Visualization 2001, sections 3.2 to 3.6, with the departures in docs/theory/
Extraction extract(const VolumeView& volume, const ExtractOptions& options, const RunControl& control = {});

/// Moves a mesh from sample-index coordinates into another space, turning triangles over where the map mirrors.
void transform_to(TriangleMesh& mesh, const Grid& grid, Space space);

}  // namespace isoatlas
