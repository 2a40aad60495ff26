// SPDX-License-Identifier: Apache-2.0
// Based on:
//   [berg2008]    chapter 3: a sweep adds diagonals at split and merge points, which leaves
//   monotone
//                 polygons; these are triangulated with a stack.
//   [lawson1977]  Edges are flipped until the triangulation is Delaunay.
// Ours: the sweep also notices sides that do not bound a region. Orientations are exact (CGAL).
#include "geometry/triangulate_region.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/ids.h"

namespace isoatlas::detail {
namespace {

using ExactPoint = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

// Edges whose opposite angles add up to less than this more than 180 degrees (in radians) are not
// flipped: with rounding, four points on a circle could be flipped for ever.
constexpr double kMinExcess = 1e-9;

int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return static_cast<int>(
      CGAL::orientation(ExactPoint(a.u, a.v), ExactPoint(b.u, b.v), ExactPoint(c.u, c.v)));
}

bool is_before(const PlanePoint& a, const PlanePoint& b) {
  return a.u != b.u ? a.u < b.u : a.v < b.v;
}

// The polygons of a region: per point its neighbours along the sides; kNone for unused points.
struct Polygons {
  std::span<const PlanePoint> points;
  std::vector<std::uint32_t> next, previous;

  int turn_at(std::uint32_t p) const {
    return orientation(points[previous[p]], points[p], points[next[p]]);
  }
};

std::optional<Polygons> connect(std::span<const PlanePoint> points,
                                std::span<const RegionSide> sides) {
  Polygons out{points, std::vector<std::uint32_t>(points.size(), kNone), {}};
  out.previous = out.next;
  for (const auto& [from, to] : sides) {
    if (std::exchange(out.next[from], to) != kNone) return std::nullopt;
    if (std::exchange(out.previous[to], from) != kNone) return std::nullopt;
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    if ((out.next[p] == kNone) != (out.previous[p] == kNone)) return std::nullopt;
  }
  return out;
}

// Splits a region into monotone polygons by diagonals. The sweep runs along u, and along v among
// points with the same u.
class MonotoneSplit {
 public:
  explicit MonotoneSplit(const Polygons& polygons)
      : polygons_(polygons), points_(polygons.points), status_(IsBelow{this}) {}

