// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "complex/c_vertex_graph.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Groups of connected components, each with a graph of its own, so that they can be covered in
/// parallel. Groups are in the order in which Covering::cover() starts components: first those with
/// a boundary, by their first boundary c-vertex, then the others, by their first c-vertex. A group
/// is one component or several small ones. Its c-vertices are in increasing order.
class ComponentGraphs {
 public:
  /// @cost O(entries of the graph); 12 bytes per c-vertex
  explicit ComponentGraphs(const CVertexGraph& graph, const RunControl& control = {});

  std::uint32_t count() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  /// Per c-vertex of the group's graph, its id in the whole graph.
  std::span<const CVertexId> c_vertices(std::uint32_t group) const {
    return std::span(c_vertices_).subspan(first_[group], first_[group + 1] - first_[group]);
  }
  CVertexGraph subgraph(std::uint32_t group, const RunControl& control = {}) const;
  /// All groups, the largest first.
  std::span<const std::uint32_t> by_size() const { return by_size_; }

 private:
  const CVertexGraph& graph_;
  std::vector<std::uint32_t> first_;  // per group, in c_vertices_
  std::vector<CVertexId> c_vertices_;
  std::vector<CVertexId>
      id_in_group_;  // per c-vertex of the whole graph, its id in the group's graph
  std::vector<std::uint32_t> by_size_;
};

}  // namespace isoatlas::detail
