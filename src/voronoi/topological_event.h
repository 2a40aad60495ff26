// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/c_vertex_graph.h"
#include "core/distance_queue.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Finds how far a geodesic disk can grow before its topology changes (paper, section 3.3 and
/// figure 4).
///
/// C-vertices are settled in order of distance (as in Dijkstra's algorithm). An event happens at a
/// c-vertex whose settled neighbours, in cyclic order, form more than one arc: the front splits or
/// touches itself. A split whose island closes again within `persistence` does not count
/// (0-dimensional persistence of the distance function's superlevel sets; the outside of the disk
/// and everything beyond the surface's boundary form one component of infinite height; for a handle
/// the persistence is infinite). It is also an event if the disk swallows the whole component.
class EventFinder {
 public:
  /// @param persistence  world length, >= 0
  /// @param first_stage  world length; the disk is grown to this radius, then to twice that, and so
  ///                     on, no farther than the first event requires
  EventFinder(const CVertexGraph& graph, float persistence, float first_stage);

  /// The radius of the largest open disk around v without an event, or `limit` if no event
  /// occurs below it.
  float event_radius(CVertexId v, float limit, const RunControl& control = {});

 private:
  struct SplitEvents {
    float event;    // smallest distance of an event
    float pending;  // smallest distance of a split that is undecided: it may still close
  };
  void settle_up_to(float radius, const RunControl& control);
  int settled_arcs(CVertexId v) const;
  SplitEvents classify_splits(float reach, bool swallowed, const RunControl& control);
  bool settled_before(CVertexId v, std::uint32_t step) const {
    return stamp_[v] == 2 * round_ + 1 && step_[v] < step;
  }
  std::uint32_t find(std::uint32_t i);

  const CVertexGraph& graph_;
  float persistence_, first_stage_;

  // Scratch memory, valid where stamp_ is 2 * round_ (reached) or 2 * round_ + 1 (settled).
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> stamp_;
  std::vector<float> distance_;
  std::vector<std::uint32_t> step_;  // the order in which c-vertices were settled
  NearestFirst front_;
  std::vector<CVertexId> settled_;  // in this order
  std::vector<std::uint8_t>
      split_;  // per settled c-vertex, 1 if its settled neighbours formed several arcs at that time
  std::size_t splits_ = 0;             // number of splits
  std::vector<std::uint32_t> parent_;  // union-find over steps; the last element is the outside
  std::vector<float> peak_;            // per root, the largest distance in its component
};

}  // namespace isoatlas::detail
