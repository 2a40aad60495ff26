// SPDX-License-Identifier: Apache-2.0
// Do two triangles of a mesh meet where they should not? The only file that knows CGAL.
//
// Predicates are those of CGAL's Kernel (LGPL), which filters floating-point arithmetic and is exact where that cannot decide.
// Ours: which of them to ask about triangles that share corners, or have no area. docs/theory/06-self-intersections.md has the argument.
#include "embed/triangle_pair.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/vector_math.h"

namespace isoatlas {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Filled = Kernel::Triangle_3;

// A point, a segment of some length or a triangle of some area.
struct Simplex {
  std::size_t size = 0;
  std::array<Point, 3> corner;

  Segment segment() const { return {corner[0], corner[1]}; }
  Filled triangle() const { return {corner[0], corner[1], corner[2]}; }
};

// What three points span.
Simplex hull(const Point& p, const Point& q, const Point& r) {
  if (!CGAL::collinear(p, q, r)) return {3, {p, q, r}};
  const auto [first, last] =
      std::minmax({p, q, r}, [](const Point& i, const Point& j) { return CGAL::lexicographically_xyz_smaller(i, j); });
  if (first == last) return {1, {first}};
  return {2, {first, last}};
}

// Whether they have any point in common.
bool meet(const Simplex& a, const Simplex& b) {
  if (a.size < b.size) return meet(b, a);
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

// Whether two convex sets, both with the point `apex`, have another point in common. If so they have a segment from `apex` in common,
// and the ray along it leaves one of them first, through the part of its border that is not seen from `apex` edge-on: of a triangle with
// that corner the opposite edge, of a segment the ends. That part then meets the other set.
bool meet_beyond(const Point& apex, const Simplex& a, const Simplex& b) {
  const auto border_meets = [&apex](const Simplex& s, const Simplex& other) {
    if (s.size == 3) {
      Simplex edge;
      for (const Point& p : s.corner)
        if (p != apex) edge.corner[edge.size++] = p;
      return meet(edge, other);
    }
    for (std::size_t i = 0; i < s.size; ++i)
      if (s.corner[i] != apex && meet(other, {1, {s.corner[i]}})) return true;
    return false;
  };
  return border_meets(a, b) || border_meets(b, a);
}

// The corners of both triangles, the shared ones first.
struct Corners {
  std::size_t shared = 0;
  std::array<std::uint32_t, 3> a, b;
};

Corners sort_corners(Triangle a, Triangle b) {
  Corners out;
  const auto in = [](const auto& first, const auto& last, std::uint32_t v) { return std::find(first, last, v) != last; };
  for (const std::uint32_t v : a)
    if (in(b.begin(), b.end(), v) && !in(out.a.begin(), out.a.begin() + out.shared, v)) out.a[out.shared++] = v;
  std::copy_n(out.a.begin(), out.shared, out.b.begin());
  // What is left: each triangle without one copy of each shared corner.
  const auto append_rest = [&out](const Triangle& t, std::array<std::uint32_t, 3>& corners) {
    std::size_t filled = out.shared;
    std::array<bool, 3> used{};
    for (const std::uint32_t v : t) {
      const auto at = static_cast<std::size_t>(std::find(corners.begin(), corners.begin() + out.shared, v) - corners.begin());
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

double largest_coordinate(Vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// Whether the corners of `other` that `t` does not have are all strictly on one side of its plane, as far as doubles can tell: one normal,
// and a determinant per corner whose error is bounded. The six products of a determinant are each below u v w, the largest coordinates of
// three differences, and each has a relative error below 8 times 2^-53, so 48 * 2^-53 * u v w bounds the error; kError is twice that. Within
// kTiny and kHuge nothing that counts underflows or overflows. No is always a safe answer.
bool is_surely_on_one_side(std::span<const Vec3> positions, const Triangle& t, const Triangle& other) {
  constexpr double kError = 1.1e-14, kTiny = 1e-97, kHuge = 1e102;
  const auto is_moderate = [](double x) { return x > kTiny && x < kHuge; };
  const Vec3 apex = positions[t[0]], along = positions[t[1]] - apex, across = positions[t[2]] - apex;
  const double u = largest_coordinate(along), v = largest_coordinate(across);
  if (!is_moderate(u) || !is_moderate(v)) return false;
  const Vec3 normal = cross(along, across);
  int above = 0, below = 0;
  for (const std::uint32_t corner : other) {
    if (corner == t[0] || corner == t[1] || corner == t[2]) continue;
    const Vec3 to = positions[corner] - apex;
    const double w = largest_coordinate(to), height = dot(normal, to), error = kError * u * v * w;
    if (!is_moderate(w) || std::fabs(height) <= error) return false;
    ++(height > 0 ? above : below);
  }
  return (above == 0) != (below == 0);
}

}  // namespace

bool meet_beyond_shared(std::span<const Vec3> positions, const Triangle& first, const Triangle& second) {
  if (is_surely_on_one_side(positions, first, second) || is_surely_on_one_side(positions, second, first)) return false;
  const Corners corners = sort_corners(first, second);
  const auto point = [&positions](std::uint32_t v) { return Point(positions[v].x, positions[v].y, positions[v].z); };
  const std::array a{point(corners.a[0]), point(corners.a[1]), point(corners.a[2])};
  const std::array b{point(corners.b[0]), point(corners.b[1]), point(corners.b[2])};

  // What doubles alone could not tell. That holds whatever the triangles' areas: without one all orientations are zero.
  const auto away = [&corners](const std::array<Point, 3>& t, const std::array<Point, 3>& from) {
    const auto side = [&from](const Point& p) { return CGAL::orientation(from[0], from[1], from[2], p); };
    const CGAL::Orientation last = side(t[2]);
    if (last == CGAL::COPLANAR) return false;
    return corners.shared == 2 || (side(t[1]) == last && (corners.shared == 1 || side(t[0]) == last));
  };
  if (corners.shared == 3) return true;
  if (away(a, b) || away(b, a)) return false;

  if (corners.shared == 0) return meet(hull(a[0], a[1], a[2]), hull(b[0], b[1], b[2]));
  if (corners.shared == 1 || a[0] == a[1]) return meet_beyond(a[0], hull(a[0], a[1], a[2]), hull(b[0], b[1], b[2]));

  // An edge of some length, and all in one plane.
  const Point &from = a[0], &to = a[1], &p = a[2], &q = b[2];
  const bool p_on_line = CGAL::collinear(from, to, p), q_on_line = CGAL::collinear(from, to, q);
  if (!p_on_line && !q_on_line) return CGAL::coplanar_orientation(from, to, p, q) == CGAL::POSITIVE;
  if (p_on_line != q_on_line) return false;  // the one with an area has no more of the edge's line than the edge
  // Two segments along that line: do both reach beyond the same end of the edge?
  const auto beyond = [](const Point& i, const Point& j, const Point& x) {
    return CGAL::collinear_are_strictly_ordered_along_line(i, j, x);
  };
  return (beyond(from, to, p) && beyond(from, to, q)) || (beyond(to, from, p) && beyond(to, from, q));
}

}  // namespace isoatlas
