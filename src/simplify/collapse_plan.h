// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "geometry/box_faces.h"
#include "optimize/shape_goal.h"
#include "simplify/collapsing_mesh.h"

namespace isoatlas::detail {

/// What a mesh must satisfy after a collapse. Lengths are metric.
struct CollapseLimits {
  ShapeGoal shape;  ///< triangles that violate it must not become worse
  double max_edge = std::numeric_limits<double>::infinity();
  double max_distance = std::numeric_limits<double>::infinity();  ///< from the isosurface
};

struct PlannedCollapse {
  Collapse collapse;                                      ///< target kNone: none is possible
  double cost = std::numeric_limits<double>::infinity();  ///< collapses of lower cost come first
};

/// Chooses the neighbour onto which a vertex is moved. Use one planner per thread.
class CollapsePlanner {
 public:
  /// @param box  faces of the volume, in sample-index coordinates; boundary vertices stay on them
  CollapsePlanner(const CollapsingMesh& mesh, const BoxFaces& box, const CollapseLimits& limits)
      : mesh_(mesh), box_(box), limits_(limits) {}

  /// The collapse that preserves the topology, turns no triangle over, and gives the best shaped
  /// triangles; costs are the distance of the vertex from the triangles that replace its own.
  /// @param excluded  targets that were tried before
  PlannedCollapse plan(std::uint32_t vertex, std::span<const std::uint32_t> excluded);

  /// Whether a planned collapse still preserves the topology: its target may have got other
  /// neighbours since.
  bool is_possible(const Collapse& collapse);

 private:
  struct Fan {
    double shape, distance;  // score of the worst triangle; of the removed vertex from the fan
  };
  bool measure_star();
  bool measure_fan(std::uint32_t target, Fan& fan) const;

  const CollapsingMesh& mesh_;
  const BoxFaces& box_;
  const CollapseLimits& limits_;
  Link link_;
  std::uint32_t vertex_ = kNone;
  Vec3 normal_;       // of the star, unit
  double shape_ = 0;  // score of its worst triangle
};

}  // namespace isoatlas::detail
