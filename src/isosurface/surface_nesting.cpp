// SPDX-License-Identifier: Apache-2.0
// Below the lowest node of a closed component there is no other part of it, so the sample there is
// outside of what it encloses. The component lies in those components that the line through this
// sample has entered and not left on its way up from below the volume.
// docs/theory/02-certificate.md
#include "isosurface/surface_nesting.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "core/ranges.h"

namespace isoatlas::detail {

Nesting surface_nesting(const Components& components, std::span<const VerticalNode> nodes) {
  const std::size_t n = components.topology.size();
  const auto component_of = [&](const VerticalNode& node) {
    return components.of_c_vertex[node.c_vertex];
  };
  const auto is_closed = [&](ComponentId c) { return components.topology[c].boundary_loops == 0; };
  // Per component, its lowest node. (A surfel is not contained in one face of its cell, so the
  // lowest cells have nodes on vertical edges.)
  std::vector<const VerticalNode*> lowest(n, nullptr);
  for (const VerticalNode& node : nodes) {
    const VerticalNode*& best = lowest[component_of(node)];
    if (best == nullptr || std::tie(node.z, node.y, node.x) < std::tie(best->z, best->y, best->x))
      best = &node;
  }
  Nesting nesting;
  nesting.facing.assign(n, 0);
  using Column = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Column> columns;  // those with the lowest node of a closed component
  for (ComponentId c = 0; c < n; ++c) {
    if (!is_closed(c) || lowest[c] == nullptr) continue;
    nesting.facing[c] = lowest[c]->outside_is_up ? -1 : 1;
    columns.emplace_back(lowest[c]->y, lowest[c]->x);
  }
  ranges::sort(columns);
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());

  std::vector<const VerticalNode*> on_columns;
  for (const VerticalNode& node : nodes) {
    if (is_closed(component_of(node)) && ranges::binary_search(columns, Column{node.y, node.x}))
      on_columns.push_back(&node);
  }
  ranges::sort(on_columns, [](const VerticalNode* a, const VerticalNode* b) {
    return std::tie(a->y, a->x, a->z) < std::tie(b->y, b->x, b->z);
  });
  std::vector<std::vector<std::uint32_t>> enclosing(n);
  std::map<ComponentId, int> winding;  // of the components that the column has crossed so far;
                                       // closed components have 0 again at its end
  for (const VerticalNode* node : on_columns) {
    const ComponentId c = component_of(*node);
    if (node == lowest[c]) {
      for (const auto& [other, times] : winding) enclosing[c].push_back(other);
    }
    int& times = winding[c];
    times += node->outside_is_up ? -1 : 1;
    if (times == 0) winding.erase(c);
  }
  nesting.parent = parents_of(enclosing);
  return nesting;
}

}  // namespace isoatlas::detail
