// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/certificate.h"
#include "isoatlas/export.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas {

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

ISOATLAS_API TopologySummary summarize(const std::vector<ComponentTopology>& components);

struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// A cell that is over its bound and cannot be made smaller: it would no longer contain all
/// neighbours of its site (paper, 3.4).
struct CellAtLimit {
  Vec3 position;      ///< of its vertex, in the mesh's space
  double excess = 0;  ///< worst of metric / bound
};

/// A triangle below the aspect ratio that was asked for, or below 1/3, or with an angle above 150
/// degrees.
struct BadTriangle {
  Vec3 position;  ///< its centroid, in the mesh's space
  double aspect_ratio = 0;
  double largest_angle = 0;  ///< degrees
  ShapeObstacle obstacle = ShapeObstacle::none;
};

struct ISOATLAS_API LevelReport {
  std::size_t vertices = 0, triangles = 0;
  TopologySummary topology;             ///< counted on the finished triangles, independently
  CertificateReport certificate;        ///< of the level's partition
  std::size_t inverted_components = 0;  ///< components that still do not face outward on the whole,
                                        ///< see docs/theory/02-certificate.md
  MeshQuality quality;                  ///< measured in world units, whatever the mesh's space
  std::optional<std::array<MetricSummary, kMetricCount>>
      metrics;  ///< none for a coarse mesh that is all that was asked for
  /// In the order given. Of max-distance the larger one of the metric and of what was measured, if
  /// that was asked for.
  std::vector<ConstraintResult> constraints;
  /// Proved: no point of the mesh is farther from the isosurface, and none of the isosurface from
  /// the mesh; world units, see docs/theory/05-refinement.md. None: distances are only sampled.
  std::optional<double> distance_at_most;
  std::vector<CellAtLimit> at_limit;  ///< worst first; supersampling would help there
  std::size_t refine_rounds = 0;
  /// For the triangles' shape: edges flipped, vertices moved to a better c-vertex, and vertices
  /// moved within their grid cells.
  std::size_t flips = 0, moves = 0, displacements = 0;
  std::vector<BadTriangle> bad_triangles;  ///< what is left, worst first
  /// Pairs of triangles that meet where they should not, counted on the finished mesh in the
  /// output's space; none: they are allowed.
  std::optional<std::size_t> self_intersections;
  std::vector<Vec3>
      self_intersection_positions;          ///< near the first few of them, in the mesh's space
  std::size_t sites_for_intersections = 0;  ///< sites added to take such triangles apart
  std::optional<Measurement> measured;      ///< if asked for
  /// Largest distance in world units by which a written file rounds a position of this level; 0
  /// from extract(). What writes files sets it and adds it to the lengths in `metrics`,
  /// `distance_at_most` and `constraints`.
  double rounding = 0;
  double seconds = 0;

  bool all_satisfied() const;  ///< all constraints but those that nobody asked for
};

/// A component whose size was looked at, to keep it or to leave it out.
struct RankedComponent {
  Vec3 position;  ///< of its first c-vertex in scan order, in the mesh's space
  std::size_t part =
      0;  ///< its rank by size, from 0; components that the border's cap connects are one part
  double size = 0;  ///< of the part, see ExtractOptions::min_component_size, world units cubed
  std::size_t c_vertices = 0;
  ComponentTopology topology;
};

struct ExtractReport {
  std::size_t c_vertices = 0;  ///< of the reference surface complex
  std::size_t faces = 0;
  std::size_t double_segments = 0;  ///< places split so that the dual of G is simplicial
  std::size_t tunnels = 0;          ///< cells with an annulus; 0 with Topology::faces
  std::vector<std::size_t> coarser_c_vertices;  ///< sizes of the certified coarser complexes
  TopologySummary
      reference;  ///< counted on the reference surface complex, without what was dropped
  std::vector<RankedComponent> kept,
      dropped;  ///< as ExtractOptions asked, largest first; both empty if all were to be kept
  /// Adaptive supersampling: more c-vertices where triangles met, or where a bound could not be
  /// kept.
  std::size_t subdivided_c_vertices =
      0;  ///< around which all faces were divided, every time counted
  std::size_t added_c_vertices = 0;
  int max_subdivision_depth = 0;  ///< how often faces were divided where that was done most often
  CertificateReport coarsening;   ///< certificate of the partition into blocks; repair_rounds are
                                  ///< the rounds of check and cut
  std::vector<LevelReport> levels;
  std::vector<StageTime>
      seconds;  ///< in order: surface, components, coarsen, cover, certify, mesh, check, refine
  double total_seconds = 0;  ///< volume in memory to checked levels
};

}  // namespace isoatlas
