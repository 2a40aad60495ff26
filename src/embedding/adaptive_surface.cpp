// SPDX-License-Identifier: Apache-2.0
#include "embedding/adaptive_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/append.h"
#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

// Along how many axes a point is on a layer of samples: none inside a cell, one on a wall, two on an edge.
int whole_coordinates(Vec3 p) { return (p.x == std::floor(p.x)) + (p.y == std::floor(p.y)) + (p.z == std::floor(p.z)); }

using Cell = WatchedCells::Cell;
constexpr std::size_t kPerPiece = 8192;  // c-vertices or faces, of a parallel loop

Cell cell_of(Vec3 p) { return {std::floor(p.x), std::floor(p.y), std::floor(p.z)}; }
// Of a face that lies in one cell.
Cell cell_of(const SurfaceComplex& complex, const Face& face) {
  Vec3 sum;
  for (int k = 0; k < face.size(); ++k) sum = sum + complex.positions[face.corner[k]];
  return cell_of((1.0 / face.size()) * sum);
}

void sort_unique(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

AdaptiveSurface::AdaptiveSurface(SurfaceComplex complex, Components components, Nesting nesting, InterpolatedField field,
                                 const RunControl& control)
    : complex_(std::move(complex)),
      components_(std::move(components)),
      nesting_(std::move(nesting)),
      field_(std::move(field)),
      control_(without_stages(control)),
      crowded_(complex_, field_, control_),
      parsed_(complex_.c_vertex_count()),
      depth_(parsed_, 0) {
  for_each_index(parsed_, kPerPiece, [&](std::size_t v) { complex_.positions[v] = rounded(complex_.positions[v]); });
  found_ = complex_.positions;
  report_going_on(control_);
  crowded_.separate(complex_, control_);
  report_going_on(control_);
  watch();
}

// C-vertices inside a cell roam: what is there is a cone about them, or the cell is watched. So do nodes, on their edges, and points on
// walls, once all faces around them are fans or pieces and the cells beside them are cones or watched.
void AdaptiveSurface::watch() {
  const std::uint32_t n = complex_.c_vertex_count();
  const std::vector<Fineness> now = fineness();
  std::vector<std::uint8_t> is_watched(n, 0);  // in a cell that will be, if inside a cell
  std::vector<std::uint8_t> in_two_curves(n, 0);
  held_.assign(n, 0);
  CancelPoll poll(control_);
  for_each_index(n, kPerPiece, &control_, [&](std::size_t i) {
    const auto v = static_cast<CVertexId>(i);
    const int whole = whole_coordinates(complex_.positions[v]);
    in_two_curves[v] = whole == 1 && has_two_curves(field_, complex_.positions[v]);
    const bool parsed_on_border = v < parsed_ && whole == 1 && !in_two_curves[v];
    held_[v] = whole > 0 && now[v] == Fineness::faces && !parsed_on_border;
    is_watched[v] = whole == 0 && crowded_.contains(v);
  });
  control_.check_cancelled();
  std::vector<Cell> cells = deep_cells_;
  const auto add_inside = [&](const Face& face, std::vector<CVertexId>& found) {  // such cells
    const int size = face.size();
    const auto end = face.corner.begin() + size;
    if (std::none_of(face.corner.begin(), end, [&](CVertexId v) { return in_two_curves[v] || is_watched[v]; })) return;
    for (int k = 0; k < size; ++k) {
      const CVertexId v = face.corner[k];
      if (whole_coordinates(complex_.positions[v]) > 0) continue;
      if (in_two_curves[face.corner[(k + 1) % size]] || in_two_curves[face.corner[(k + 2) % size]] || is_watched[v]) found.push_back(v);
    }
  };
  std::vector<CVertexId> inside =
      collect_pieces<CVertexId>(complex_.face_count(), kPerPiece, [&](std::size_t begin, std::size_t end, auto& found) {
        control_.check_cancelled();
        for (std::size_t f = begin; f < end; ++f) add_inside(complex_.faces[f], found);
      });
  control_.check_cancelled();
  std::sort(inside.begin(), inside.end());
  inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
  for (const CVertexId v : inside) cells.push_back(cell_of(complex_.positions[v]));
  if (!deep_cells_.empty()) {  // only these have c-vertices that came with a subdivision
    inside.clear();
    for (CVertexId v = 0; v < n; ++v) {
      if (whole_coordinates(complex_.positions[v]) == 0) inside.push_back(v);
    }
  }
  control_.check_cancelled();
  sort_unique(cells);
  control_.check_cancelled();
  // Cells with faces that are not even fans cannot be watched.
  std::vector<Cell> closed;
  for (const CVertexId v : inside) {
    poll.step();
    if (now[v] != Fineness::faces) continue;
    const Cell cell = cell_of(complex_.positions[v]);
    if (std::binary_search(cells.begin(), cells.end(), cell)) closed.push_back(cell);
  }
  sort_unique(closed);
  is_closed_.assign(n, 0);
  for_each_index(inside.size(), kPerPiece, &control_, [&](std::size_t i) {
    is_closed_[inside[i]] = std::binary_search(closed.begin(), closed.end(), cell_of(complex_.positions[inside[i]]));
  });
  for (const Face& face : complex_.faces) {
    if (std::none_of(face.corner.begin(), face.corner.begin() + face.size(), [&](CVertexId v) { return is_closed_[v]; })) continue;
    for (int k = 0; k < face.size(); ++k) held_[face.corner[k]] |= whole_coordinates(complex_.positions[face.corner[k]]) > 0;
  }
  report_going_on(control_);
  std::vector<Cell> open;
  std::set_difference(cells.begin(), cells.end(), closed.begin(), closed.end(), std::back_inserter(open));
  watched_ = WatchedCells(complex_, open, control_);
}

std::vector<CVertexId> AdaptiveSurface::stray(std::span<const CVertexId> moved, std::span<const Vec3> before, std::span<Vec3> positions,
                                              std::span<const CVertexId> look) const {
  struct Mover {
    CVertexId v;
    std::uint32_t number;  // in `moved`
    bool is_back = false;
  };
  std::vector<Mover> movers;
  movers.reserve(moved.size());
  for (std::uint32_t i = 0; i < moved.size(); ++i) movers.push_back({moved[i], i});
  std::ranges::sort(movers, {}, &Mover::v);
  std::vector<std::pair<CVertexId, Vec3>> changed;  // what is to be undone
  std::vector<CVertexId> out, next(look.begin(), look.end());
  while (!next.empty()) {
    std::vector<CVertexId> back = watched_.meeting(next, positions, control_);
    for (const CVertexId v : crowded_.meeting(next, positions, control_)) {
      if (is_closed_[v]) back.push_back(v);
    }
    next.clear();
    for (const CVertexId v : back) {
      const auto mover = std::ranges::lower_bound(movers, v, {}, &Mover::v);
      if (mover == movers.end() || mover->v != v || std::exchange(mover->is_back, true)) continue;
      changed.emplace_back(v, std::exchange(positions[v], before[mover->number]));
      next.push_back(v);
    }
    out.insert(out.end(), next.begin(), next.end());
  }
  for (const auto& [v, position] : changed) positions[v] = position;
  return out;
}

// Crowded cells are divided as a whole, or not at all, so that they can be watched: also those that a face to be divided reaches into.
std::vector<CVertexId> AdaptiveSurface::with_crowded_cells(std::span<const CVertexId> wanted) const {
  std::vector<std::uint8_t> is_wanted(complex_.c_vertex_count(), 0);
  for (const CVertexId v : wanted) is_wanted[v] = 1;
  std::vector<CVertexId> out(wanted.begin(), wanted.end());
  const auto want_cell_of = [&](CVertexId v) {
    for (const CVertexId w : crowded_.beside(v)) {
      if (std::exchange(is_wanted[w], std::uint8_t{1}) == 0) out.push_back(w);
    }
  };
  for (const CVertexId v : wanted) {
    if (crowded_.contains(v)) want_cell_of(v);
  }
  for (std::size_t before = 0; before != out.size();) {
    before = out.size();
    control_.check_cancelled();
    for (const Face& face : complex_.faces) {
      if (face.is_triangle()) continue;
      const auto end = face.corner.begin() + face.size();
      if (std::none_of(face.corner.begin(), end, [&](CVertexId v) { return is_wanted[v]; })) continue;
      for (auto v = face.corner.begin(); v != end; ++v) {
        if (crowded_.contains(*v)) want_cell_of(*v);
      }
    }
  }
  return out;
}

// Those that are alone in a cell, which they may be anywhere in, while nothing around them is divided.
void AdaptiveSurface::keep_off_walls(std::span<const CVertexId> wanted, std::span<const CVertexId> pinned) {
  std::vector<std::uint8_t> stays(complex_.c_vertex_count(), 0);
  for (const CVertexId v : pinned) stays[v] = 1;
  for (const Face& face : complex_.faces) {
    if (!face.is_triangle()) continue;
    for (int k = 0; k < 3; ++k) stays[face.corner[k]] = 1;
  }
  for (const CVertexId v : wanted) {
    Vec3& p = complex_.positions[v];
    if (stays[v] || crowded_.contains(v) || whole_coordinates(p) > 0) continue;
    const auto inside = [](double x) { return std::clamp(x, std::floor(x) + kWallMargin, std::floor(x) + 1 - kWallMargin); };
    const Vec3 kept = rounded({inside(p.x), inside(p.y), inside(p.z)});
    if (kept == p) continue;
    p = kept;
    touched_.push_back(v);
  }
}

// The next step for each. Where pieces become smaller, what else is in their cells has to be in pieces first, to be looked at with them.
void AdaptiveSurface::divide(std::span<const CVertexId> wanted, std::span<const CVertexId> pinned) {
  const std::vector<Fineness> was = fineness();
  touched_.clear();
  keep_off_walls(wanted, pinned);
  std::vector<std::uint8_t> is_wanted(complex_.c_vertex_count(), 0);
  for (const CVertexId v : wanted) is_wanted[v] = was[v] == Fineness::pieces;
  std::vector<Cell> cells;
  for (const Face& face : complex_.faces) {
    const auto end = face.corner.begin() + face.size();
    if (std::any_of(face.corner.begin(), end, [&](CVertexId v) { return is_wanted[v]; })) cells.push_back(cell_of(complex_, face));
  }
  control_.check_cancelled();
  sort_unique(cells);
  std::vector<Fineness> now = was;
  for (;; now = fineness()) {
    std::vector<CVertexId> coarser;
    for (CVertexId v = 0; v < complex_.c_vertex_count() && !cells.empty(); ++v) {
      const Vec3 p = complex_.positions[v];
      if (now[v] == Fineness::pieces || whole_coordinates(p) > 0) continue;
      if (std::binary_search(cells.begin(), cells.end(), cell_of(p))) coarser.push_back(v);
    }
    control_.check_cancelled();
    if (coarser.empty()) break;
    report_going_on(control_);
    divide_once(with_crowded_cells(coarser), now);
  }
  std::vector<CVertexId> left;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(left), [&](CVertexId v) { return now[v] == was[v]; });
  divide_once(with_crowded_cells(left), now);
  report_going_on(control_);
  watch();
}

