// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/intersection_tracker.h"
#include "simplify/collapse_plan.h"
#include "simplify/nearby_isosurface.h"

namespace isoatlas::detail {

/// Removes vertices of a mesh by half-edge collapses, those first that are nearest to the triangles
/// that replace theirs. A collapse is kept if the mesh remains a manifold of the same topology, no
/// triangles intersect because of it in any form of the output, no badly shaped triangle becomes
/// worse, and the bound on the distance from the isosurface is still satisfied.
class VertexRemoval {
 public:
  /// @param tracker  has the mesh
  VertexRemoval(CollapsingMesh& mesh, IntersectionTracker& tracker, const BoxFaces& box,
                const CollapseLimits& limits, const RunControl& control)
      : mesh_(mesh), tracker_(tracker), box_(box), limits_(limits), control_(control) {}

  /// @param candidates  the vertices that may be removed, sorted
  /// @param isosurface  null: distances are not bounded
  /// @return the collapses that were kept, in their order
  /// @cost   some evaluations of each candidate; the time of each depends on its triangles alone
  std::vector<Collapse> remove(std::span<const std::uint32_t> candidates,
                               NearbyIsosurface* isosurface);

 private:
  struct Candidate {
    std::uint32_t vertex;
    PlannedCollapse planned;
    std::vector<std::uint32_t> excluded;  // targets that failed since its triangles changed
  };
  enum class State : std::uint8_t { kept, failed, reverted };
  struct Applied {
    std::uint32_t candidate;  // its number
    Collapse collapse;
    std::vector<ChangedTriangle> changed;
    State state = State::kept;
  };
  // Grid cells whose proof needs triangles that were changed, and their new proofs.
  struct NewProofs {
    std::vector<std::uint32_t> cells;  // sorted
    std::vector<std::vector<std::uint32_t>> proof;
  };

  void plan(std::span<const std::uint32_t> numbers, const NearbyIsosurface* isosurface);
  std::vector<Applied> apply(std::span<const std::uint32_t> active);
  void test(std::vector<Applied>& applied, NearbyIsosurface* isosurface);
  void test_distances(std::vector<Applied>& applied, std::span<const std::uint32_t> changed,
                      const NearbyIsosurface& isosurface, NewProofs& proofs) const;
  void test_triangles(std::vector<Applied>& applied, const NearbyIsosurface& isosurface) const;
  void test_intersections(std::vector<Applied>& applied, std::span<const std::uint32_t> changed);
  std::vector<std::uint32_t> revert_failed(std::vector<Applied>& applied);
  void fail(std::vector<Applied>& applied, std::uint32_t triangle) const;
  std::vector<std::uint32_t> next_to_plan(std::span<const Applied> applied);
  bool may_change(std::uint32_t vertex, const NearbyIsosurface* isosurface) const;
  std::uint32_t changed_by(std::uint32_t triangle) const;

  CollapsingMesh& mesh_;
  IntersectionTracker& tracker_;
  const BoxFaces& box_;
  const CollapseLimits& limits_;
  const RunControl& control_;
  std::vector<Candidate> candidates_;    // sorted by vertex
  std::vector<std::uint32_t> outdated_;  // candidates whose planned collapse is impossible by now
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      changed_by_;  // triangles changed in this round, with the number of the collapse; sorted
};

}  // namespace isoatlas::detail
