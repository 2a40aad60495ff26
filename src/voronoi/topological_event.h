// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/c_vertex_graph.h"
#include "core/distance_queue.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Finds how far a geodesic disk can grow before its topology changes (paper, section 3.3 and figure 4).
///
/// C-vertices are settled in order of distance. An event is at one whose settled neighbours, in cyclic order, form more than
/// one arc: the front splits, or meets itself. A split whose island closes again within `persistence` does not count
/// (0-dimensional persistence of the distance function's superlevel sets; the outside, and what lies beyond the surface's
/// boundary, are one component of infinite height; for a handle the persistence is infinite). The whole component being
/// swallowed is an event, too.
class EventFinder {
 public:
  /// @param persistence  world length, >= 0
  /// @param first_stage  world length; the disk is grown to this radius, then to twice that, ... and no farther than the first event needs
  EventFinder(const CVertexGraph& graph, float persistence, float first_stage);

  /// The radius of the largest open disk around v without an event, or `limit` if there is none below it.
  float event_radius(CVertexId v, float limit, const RunControl& control = {});

 private:
  struct Finding {
    float event;    // smallest distance of an event
    float pending;  // smallest distance of a split that may be one, or may close yet
  };
  void settle_up_to(float radius, const RunControl& control);
  int settled_arcs(CVertexId v) const;
  Finding judge_splits(float reach, bool swallowed, const RunControl& control);
  bool settled_before(CVertexId v, std::uint32_t step) const { return stamp_[v] == 2 * round_ + 1 && step_[v] < step; }
  std::uint32_t find(std::uint32_t i);

  const CVertexGraph& graph_;
  float persistence_, first_stage_;

  // Scratch, valid where stamp_ says so: 2 * round_ means reached, 2 * round_ + 1 settled.
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> stamp_;
  std::vector<float> distance_;
  std::vector<std::uint32_t> step_;  // when settled
  NearestFirst front_;
  std::vector<CVertexId> settled_;     // in order
  std::vector<std::uint8_t> split_;    // per settled c-vertex, 1 if its settled neighbours were several arcs at the time
  std::size_t splits_ = 0;             // how many are
  std::vector<std::uint32_t> parent_;  // union-find over steps; the last one is the outside
  std::vector<float> peak_;            // per root, the largest distance in its component
};

}  // namespace isoatlas::detail
