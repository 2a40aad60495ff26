// SPDX-License-Identifier: Apache-2.0
#include "voronoi/component_graphs.h"

#include <algorithm>
#include <numeric>

#include "core/cancel_poll.h"
#include "core/ranges.h"

namespace isoatlas::detail {
namespace {

constexpr std::uint32_t kMinGroupSize =
    1024;  // c-vertices per group; only the last one may have fewer

}  // namespace

ComponentGraphs::ComponentGraphs(const CVertexGraph& graph, const RunControl& control)
    : graph_(graph), first_{0} {
  CancelPoll poll(control);
  const CVertexId n = graph.c_vertex_count();
  std::vector<std::uint32_t> group_of(n, kNone), size;
  std::vector<CVertexId> front;
  const auto add_component = [&](CVertexId start) {
    if (group_of[start] != kNone) return;
    if (size.empty() || size.back() >= kMinGroupSize) size.push_back(0);
    const auto group = static_cast<std::uint32_t>(size.size() - 1);
    front.push_back(start);
    group_of[start] = group;
    while (!front.empty()) {
      poll.step();
      const CVertexId v = front.back();
      front.pop_back();
      ++size[group];
      for (const CVertexGraph::Neighbour& w : graph.row(v)) {
        if (group_of[w.id] != kNone) continue;
        group_of[w.id] = group;
        front.push_back(w.id);
      }
    }
  };
  for (CVertexId v = 0; v < n; ++v) {
    if (graph.on_boundary[v]) add_component(v);
  }
  for (CVertexId v = 0; v < n; ++v) add_component(v);

  for (const std::uint32_t s : size) first_.push_back(first_.back() + s);
  c_vertices_.resize(n);
  id_in_group_.resize(n);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (CVertexId v = 0; v < n; ++v) {
    poll.step();
    const std::uint32_t group = group_of[v];
    id_in_group_[v] = next[group] - first_[group];
    c_vertices_[next[group]++] = v;
  }
  by_size_.resize(size.size());
  std::iota(by_size_.begin(), by_size_.end(), 0u);
  ranges::stable_sort(by_size_, std::greater<>{}, [&](std::uint32_t group) { return size[group]; });
}

CVertexGraph ComponentGraphs::subgraph(std::uint32_t group, const RunControl& control) const {
  CancelPoll poll(control);
  const std::span<const CVertexId> own = c_vertices(group);
  CVertexGraph out;
  out.first.resize(own.size() + 1);
  out.on_boundary.resize(own.size());
  for (std::size_t k = 0; k < own.size(); ++k)
    out.first[k + 1] = out.first[k] + static_cast<std::uint32_t>(graph_.row(own[k]).size());
  out.neighbours.resize(out.first.back());
  out.is_diagonal.resize(out.first.back());
  for (std::size_t k = 0; k < own.size(); ++k) {
    poll.step();
    const CVertexId v = own[k];
    ranges::transform(graph_.row(v), out.neighbours.begin() + out.first[k],
                      [&](const CVertexGraph::Neighbour& w) {
                        return CVertexGraph::Neighbour{id_in_group_[w.id], w.weight};
                      });
    std::copy(graph_.is_diagonal.begin() + graph_.first[v],
              graph_.is_diagonal.begin() + graph_.first[v + 1],
              out.is_diagonal.begin() + out.first[k]);
    out.on_boundary[k] = graph_.on_boundary[v];
  }
  return out;
}

}  // namespace isoatlas::detail