  // The diagonals, or nothing if the sides do not bound a region.
  std::optional<std::vector<RegionSide>> run() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      if (polygons_.next[p] != kNone) order.push_back(p);
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return is_before(points_[a], points_[b]); });
    for (const std::uint32_t p : order) {
      if (!visit(p)) return std::nullopt;
    }
    return std::move(diagonals_);
  }

 private:
  // A side is named by the point from which it starts. It is a lower side, with the region above
  // it, if it runs along the sweep; otherwise an upper side. The status has the sides that cross
  // the sweep line, from below to above. The helper of a lower side is the last point between it
  // and the upper side above it.
  struct Helper {
    std::uint32_t point = kNone;
    bool is_merge = false;
  };
  struct AtPoint {
    std::uint32_t point;
  };
  struct IsBelow {
    using is_transparent = void;
    const MonotoneSplit* sweep;
    bool operator()(std::uint32_t a, std::uint32_t b) const { return sweep->is_below(a, b); }
    bool operator()(std::uint32_t side, AtPoint p) const { return sweep->place(side, p.point) > 0; }
    bool operator()(AtPoint p, std::uint32_t side) const { return sweep->place(side, p.point) < 0; }
  };
  using Status = std::map<std::uint32_t, Helper, IsBelow>;

  bool is_lower(std::uint32_t side) const {
    return is_before(points_[side], points_[polygons_.next[side]]);
  }
  // First the end that the sweep reaches first.
  std::pair<PlanePoint, PlanePoint> ends(std::uint32_t side) const {
    const PlanePoint a = points_[side], b = points_[polygons_.next[side]];
    return is_lower(side) ? std::pair(a, b) : std::pair(b, a);
  }
  // 1 if the point is above the side, -1 if it is below it.
  int place(std::uint32_t side, std::uint32_t point) const {
    const auto [low, high] = ends(side);
    return orientation(low, high, points_[point]);
  }
  bool is_below(std::uint32_t a, std::uint32_t b) const {
    const auto [a_low, a_high] = ends(a);
    const auto [b_low, b_high] = ends(b);
    if (is_before(b_low, a_low)) {
      const int at_start = orientation(b_low, b_high, a_low);
      return (at_start != 0 ? at_start : orientation(b_low, b_high, a_high)) < 0;
    }
    const int at_start = orientation(a_low, a_high, b_low);
    return (at_start != 0 ? at_start : orientation(a_low, a_high, b_high)) > 0;
  }

  // The side directly below a point that is an end of no side in the status; end() if there is
  // none.
  Status::iterator side_below(std::uint32_t p) {
    const auto above = status_.lower_bound(AtPoint{p});
    return above == status_.begin() ? status_.end() : std::prev(above);
  }
  // The lower side directly below, which bounds the part of the region that contains the point;
  // end() if the point is not in the region.
  Status::iterator region_below(std::uint32_t p) {
    const auto below = side_below(p);
    return below != status_.end() && is_lower(below->first) ? below : status_.end();
  }

  void connect_to(std::uint32_t p, const Helper& helper) {
    diagonals_.push_back({p, helper.point});
  }
  bool insert(std::uint32_t side, std::uint32_t helper) {
    return status_.insert({side, {helper, false}}).second;
  }
  // Removes a side that ends at p, where the sweep is. @return false if it is not in the status
  bool remove(std::uint32_t side, std::uint32_t p) {
    const auto at = status_.find(side);
    if (at == status_.end() || at->first != side) return false;
    if (is_lower(side) && at->second.is_merge) connect_to(p, at->second);
    status_.erase(at);
    return true;
  }

  bool visit(std::uint32_t p) {
    const std::uint32_t to = polygons_.next[p], from = polygons_.previous[p];
    const bool next_is_later = is_before(points_[p], points_[to]),
               previous_is_later = is_before(points_[p], points_[from]);
    if (next_is_later && previous_is_later) return start_or_split(p, from);
    if (!next_is_later && !previous_is_later) return end_or_merge(p, from);
    if (next_is_later) return remove(from, p) && insert(p, p);
    // An upper side continues.
    if (!remove(p, p)) return false;
    const auto region = region_below(p);
    if (region == status_.end()) return false;
    if (region->second.is_merge) connect_to(p, region->second);
    region->second = {p, false};
    return insert(from, kNone);
  }
  bool start_or_split(std::uint32_t p, std::uint32_t from) {
    const int turn = polygons_.turn_at(p);
    const auto region = region_below(p);
    if (turn == 0 || (turn < 0) != (region != status_.end())) return false;
    if (turn < 0) {
      connect_to(p, region->second);
      region->second = {p, false};
    }
    return insert(p, p) && insert(from, kNone);
  }
  bool end_or_merge(std::uint32_t p, std::uint32_t from) {
    const int turn = polygons_.turn_at(p);
    if (turn == 0 || !remove(from, p) || !remove(p, p)) return false;
    const auto region = region_below(p);
    if ((turn < 0) != (region != status_.end())) return false;
    if (turn > 0) return true;
    if (region->second.is_merge) connect_to(p, region->second);
    region->second = {p, true};
    return true;
  }

  const Polygons& polygons_;
  std::span<const PlanePoint> points_;
  Status status_;
  std::vector<RegionSide> diagonals_;
};

// The faces on the left of all sides and on both sides of all diagonals.
class Faces {
 public:
  Faces(std::span<const PlanePoint> points, std::span<const RegionSide> sides,
        std::span<const RegionSide> diagonals)
      : points_(points) {
    for (const RegionSide& side : sides) edges_.push_back({side, false});
    for (const auto& [a, b] : diagonals) {
      edges_.push_back({{a, b}, false});
      edges_.push_back({{b, a}, false});
    }
    std::sort(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) {
      return a.ends[0] != b.ends[0] ? a.ends[0] < b.ends[0] : turns_before(a, b);
    });
    first_.assign(points.size() + 1, 0);
    for (const Edge& edge : edges_) ++first_[edge.ends[0] + 1];
    for (std::size_t p = 0; p < points.size(); ++p) first_[p + 1] += first_[p];
  }

  // Calls use(corners) for each, counter-clockwise. @return false if use() does
  template <class Use>
  bool for_each(const Use& use) {
    std::vector<std::uint32_t> corners;
    for (Edge& first : edges_) {
      if (first.is_visited) continue;
      corners.clear();
      for (Edge* edge = &first; !edge->is_visited; edge = &next_on_face(*edge)) {
        edge->is_visited = true;
        corners.push_back(edge->ends[0]);
      }
      if (!use(corners)) return false;
    }
    return true;
  }

 private:
  struct Edge {
    RegionSide ends;
    bool is_visited;
  };
  // Whether the direction of a is before that of b, counter-clockwise from the direction of -u.
  bool turns_before(const Edge& a, const Edge& b) const {
    return direction_before(a.ends[0], a.ends[1], b.ends[1]);
  }
  bool direction_before(std::uint32_t at, std::uint32_t a, std::uint32_t b) const {
    const bool a_is_later = is_before(points_[at], points_[a]),
               b_is_later = is_before(points_[at], points_[b]);
    if (a_is_later != b_is_later) return b_is_later;
    return orientation(points_[at], points_[a], points_[b]) > 0;
  }
  // At the end of an edge, the first edge clockwise from the way back.
  Edge& next_on_face(const Edge& edge) {
    const std::uint32_t back = edge.ends[0], at = edge.ends[1];
    const auto begin = edges_.begin() + first_[at], end = edges_.begin() + first_[at + 1];
    const auto found = std::partition_point(
        begin, end, [&](const Edge& e) { return direction_before(at, e.ends[1], back); });
    return found == begin ? *std::prev(end) : *std::prev(found);
  }

  std::span<const PlanePoint> points_;
  std::vector<Edge> edges_;  // by start, and counter-clockwise among those with the same
  std::vector<std::uint32_t> first_;
};

