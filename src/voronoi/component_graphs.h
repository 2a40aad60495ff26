// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "complex/c_vertex_graph.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The components of a graph as groups, each a graph of its own: to work on them at the same time. Groups are in the order in which
/// Covering::cover() starts components: first those with a boundary, by their first c-vertex there, then the others, by their first
/// c-vertex. A group has one component or several small ones. Its c-vertices are in increasing order.
class ComponentGraphs {
 public:
  /// @cost O(entries of the graph); 12 bytes per c-vertex
  explicit ComponentGraphs(const CVertexGraph& graph, const RunControl& control = {});

  std::uint32_t count() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  /// The c-vertices of the whole graph that are those of the group, one by one.
  std::span<const CVertexId> c_vertices(std::uint32_t group) const {
    return std::span(c_vertices_).subspan(first_[group], first_[group + 1] - first_[group]);
  }
  CVertexGraph graph_of(std::uint32_t group, const RunControl& control = {}) const;
  /// All groups, the largest first.
  std::span<const std::uint32_t> by_size() const { return by_size_; }

 private:
  const CVertexGraph& whole_;
  std::vector<std::uint32_t> first_;  // per group, in c_vertices_
  std::vector<CVertexId> c_vertices_;
  std::vector<CVertexId> number_;  // per c-vertex of the whole graph, in its group
  std::vector<std::uint32_t> by_size_;
};

}  // namespace isoatlas::detail
