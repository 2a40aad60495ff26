// SPDX-License-Identifier: Apache-2.0
#include "exact_triangles.h"

#include <algorithm>

namespace isoatlas::detail::test {
namespace {

using Integer = std::int64_t;
using Vector = std::array<Integer, 3>;

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector times(Integer s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
Integer dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool is_zero(const Vector& a) { return a == Vector{0, 0, 0}; }

// numerator / denominator, denominator > 0
struct Fraction {
  Vector numerator;
  Integer denominator = 1;
};

Vector from(const Vector& p, const Fraction& x) {
  return minus(x.numerator, times(x.denominator, p));
}

// from + (to - from) t / u
Fraction between(const Vector& from, const Vector& to, Integer t, Integer u) {
  if (u < 0) t = -t, u = -u;
  const Vector step = times(t, minus(to, from)), start = times(u, from);
  return {{start[0] + step[0], start[1] + step[1], start[2] + step[2]}, u};
}

bool on_segment(const Fraction& x, const Vector& p, const Vector& q) {
  const Vector d = minus(q, p), r = from(p, x);
  return is_zero(cross(d, r)) &&
         (is_zero(d) ? is_zero(r) : dot(r, d) >= 0 && dot(r, d) <= x.denominator * dot(d, d));
}

using Corners = std::array<Vector, 3>;

Vector normal(const Corners& t) { return cross(minus(t[1], t[0]), minus(t[2], t[0])); }

bool in_triangle(const Fraction& x, const Corners& t) {
  const Vector n = normal(t);
  if (is_zero(n))
    return on_segment(x, t[0], t[1]) || on_segment(x, t[1], t[2]) || on_segment(x, t[2], t[0]);
  if (dot(n, from(t[0], x)) != 0) return false;
  for (int i = 0; i < 3; ++i)
    if (dot(n, cross(minus(t[(i + 1) % 3], t[i]), from(t[i], x))) < 0) return false;
  return true;
}

// Every point that can be a corner of the intersection, and more.
std::vector<Fraction> candidates(const Corners& a, const Corners& b) {
  std::vector<Fraction> out;
  for (const Vector& p : a) out.push_back({p});
  for (const Vector& p : b) out.push_back({p});
  const auto through_plane = [&out](const Corners& edges, const Corners& plane) {
    const Vector n = normal(plane);
    for (int i = 0; i < 3; ++i) {
      const Vector &p = edges[i], &q = edges[(i + 1) % 3];
      if (dot(n, minus(q, p)) != 0)
        out.push_back(between(p, q, dot(n, minus(plane[0], p)), dot(n, minus(q, p))));
    }
  };
  through_plane(a, b);
  through_plane(b, a);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector &p = a[i], d = minus(a[(i + 1) % 3], p), e = minus(b[(j + 1) % 3], b[j]),
                   n = cross(d, e);
      if (!is_zero(n))
        out.push_back(between(p, a[(i + 1) % 3], dot(cross(minus(b[j], p), e), n), dot(n, n)));
    }
  }
  return out;
}

}  // namespace

std::vector<Vec3> to_positions(const std::vector<LatticePoint>& points, double scale, Vec3 offset) {
  std::vector<Vec3> out;
  for (const auto& [x, y, z] : points)
    out.push_back({scale * static_cast<double>(x) + offset.x,
                   scale * static_cast<double>(y) + offset.y,
                   scale * static_cast<double>(z) + offset.z});
  return out;
}

bool slow_intersect_beyond_shared_simplex(const std::vector<LatticePoint>& points,
                                          const Triangle& a, const Triangle& b) {
  std::vector<std::uint32_t> shared;
  for (const std::uint32_t v : a)
    if (std::find(b.begin(), b.end(), v) != b.end() &&
        std::find(shared.begin(), shared.end(), v) == shared.end())
      shared.push_back(v);
  if (shared.size() == 3) return true;
  const Corners ca{points[a[0]], points[a[1]], points[a[2]]},
      cb{points[b[0]], points[b[1]], points[b[2]]};
  for (const Fraction& x : candidates(ca, cb)) {
    if (!in_triangle(x, ca) || !in_triangle(x, cb)) continue;
    if (shared.empty() || !on_segment(x, points[shared.front()], points[shared.back()]))
      return true;
  }
  return false;
}

}  // namespace isoatlas::detail::test