// Triangulates a monotone polygon. @return false if it is not one
bool triangulate_monotone(std::span<const PlanePoint> points,
                          std::span<const std::uint32_t> corners, std::vector<Triangle>& out) {
  const std::size_t n = corners.size();
  if (n < 3) return false;
  struct Corner {
    std::uint32_t point;
    bool is_lower;
  };
  const auto is_earlier = [&](std::uint32_t a, std::uint32_t b) {
    return is_before(points[a], points[b]);
  };
  const auto first = static_cast<std::size_t>(
      std::min_element(corners.begin(), corners.end(), is_earlier) - corners.begin());
  const auto last = static_cast<std::size_t>(
      std::max_element(corners.begin(), corners.end(), is_earlier) - corners.begin());
  std::vector<Corner> lower, upper, order;
  for (std::size_t k = first; k != last; k = (k + 1) % n) lower.push_back({corners[k], true});
  for (std::size_t k = first; k != last;) {
    k = (k + n - 1) % n;
    upper.push_back({corners[k], false});
  }
  std::merge(lower.begin(), lower.end(), upper.begin(), upper.end(), std::back_inserter(order),
             [&](const Corner& a, const Corner& b) { return is_earlier(a.point, b.point); });
  for (std::size_t k = 1; k < n; ++k) {
    if (!is_earlier(order[k - 1].point, order[k].point)) return false;
  }

  bool is_valid = true;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, bool is_lower) {
    if (!is_lower) std::swap(a, c);
    is_valid &= orientation(points[a], points[b], points[c]) > 0;
    out.push_back({a, b, c});
  };
  std::vector<Corner> stack{order[0], order[1]};
  for (std::size_t k = 2; k < n; ++k) {
    const Corner now = order[k];
    if (k + 1 == n || now.is_lower != stack.back().is_lower) {
      const Corner top = stack.back();
      for (std::size_t i = 1; i < stack.size(); ++i)
        add(stack[i - 1].point, stack[i].point, now.point, top.is_lower);
      stack = {top, now};
      continue;
    }
    while (stack.size() >= 2) {
      const std::uint32_t a = stack[stack.size() - 2].point, b = stack.back().point;
      const int turn = orientation(points[a], points[b], points[now.point]);
      if (now.is_lower ? turn <= 0 : turn >= 0) break;
      add(a, b, now.point, now.is_lower);
      stack.pop_back();
    }
    stack.push_back(now);
  }
  return is_valid;
}

// Flips edges that are not sides until the triangulation is Delaunay.
class DelaunayFlips {
 public:
  DelaunayFlips(std::span<const PlanePoint> points, PlanePoint spacing,
                std::vector<Triangle>& triangles)
      : points_(points), spacing_(spacing), triangles_(triangles) {}

  // @return false if the triangles are not a triangulation with these sides
  bool run(std::span<const RegionSide> sides) {
    if (!find_neighbours(sides)) return false;
    std::vector<std::uint32_t> pending(3 * triangles_.size());
    for (std::uint32_t e = 0; e < pending.size(); ++e) pending[e] = e;
    while (!pending.empty()) {
      const std::uint32_t e = pending.back();
      pending.pop_back();
      if (!should_flip(e)) continue;
      const std::uint32_t t = e / 3, other = neighbour_[e] / 3;
      flip(e);
      for (std::uint32_t k = 0; k < 3; ++k) {
        pending.push_back(3 * t + k);
        pending.push_back(3 * other + k);
      }
    }
    return true;
  }

