// SPDX-License-Identifier: Apache-2.0
// Decides whether two triangles of a mesh intersect beyond what they share.
//
// Predicates are those of CGAL's Kernel (LGPL), which filters floating-point arithmetic and is
// exact where that cannot decide. Ours: which of them are evaluated for triangles that share
// corners or have no area, and the floating-point filter before them.
// docs/theory/06-self-intersections.md explains why this is correct.
#include "geometry/triangle_pair.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/vector_math.h"
#include "geometry/filtered_plane.h"

namespace isoatlas::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using ExactTriangle = Kernel::Triangle_3;

// A point, a segment of positive length or a triangle of positive area.
struct Simplex {
  std::size_t size = 0;
  std::array<Point, 3> corner;

  Segment segment() const { return {corner[0], corner[1]}; }
  ExactTriangle triangle() const { return {corner[0], corner[1], corner[2]}; }
};

// The simplex spanned by three points.
Simplex hull(const Point& p, const Point& q, const Point& r) {
  if (!CGAL::collinear(p, q, r)) return {3, {p, q, r}};
  const auto [first, last] = std::minmax({p, q, r}, [](const Point& i, const Point& j) {
    return CGAL::lexicographically_xyz_smaller(i, j);
  });
  if (first == last) return {1, {first}};
  return {2, {first, last}};
}

// Whether two simplices intersect.
bool intersect(const Simplex& a, const Simplex& b) {
  if (a.size < b.size) return intersect(b, a);
  switch (3 * a.size + b.size) {
    case 3 * 3 + 3:
      return CGAL::do_intersect(a.triangle(), b.triangle());
    case 3 * 3 + 2:
      return CGAL::do_intersect(a.triangle(), b.segment());
    case 3 * 3 + 1:
      return CGAL::do_intersect(a.triangle(), b.corner[0]);
    case 3 * 2 + 2:
      return CGAL::do_intersect(a.segment(), b.segment());
    case 3 * 2 + 1:
      return CGAL::do_intersect(a.segment(), b.corner[0]);
    default:
      return a.corner[0] == b.corner[0];
  }
}

// Whether two convex sets that both contain the point `apex` have another point in common. If so,
// they have a segment from `apex` in common, and the ray along it leaves one of them first, through
// the part of its boundary that is not seen edge-on from `apex`: for a triangle with this corner
// the opposite edge, for a segment the ends. This part then intersects the other set.
bool intersect_beyond(const Point& apex, const Simplex& a, const Simplex& b) {
  const auto boundary_intersects = [&apex](const Simplex& s, const Simplex& other) {
    if (s.size == 3) {
      Simplex edge;
      for (const Point& p : s.corner)
        if (p != apex) edge.corner[edge.size++] = p;
      return intersect(edge, other);
    }
    for (std::size_t i = 0; i < s.size; ++i)
      if (s.corner[i] != apex && intersect(other, {1, {s.corner[i]}})) return true;
    return false;
  };
  return boundary_intersects(a, b) || boundary_intersects(b, a);
}

// The corners of both triangles, the shared ones first.
struct Corners {
  std::size_t shared = 0;
  std::array<std::uint32_t, 3> a, b;
};

Corners sort_corners(Triangle a, Triangle b) {
  Corners out;
  const auto in = [](const auto& first, const auto& last, std::uint32_t v) {
    return std::find(first, last, v) != last;
  };
  for (const std::uint32_t v : a)
    if (in(b.begin(), b.end(), v) && !in(out.a.begin(), out.a.begin() + out.shared, v))
      out.a[out.shared++] = v;
  std::copy_n(out.a.begin(), out.shared, out.b.begin());
  // Appends the corners that are not shared: each triangle without one copy of each shared corner.
  const auto append_rest = [&out](const Triangle& t, std::array<std::uint32_t, 3>& corners) {
    std::size_t filled = out.shared;
    std::array<bool, 3> used{};
    for (const std::uint32_t v : t) {
      const auto at = static_cast<std::size_t>(
          std::find(corners.begin(), corners.begin() + out.shared, v) - corners.begin());
      if (at < out.shared && !used[at])
        used[at] = true;
      else
        corners[filled++] = v;
    }
  };
  append_rest(a, out.a);
  append_rest(b, out.b);
  return out;
}

// Whether two triangles that share an edge certainly form more than a right angle there: then they
// only have the edge's line in common. The twelve products are each below u u v w, with a relative
// error below 16 times 2^-53.
bool is_certainly_obtuse(Vec3 from, Vec3 to, Vec3 p, Vec3 q, double slack = 0) {
  constexpr double kError = 5e-14;
  const Vec3 edge = to - from, to_p = p - from, to_q = q - from;
  const double u = largest_coordinate(edge), v = largest_coordinate(to_p),
               w = largest_coordinate(to_q);
  if (!is_moderate(u) || !is_moderate(v) || !is_moderate(w)) return false;
  const double e = 2 * slack, size = u * u * v * w, moved = (u + e) * (u + e) * (v + e) * (w + e);
  return dot(cross(edge, to_p), cross(edge, to_q)) < -kError * size - 12 * (moved - size);
}

