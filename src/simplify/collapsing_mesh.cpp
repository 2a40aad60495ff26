// SPDX-License-Identifier: Apache-2.0
#include "simplify/collapsing_mesh.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/sort_once.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kStarsPerChunk = 1024;

bool has_corner(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

Link::Edge opposite_edge(const Triangle& t, std::uint32_t v) {
  if (t[0] == v) return {t[1], t[2]};
  return t[1] == v ? Link::Edge{t[2], t[0]} : Link::Edge{t[0], t[1]};
}

// Whether the triangles at a vertex do not surround it: some corner is the end of no other edge.
bool has_gap(std::span<const std::uint32_t> star, std::span<const Triangle> triangles,
             std::uint32_t v) {
  std::vector<std::uint32_t> from, to;
  for (const std::uint32_t t : star) {
    const Link::Edge edge = opposite_edge(triangles[t], v);
    from.push_back(edge.from);
    to.push_back(edge.to);
  }
  ranges::sort(from);
  ranges::sort(to);
  return from != to;
}

}  // namespace

CollapsingMesh::CollapsingMesh(std::span<const Vec3> positions, std::vector<Triangle> triangles,
                               Vec3 spacing)
    : positions_(positions), triangles_(std::move(triangles)), spacing_(spacing) {
  std::vector<std::uint32_t> sizes(positions.size(), 0);
  for (const Triangle& t : triangles_) {
    for (const std::uint32_t v : t) ++sizes[v];
  }
  star_.reserve(sizes);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (const std::uint32_t v : triangles_[t]) star_.push_back(v, t);
  }
  is_on_boundary_.resize(positions.size());
  for_each_index(positions.size(), kStarsPerChunk, [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i);
    is_on_boundary_[v] = has_gap(star(v), triangles_, v) ? 1 : 0;
  });
}

std::vector<ChangedTriangle> CollapsingMesh::apply(const Collapse& collapse) {
  const auto [vertex, target] = collapse;
  std::vector<ChangedTriangle> changed;
  for (const std::uint32_t t : star(vertex)) changed.emplace_back(t, triangles_[t]);
  for (const auto& [t, before] : changed) {
    if (has_corner(before, target)) {
      for (const std::uint32_t corner : before) star_.erase(corner, t);
      triangles_[t] = {target, target, target};
    } else {
      star_.erase(vertex, t);
      star_.push_back(target, t);
      std::replace(triangles_[t].begin(), triangles_[t].end(), vertex, target);
    }
  }
  return changed;
}

void CollapsingMesh::revert(const Collapse& collapse, std::span<const ChangedTriangle> changed) {
  for (const auto& [t, before] : changed) {
    if (is_removed(triangles_[t])) {
      for (const std::uint32_t corner : before) star_.push_back(corner, t);
    } else {
      star_.erase(collapse.target, t);
      star_.push_back(collapse.vertex, t);
    }
    triangles_[t] = before;
  }
}

void Link::set(const CollapsingMesh& mesh, std::uint32_t v) {
  v_ = v;
  edges_.clear();
  vertices_.clear();
  for (const std::uint32_t t : mesh.star(v)) {
    edges_.push_back(opposite_edge(mesh.triangle(t), v));
    vertices_.push_back(edges_.back().from);
    vertices_.push_back(edges_.back().to);
  }
  sort_unique_ids(vertices_);
}

bool Link::permits(const CollapsingMesh& mesh, std::uint32_t target) {
  // The corners opposite the edge to the target: two, or one if this edge is on the boundary.
  opposite_.clear();
  std::size_t left = 0;  // triangles without the target
  for (const Edge& edge : edges_) {
    if (edge.from == target) {
      opposite_.push_back(edge.to);
    } else if (edge.to == target) {
      opposite_.push_back(edge.from);
    } else {
      ++left;
    }
  }
  const bool is_along_boundary = opposite_.size() == 1;
  if (left == 0 || mesh.is_on_boundary(v_) != is_along_boundary) return false;
  if (!is_along_boundary && mesh.is_on_boundary(target)) return false;
  // No other common neighbour, and no triangle of these corners on the other side.
  const auto is_opposite = [&](std::uint32_t w) {
    return w == opposite_.front() || w == opposite_.back();
  };
  const bool ends_in_one = left == 1 && !is_along_boundary;
  return ranges::none_of(mesh.star(target), [&](std::uint32_t t) {
    const auto [from, to] = opposite_edge(mesh.triangle(t), target);
    if (from == v_ || to == v_) return false;
    if (ends_in_one && is_opposite(from) && is_opposite(to)) return true;
    return ranges::any_of(std::array{from, to}, [&](std::uint32_t w) {
      return !is_opposite(w) && std::binary_search(vertices_.begin(), vertices_.end(), w);
    });
  });
}

}  // namespace isoatlas::detail