 private:
  // Edge 3 t + k runs from corner k of triangle t to the next one.
  static std::uint32_t after(std::uint32_t e) { return e % 3 == 2 ? e - 2 : e + 1; }
  std::uint32_t from(std::uint32_t e) const { return triangles_[e / 3][e % 3]; }

  bool find_neighbours(std::span<const RegionSide> sides) {
    struct Half {
      std::uint32_t from, to, edge;
    };
    std::vector<Half> halves;
    for (std::uint32_t e = 0; e < 3 * triangles_.size(); ++e)
      halves.push_back({from(e), from(after(e)), e});
    const auto before = [](const Half& a, const Half& b) {
      return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    };
    std::sort(halves.begin(), halves.end(), before);
    neighbour_.assign(halves.size(), kNone);
    std::size_t unpaired = 0;
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (i > 0 && !before(halves[i - 1], halves[i])) return false;
      const Half wanted{halves[i].to, halves[i].from, 0};
      const auto found = std::lower_bound(halves.begin(), halves.end(), wanted, before);
      if (found != halves.end() && !before(wanted, *found))
        neighbour_[halves[i].edge] = found->edge;
      else
        ++unpaired;
    }
    for (const auto& [a, b] : sides) {
      const auto found = std::lower_bound(halves.begin(), halves.end(), Half{a, b, 0}, before);
      if (found == halves.end() || found->from != a || found->to != b ||
          neighbour_[found->edge] != kNone)
        return false;
    }
    return unpaired == sides.size();
  }

  // The angle at p between the directions to a and b.
  double angle(std::uint32_t p, std::uint32_t a, std::uint32_t b) const {
    const auto vector = [&](std::uint32_t q) {
      return PlanePoint{spacing_.u * (points_[q].u - points_[p].u),
                        spacing_.v * (points_[q].v - points_[p].v)};
    };
    const PlanePoint x = vector(a), y = vector(b);
    return std::atan2(std::abs(x.u * y.v - x.v * y.u), x.u * y.u + x.v * y.v);
  }
  bool should_flip(std::uint32_t e) const {
    const std::uint32_t f = neighbour_[e];
    if (f == kNone) return false;
    const std::uint32_t a = from(e), b = from(f), c = from(after(after(e))),
                        d = from(after(after(f)));
    if (angle(c, a, b) + angle(d, a, b) <= 3.14159265358979323846 + kMinExcess) return false;
    return orientation(points_[c], points_[a], points_[d]) > 0 &&
           orientation(points_[d], points_[b], points_[c]) > 0;
  }
  // Replaces the triangles a b c and b a d by a d c and d b c.
  void flip(std::uint32_t e) {
    const std::uint32_t f = neighbour_[e], t = e / 3, u = f / 3;
    const std::uint32_t bc = after(e), ca = after(bc), ad = after(f), db = after(ad);
    const std::uint32_t a = from(e), b = from(f), c = from(ca), d = from(db);
    const std::uint32_t beyond_bc = neighbour_[bc], beyond_ca = neighbour_[ca],
                        beyond_ad = neighbour_[ad], beyond_db = neighbour_[db];
    triangles_[t] = {a, d, c};
    triangles_[u] = {d, b, c};
    const auto join = [&](std::uint32_t edge, std::uint32_t beyond) {
      neighbour_[edge] = beyond;
      if (beyond != kNone) neighbour_[beyond] = edge;
    };
    join(3 * t, beyond_ad);
    join(3 * t + 1, 3 * u + 2);
    join(3 * t + 2, beyond_ca);
    join(3 * u, beyond_db);
    join(3 * u + 1, beyond_bc);
  }

  std::span<const PlanePoint> points_;
  PlanePoint spacing_;
  std::vector<Triangle>& triangles_;
  std::vector<std::uint32_t> neighbour_;  // per edge, the same edge of the other triangle
};

}  // namespace

std::optional<std::vector<Triangle>> triangulate_region(std::span<const PlanePoint> points,
                                                        std::span<const RegionSide> sides,
                                                        PlanePoint spacing) {
  const std::optional<Polygons> polygons = connect(points, sides);
  if (!polygons) return std::nullopt;
  const std::optional<std::vector<RegionSide>> diagonals = MonotoneSplit(*polygons).run();
  if (!diagonals) return std::nullopt;
  std::vector<Triangle> out;
  Faces faces(points, sides, *diagonals);
  if (!faces.for_each([&](std::span<const std::uint32_t> corners) {
        return triangulate_monotone(points, corners, out);
      }))
    return std::nullopt;
  if (!DelaunayFlips(points, spacing, out).run(sides)) return std::nullopt;
  return out;
}

}  // namespace isoatlas::detail