// The corners of one triangle relative to another: which of them are shared, and on which side of
// the other's plane the rest lies.
struct PlaneSides {
  std::array<bool, 3> is_shared{};
  std::array<int, 3> side{};  // of corners that are not shared; 0: unknown
  int shared = 0, above = 0, below = 0;

  template <class SideOf>
  PlaneSides(const Triangle& t, const Triangle& other, SideOf side_of) {
    for (std::size_t k = 0; k < 3; ++k) {
      is_shared[k] = t[k] == other[0] || t[k] == other[1] || t[k] == other[2];
      if (is_shared[k]) {
        ++shared;
        continue;
      }
      side[k] = side_of(t[k]);
      above += side[k] > 0;
      below += side[k] < 0;
    }
  }
  bool is_known() const { return shared + above + below == 3; }
  bool is_on_one_side() const { return is_known() && (above == 0) != (below == 0); }
  bool is_on_both_sides() const { return is_known() && above > 0 && below > 0; }
  std::size_t first_shared() const { return is_shared[0] ? 0 : is_shared[1] ? 1 : 2; }
  std::size_t single_corner() const {  // the only corner on its side
    const int wanted = above == 1 ? 1 : -1;
    return side[0] == wanted ? 0 : side[1] == wanted ? 1 : 2;
  }
};

// The edge that two triangles share, and their two other corners.
struct Hinge {
  Hinge(const Triangle& a, const PlaneSides& sides_a, const Triangle& b,
        const PlaneSides& sides_b) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      (sides_a.is_shared[k] ? edge[n++] : rest_a) = a[k];
      if (!sides_b.is_shared[k]) rest_b = b[k];
    }
  }
  std::array<std::uint32_t, 2> edge{};
  std::uint32_t rest_a = 0, rest_b = 0;
};

// For two triangles without a shared corner, each with corners on both sides of the other's plane:
// the planes intersect in a line, each triangle intersects it in an interval, and two signs
// determine whether these overlap ([guigue2003]). None: doubles do not suffice.
std::optional<bool> intervals_overlap(std::span<const Vec3> positions, const Triangle& a,
                                      const PlaneSides& sides_a, const Triangle& b,
                                      const PlaneSides& sides_b) {
  const std::size_t i = sides_a.single_corner(), j = sides_b.single_corner();
  std::array p{positions[a[i]], positions[a[(i + 1) % 3]], positions[a[(i + 2) % 3]]};
  std::array q{positions[b[j]], positions[b[(j + 1) % 3]], positions[b[(j + 2) % 3]]};
  if (sides_a.side[i] < 0) std::swap(q[1], q[2]);
  if (sides_b.side[j] < 0) std::swap(p[1], p[2]);
  const int first = FilteredPlane(p[1], q[0], p[0]).side(q[1]),
            second = FilteredPlane(p[0], q[0], p[2]).side(q[2]);
  if (first > 0 || second > 0) return false;
  if (first < 0 && second < 0) return true;
  return std::nullopt;
}

// Whether two triangles intersect beyond what they share; none: doubles do not suffice.
// @param side_of_a, side_of_b  the side of a corner of the other triangle
template <class SideOfA, class SideOfB>
std::optional<bool> intersect_filtered(std::span<const Vec3> positions, const Triangle& a,
                                       const Triangle& b, SideOfA side_of_a, SideOfB side_of_b) {
  const PlaneSides sides_b(b, a, side_of_a);
  if (sides_b.is_on_one_side()) return false;
  const PlaneSides sides_a(a, b, side_of_b);
  if (sides_a.is_on_one_side()) return false;
  if (sides_a.shared == 2 && sides_b.shared == 2) {
    const Hinge hinge(a, sides_a, b, sides_b);
    if (is_certainly_obtuse(positions[hinge.edge[0]], positions[hinge.edge[1]],
                            positions[hinge.rest_a], positions[hinge.rest_b]))
      return false;
    return std::nullopt;
  }
  if (!sides_a.is_on_both_sides() || !sides_b.is_on_both_sides()) return std::nullopt;
  if (sides_a.shared == 0) return intervals_overlap(positions, a, sides_a, b, sides_b);
  // Seen from the shared corner, two arcs that each cross the other's great circle either cross, or
  // one crosses the antipode of the other.
  return sides_b.side[(sides_b.first_shared() + 1) % 3] !=
         sides_a.side[(sides_a.first_shared() + 1) % 3];
}