void AdaptiveSurface::divide_once(std::span<const CVertexId> wanted, const std::vector<Fineness>& was) {
  const CVertexId before = complex_.c_vertex_count();
  int deepest = 0;
  for (const CVertexId v : wanted) deepest = std::max(deepest, depth_[v] + 1);
  const Subdivision divided = subdivide_in_place(complex_, wanted, was, {field_, crowded_.flags(), &control_});
  report_going_on(control_);
  touched_.insert(touched_.end(), divided.touched.begin(), divided.touched.end());
  std::vector<ComponentId> component;
  std::vector<std::uint8_t> depth;
  for (const CVertexId from : divided.origin) {
    component.push_back(components_.of_c_vertex[from]);
    depth.push_back(static_cast<std::uint8_t>(std::min(deepest, depth_[from] + 1)));
  }
  append(components_.of_c_vertex, component.begin(), component.end());
  append(depth_, depth.begin(), depth.end());
  append(found_, complex_.positions.begin() + before, complex_.positions.end());
  divided_ += wanted.size();
  added_ += divided.origin.size();
  if (!divided.origin.empty()) deepest_ = std::max(deepest_, deepest);
  if (std::any_of(wanted.begin(), wanted.end(), [&](CVertexId v) { return was[v] == Fineness::pieces; }))
    flatten_where_pieces_meet(divided, before);
}

