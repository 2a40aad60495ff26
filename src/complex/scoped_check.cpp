// SPDX-License-Identifier: Apache-2.0
#include "complex/scoped_check.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/cancel_poll.h"

namespace isoatlas::detail {
namespace {

// A complete check takes as long as checking the cells with this fraction of the c-vertices one by
// one.
constexpr std::size_t kCompleteCheckFraction = 16;

}  // namespace

// One check. check_partition() explains the counting, which is the same.
class ScopedCheck::Run {
 public:
  Run(ScopedCheck& scratch, const SurfaceComplex& complex, const ComplexAdjacency& adjacency,
      std::span<const CellId> cell_of, const CellMembers& members, std::span<const CVertexId> site,
      const RunControl& control)
      : s_(scratch),
        complex_(complex),
        adjacency_(adjacency),
        cell_of_(cell_of),
        members_(members),
        site_(site),
        poll_(control) {}

  PartitionCheck run(std::span<const CellId> scope) {
    start(scope);
    for (const CellId cell : scope) {
      members_.for_each(cell, [&](CVertexId v) {
        poll_.step();
        for (const FaceId f : adjacency_.faces_of(v)) {
          if (s_.seen_.insert(f)) count_face(complex_.faces[f]);
        }
        count_boundary(v);
      });
    }
    for (const CellId cell : scope) check_cell(cell);
    std::sort(check_.faulty_cells.begin(), check_.faulty_cells.end(),
              [](const FaultyCell& a, const FaultyCell& b) { return a.cell < b.cell; });
    sort_ends();
    check_pairs(
        s_.sorted_ends_, [](CellId, CellId) { return true; }, check_);
    std::sort(
        check_.pair_faults.begin(), check_.pair_faults.end(),
        [](const PairFault& x, const PairFault& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
    return std::move(check_);
  }

 private:
  bool in_scope(CellId cell) const { return s_.in_scope_.contains(cell); }
  CellCount& count(CellId cell) { return s_.counts_[s_.slot_[cell]]; }

  void start(std::span<const CellId> scope) {
    s_.in_scope_.clear();
    s_.seen_.clear();
    s_.ends_.clear();
    s_.slot_.resize(std::max<std::size_t>(s_.slot_.size(), members_.cell_count()));
    s_.parent_.resize(std::max(s_.parent_.size(), cell_of_.size()));
    s_.counts_.assign(scope.size(), {});
    for (std::uint32_t i = 0; i < scope.size(); ++i) {
      s_.in_scope_.insert(scope[i]);
      s_.slot_[scope[i]] = i;
      s_.counts_[i].twice_euler = 2 * std::int64_t{members_.count(scope[i])};
      members_.for_each(scope[i], [&](CVertexId v) { s_.parent_[v] = v; });
    }
  }

  CVertexId find(CVertexId v) {
    while (s_.parent_[v] != v) v = s_.parent_[v] = s_.parent_[s_.parent_[v]];
    return v;
  }
  void unite(CVertexId v, CVertexId w) {
    v = find(v);
    w = find(w);
    if (v != w) s_.parent_[std::max(v, w)] = std::min(v, w);
  }

  void count_face(const Face& face) {
    const int size = face.size();
    std::array<CellId, 4> c;
    for (int k = 0; k < size; ++k) c[k] = cell_of_[face.corner[k]];
    bool is_uniform = true;
    for (int k = 0; k < size; ++k) {
      const int next = k + 1 == size ? 0 : k + 1;
      is_uniform = is_uniform && c[k] == c[next];
      if (c[k] != c[next] || !in_scope(c[k])) continue;
      count(c[k]).twice_euler -= 1;
      unite(face.corner[k], face.corner[next]);
    }
    if (is_uniform) {
      count(c[0]).twice_euler += 2;
      return;
    }
    const FaceCut cut = cut_face(complex_, face, c, site_);
    if (cut.joined != kNone && in_scope(cut.joined)) {
      count(cut.joined).twice_euler -= 2;
      unite(face.corner[cut.joined_corner], face.corner[cut.joined_corner + 2]);
    }
    for (int k = 0; k < cut.triangles; ++k) count_triangle(cut.triangle[k]);
  }

  void count_triangle(const DualTriangle& triangle) {
    const auto& c = triangle.cell;
    if (!in_scope(c[0]) && !in_scope(c[1]) && !in_scope(c[2])) return;
    check_.triangles.push_back(triangle);
    for (int k = 0; k < 3; ++k) {
      const CellId a = c[k], b = c[(k + 1) % 3];
      if (in_scope(a)) count(a).has_triangle = true;
      if (in_scope(a) || in_scope(b)) add_end(a, b, c[(k + 2) % 3]);
    }
  }

  // Counts the boundary side that starts at v, and the previous one if its other end is outside the
  // scope.
  void count_boundary(CVertexId v) {
    const CVertexId next = adjacency_.next_on_boundary(v);
    if (next == kNone) return;
    const CellId own = cell_of_[v], after = cell_of_[next],
                 before = cell_of_[adjacency_.previous_on_boundary(v)];
    CellCount& of_cell = count(own);
    of_cell.touches_boundary = true;
    if (after == own) {
      of_cell.twice_euler -= 1;
    } else {
      ++of_cell.boundary_ends;
      add_end(own, after, kNone);
    }
    if (before != own) {
      ++of_cell.boundary_ends;
      if (!in_scope(before)) add_end(own, before, kNone);
    }
  }

  void add_end(CellId a, CellId b, CellId third) {
    const ArcEnd end{std::min(a, b), std::max(a, b), third};
    s_.ends_.push_back(end);
    ++count(owner(end)).arc_ends;
  }
  CellId owner(const ArcEnd& end) const { return in_scope(end.low) ? end.low : end.high; }

  // Sorts ends by owner, then by the other cell; each owner has few.
  void sort_ends() {
    std::uint32_t total = 0;
    for (CellCount& of_cell : s_.counts_) total += std::exchange(of_cell.arc_ends, total);
    s_.sorted_ends_.resize(total);
    for (const ArcEnd& end : s_.ends_) s_.sorted_ends_[count(owner(end)).arc_ends++] = end;
    std::uint32_t from = 0;
    for (const CellCount& of_cell : s_.counts_) {
      const auto begin = s_.sorted_ends_.begin();
      std::sort(begin + from, begin + of_cell.arc_ends, [](const ArcEnd& x, const ArcEnd& y) {
        return x.low != y.low ? x.low < y.low : x.high < y.high;
      });
      from = of_cell.arc_ends;
    }
  }

  void check_cell(CellId cell) {
    if (members_.count(cell) == 0) return;
    ++check_.cells;
    const CellCount& of_cell = count(cell);
    std::uint8_t fault = 0;
    const CVertexId root = find(members_.first(cell));
    members_.for_each(cell, [&](CVertexId v) {
      if (find(v) != root) fault |= kNotConnected;
    });
    if (of_cell.twice_euler != 2) fault |= kNotADisk;
    if (!of_cell.has_triangle) fault |= kNoTriangle;
    if (of_cell.touches_boundary &&
        (of_cell.boundary_ends != 2 || (!site_.empty() && !complex_.on_boundary[site_[cell]])))
      fault |= kBadBoundary;
    if (fault != 0) check_.faulty_cells.push_back({cell, fault});
  }

  ScopedCheck& s_;
  const SurfaceComplex& complex_;
  const ComplexAdjacency& adjacency_;
  std::span<const CellId> cell_of_;
  const CellMembers& members_;
  std::span<const CVertexId> site_;
  CancelPoll poll_;
  PartitionCheck check_;
};

PartitionCheck ScopedCheck::run(const SurfaceComplex& complex, const ComplexAdjacency& adjacency,
                                std::span<const CellId> cell_of, const CellMembers& members,
                                std::span<const CVertexId> site, std::span<const CellId> scope,
                                const RunControl& control) {
  std::size_t c_vertices = 0;
  for (const CellId c : scope) c_vertices += members.count(c);
  if (kCompleteCheckFraction * c_vertices > cell_of.size()) {
    std::vector<std::uint8_t> is_in_scope(members.cell_count(), 0);
    for (const CellId c : scope) is_in_scope[c] = 1;
    return check_partition(complex, cell_of, members.cell_count(), site, is_in_scope, control);
  }
  return Run(*this, complex, adjacency, cell_of, members, site, control).run(scope);
}

std::vector<CellId> ScopedCheck::cells_near(const SurfaceComplex& complex,
                                            const ComplexAdjacency& adjacency,
                                            std::span<const CellId> cell_of,
                                            std::span<const CVertexId> changed,
                                            const RunControl& control) {
  std::vector<CellId> cells;
  in_scope_.clear();
  CancelPoll poll(control);
  for (const CVertexId v : changed) {
    poll.step();
    for (const FaceId f : adjacency.faces_of(v)) {
      const Face& face = complex.faces[f];
      for (int k = 0; k < face.size(); ++k) {
        const CellId cell = cell_of[face.corner[k]];
        if (in_scope_.insert(cell)) cells.push_back(cell);
      }
    }
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace isoatlas::detail