// Decides the pairs that doubles cannot decide.
bool intersect_exactly(std::span<const Vec3> positions, const Triangle& first,
                       const Triangle& second) {
  const Corners corners = sort_corners(first, second);
  const auto point = [&positions](std::uint32_t v) {
    return Point(positions[v].x, positions[v].y, positions[v].z);
  };
  const std::array a{point(corners.a[0]), point(corners.a[1]), point(corners.a[2])};
  const std::array b{point(corners.b[0]), point(corners.b[1]), point(corners.b[2])};

  // Exact version of the tests above. It also holds for triangles without area, for which all
  // orientations are zero.
  const auto is_on_one_side = [&corners](const std::array<Point, 3>& t,
                                         const std::array<Point, 3>& from) {
    const auto side = [&from](const Point& p) {
      return CGAL::orientation(from[0], from[1], from[2], p);
    };
    const CGAL::Orientation last = side(t[2]);
    if (last == CGAL::COPLANAR) return false;
    return corners.shared == 2 ||
           (side(t[1]) == last && (corners.shared == 1 || side(t[0]) == last));
  };
  if (corners.shared == 3) return true;
  if (is_on_one_side(a, b) || is_on_one_side(b, a)) return false;

  if (corners.shared == 0) return intersect(hull(a[0], a[1], a[2]), hull(b[0], b[1], b[2]));
  if (corners.shared == 1 || a[0] == a[1])
    return intersect_beyond(a[0], hull(a[0], a[1], a[2]), hull(b[0], b[1], b[2]));

  // A shared edge of positive length, and all corners in one plane.
  const Point &from = a[0], &to = a[1], &p = a[2], &q = b[2];
  const bool p_on_line = CGAL::collinear(from, to, p), q_on_line = CGAL::collinear(from, to, q);
  if (!p_on_line && !q_on_line) return CGAL::coplanar_orientation(from, to, p, q) == CGAL::POSITIVE;
  if (p_on_line != q_on_line)
    return false;  // the triangle with an area contains no more of the edge's line than the edge
  // Two segments along that line: they overlap if both extend beyond the same end of the edge.
  const auto beyond = [](const Point& i, const Point& j, const Point& x) {
    return CGAL::collinear_are_strictly_ordered_along_line(i, j, x);
  };
  return (beyond(from, to, p) && beyond(from, to, q)) ||
         (beyond(to, from, p) && beyond(to, from, q));
}

}  // namespace

bool intersect_beyond_shared_simplex(std::span<const Vec3> positions, const Triangle& a,
                                     const Triangle& b) {
  const FilteredPlane plane_a(positions, a), plane_b(positions, b);
  const std::optional<bool> filtered = intersect_filtered(
      positions, a, b, [&](std::uint32_t corner) { return plane_a.side(positions[corner]); },
      [&](std::uint32_t corner) { return plane_b.side(positions[corner]); });
  return filtered ? *filtered : intersect_exactly(positions, a, b);
}

bool are_certainly_disjoint(std::span<const Vec3> positions, const Triangle& a, const Triangle& b,
                            double slack) {
  const FilteredPlane plane_a(positions, a, slack);
  const PlaneSides sides_b(b, a,
                           [&](std::uint32_t corner) { return plane_a.side(positions[corner]); });
  if (sides_b.is_on_one_side()) return true;
  const FilteredPlane plane_b(positions, b, slack);
  const PlaneSides sides_a(a, b,
                           [&](std::uint32_t corner) { return plane_b.side(positions[corner]); });
  if (sides_a.is_on_one_side()) return true;
  if (sides_a.shared != 2 || sides_b.shared != 2) return false;
  const Hinge hinge(a, sides_a, b, sides_b);
  return is_certainly_obtuse(positions[hinge.edge[0]], positions[hinge.edge[1]],
                             positions[hinge.rest_a], positions[hinge.rest_b], slack);
}

bool has_area(std::span<const Vec3> positions, const Triangle& t) {
  const Vec3 along = positions[t[1]] - positions[t[0]], across = positions[t[2]] - positions[t[0]];
  const double u = largest_coordinate(along), v = largest_coordinate(across);
  // A coordinate of the normal is a difference of two products, each with a relative error below 4
  // times 2^-53.
  constexpr double kError = 1e-15;
  if (is_moderate(u) && is_moderate(v) && largest_coordinate(cross(along, across)) > kError * u * v)
    return true;
  const auto point = [&positions](std::uint32_t corner) {
    return Point(positions[corner].x, positions[corner].y, positions[corner].z);
  };
  return !CGAL::collinear(point(t[0]), point(t[1]), point(t[2]));
}

std::size_t count_intersecting_pairs(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles, std::size_t max_count) {
  std::vector<std::int8_t> sides;  // per position, for one triangle after the other
  sides.reserve(triangles.size() * positions.size());
  for (const Triangle& t : triangles) {
    const FilteredPlane plane(positions, t);
    for (const Vec3& p : positions) sides.push_back(static_cast<std::int8_t>(plane.side(p)));
  }
  std::size_t out = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < triangles.size(); ++j) {
      const auto side_of = [&](std::size_t t) {
        return [&, t](std::uint32_t corner) -> int { return sides[t * positions.size() + corner]; };
      };
      const std::optional<bool> filtered =
          intersect_filtered(positions, triangles[i], triangles[j], side_of(i), side_of(j));
      if ((filtered ? *filtered : intersect_exactly(positions, triangles[i], triangles[j])) &&
          ++out >= max_count)
        return out;
    }
  }
  return out;
}

}  // namespace isoatlas::detail