// Pieces of flat triangles that are flat themselves meet no more than the triangles do. So wherever pieces of one cell meet, the new
// points there go back to the middles of their sides.
void AdaptiveSurface::flatten_where_pieces_meet(const Subdivision& divided, CVertexId first_new) {
  const auto is_middle = [&](CVertexId v) { return v >= first_new && divided.between[v - first_new][0] != kNone; };
  std::vector<std::pair<Cell, Triangle>> pieces;  // of the cells with such points
  CancelPoll poll(control_);
  const auto has_middle = [&](const Face& face) { return std::any_of(face.corner.begin(), face.corner.begin() + 3, is_middle); };
  std::vector<Cell> cells;
  for (const Face& face : complex_.faces) {
    poll.step();
    if (!face.is_triangle() || !has_middle(face)) continue;
    cells.push_back(cell_of(complex_, face));
  }
  sort_unique(cells);
  deep_cells_.insert(deep_cells_.end(), cells.begin(), cells.end());
  sort_unique(deep_cells_);
  for (const Face& face : complex_.faces) {
    poll.step();
    if (!face.is_triangle()) continue;
    const Cell cell = cell_of(complex_, face);
    if (!std::binary_search(cells.begin(), cells.end(), cell)) continue;
    pieces.emplace_back(cell, Triangle{face.corner[0], face.corner[1], face.corner[2]});
  }
  control_.check_cancelled();
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (bool again = true; again;) {  // a point on a wall is in two cells
    again = false;
    for (std::size_t from = 0, to; from < pieces.size(); from = to) {
      to = from;
      poll.step();
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

}  // namespace isoatlas::detail
