// SPDX-License-Identifier: Apache-2.0
#include "subdivide/adaptive_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/vector_math.h"
#include "embed/triangle_pair.h"

namespace isoatlas {
namespace {

// Along how many axes a point is on a layer of samples: none inside a cell, one on a wall, two on an edge.
int whole_coordinates(Vec3 p) { return (p.x == std::floor(p.x)) + (p.y == std::floor(p.y)) + (p.z == std::floor(p.z)); }

using Cell = std::array<double, 3>;
// Of a face that lies in one cell.
Cell cell_of(const SurfaceComplex& complex, const Face& face) {
  Vec3 sum;
  for (int k = 0; k < face.size(); ++k) sum = sum + complex.positions[face.corner[k]];
  sum = (1.0 / face.size()) * sum;
  return {std::floor(sum.x), std::floor(sum.y), std::floor(sum.z)};
}

void sort_unique(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

AdaptiveSurface::AdaptiveSurface(SurfaceComplex complex, Components components, TrilinearField field)
    : complex_(std::move(complex)),
      components_(std::move(components)),
      field_(std::move(field)),
      crowded_(complex_, field_),
      depth_(complex_.c_vertex_count(), 0),
      deep_(complex_.c_vertex_count(), 0) {
  for (Vec3& p : complex_.positions) p = rounded(p);
  crowded_.separate(complex_);
  hold();
}

// C-vertices inside a cell roam: what is there is a cone about them, or is looked at by stray(). So do nodes, on their edge, and points on walls,
// unless there are crowded cells beside them, or two curves on the wall. What was divided further was looked at as it is.
void AdaptiveSurface::hold() {
  const std::uint32_t n = complex_.c_vertex_count();
  held_.resize(n, 0);
  for (CVertexId v = 0; v < n; ++v) held_[v] = complex_.on_boundary[v] || deep_[v];
  for (const Face& face : complex_.faces) {
    const int size = face.size();
    if (std::none_of(face.corner.begin(), face.corner.begin() + size, [&](CVertexId v) { return crowded_.contains(v); })) continue;
    for (int k = 0; k < size; ++k) {
      if (!crowded_.contains(face.corner[k])) held_[face.corner[k]] |= whole_coordinates(complex_.positions[face.corner[k]]) > 0;
    }
  }
  for (CVertexId v = 0; v < n; ++v) {
    const Vec3 p = complex_.positions[v];
    if (!held_[v] && whole_coordinates(p) == 1) held_[v] = has_two_curves(field_, p);
  }
}

// The next step for each. Where pieces become smaller, what else is in their cells has to be in pieces first, to be looked at with them.
void AdaptiveSurface::divide(std::span<const CVertexId> wanted) {
  const std::vector<Fineness> was = fineness();
  std::vector<std::uint8_t> is_wanted(complex_.c_vertex_count(), 0);
  for (const CVertexId v : wanted) is_wanted[v] = was[v] == Fineness::pieces;
  std::vector<Cell> cells;
  for (const Face& face : complex_.faces) {
    const auto end = face.corner.begin() + face.size();
    if (std::any_of(face.corner.begin(), end, [&](CVertexId v) { return is_wanted[v]; })) cells.push_back(cell_of(complex_, face));
  }
  sort_unique(cells);
  std::vector<Fineness> now = was;
  for (;; now = fineness()) {
    std::vector<CVertexId> coarser;
    for (CVertexId v = 0; v < complex_.c_vertex_count() && !cells.empty(); ++v) {
      const Vec3 p = complex_.positions[v];
      if (now[v] == Fineness::pieces || whole_coordinates(p) > 0) continue;
      if (std::binary_search(cells.begin(), cells.end(), Cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)})) coarser.push_back(v);
    }
    if (coarser.empty()) break;
    divide_once(coarser, now);
  }
  std::vector<CVertexId> left;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(left), [&](CVertexId v) { return now[v] == was[v]; });
  divide_once(left, now);
  hold();
}

void AdaptiveSurface::divide_once(std::span<const CVertexId> wanted, const std::vector<Fineness>& was) {
  const CVertexId before = complex_.c_vertex_count();
  int deepest = 0;
  for (const CVertexId v : wanted) deepest = std::max(deepest, depth_[v] + 1);
  Subdivision divided = subdivide(complex_, wanted, {field_, crowded_.flags()});
  complex_ = std::move(divided.complex);
  for (const CVertexId from : divided.origin) {
    components_.of_c_vertex.push_back(components_.of_c_vertex[from]);
    depth_.push_back(static_cast<std::uint8_t>(std::min(deepest, depth_[from] + 1)));
  }
  divided_ += wanted.size();
  added_ += divided.origin.size();
  if (!divided.origin.empty()) deepest_ = std::max(deepest_, deepest);
  deep_.resize(complex_.c_vertex_count(), 0);
  if (std::any_of(wanted.begin(), wanted.end(), [&](CVertexId v) { return was[v] == Fineness::pieces; })) flatten_where_pieces_meet(divided, before);
}

// Pieces of flat triangles that are flat themselves meet no more than the triangles do. So wherever pieces of one cell meet, the new
// points there go back to the middles of their sides.
void AdaptiveSurface::flatten_where_pieces_meet(const Subdivision& divided, CVertexId first_new) {
  const auto is_middle = [&](CVertexId v) { return v >= first_new && divided.between[v - first_new][0] != kNone; };
  std::vector<std::pair<Cell, Triangle>> pieces;  // of the cells with such points
  const auto has_middle = [&](const Face& face) { return std::any_of(face.corner.begin(), face.corner.begin() + 3, is_middle); };
  std::vector<Cell> cells;
  for (const Face& face : complex_.faces) {
    if (!face.is_triangle() || !has_middle(face)) continue;
    cells.push_back(cell_of(complex_, face));
  }
  sort_unique(cells);
  for (const Face& face : complex_.faces) {
    if (!face.is_triangle()) continue;
    const Cell cell = cell_of(complex_, face);
    if (!std::binary_search(cells.begin(), cells.end(), cell)) continue;
    pieces.emplace_back(cell, Triangle{face.corner[0], face.corner[1], face.corner[2]});
    for (int k = 0; k < 3; ++k) deep_[face.corner[k]] = 1;
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (bool again = true; again;) {  // a point on a wall is in two cells
    again = false;
    for (std::size_t from = 0, to; from < pieces.size(); from = to) {
      to = from;
      while (to < pieces.size() && pieces[to].first == pieces[from].first) ++to;
      bool meet = false;
      for (std::size_t i = from; i < to && !meet; ++i) {
        for (std::size_t j = i + 1; j < to && !meet; ++j) meet = meet_beyond_shared(complex_.positions, pieces[i].second, pieces[j].second);
      }
      if (!meet) continue;
      for (std::size_t i = from; i < to; ++i) {
        for (const CVertexId v : pieces[i].second) {
          if (!is_middle(v)) continue;
          const auto [a, b] = divided.between[v - first_new];
          const Vec3 flat = 0.5 * (complex_.positions[a] + complex_.positions[b]);
          again = again || !(complex_.positions[v] == flat);
          complex_.positions[v] = flat;
        }
      }
    }
  }
}

}  // namespace isoatlas
