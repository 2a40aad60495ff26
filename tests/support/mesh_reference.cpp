// SPDX-License-Identifier: Apache-2.0
#include "support/mesh_reference.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

namespace isoatlas::detail::test {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Point = std::array<double, 3>;

Point point(Vec3 p) { return {p.x, p.y, p.z}; }

template <class Number>
Number determinant(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto along = [&](const Point& p, std::size_t k) {
    return Number(Number(p[k]) - Number(a[k]));
  };
  const Number x = along(b, 1) * along(c, 2) - along(b, 2) * along(c, 1),
               y = along(b, 2) * along(c, 0) - along(b, 0) * along(c, 2),
               z = along(b, 0) * along(c, 1) - along(b, 1) * along(c, 0);
  return Number(x * along(d, 0) + y * along(d, 1) + z * along(d, 2));
}

template <class Number>
Number determinant(const Point& a, const Point& b, const Point& c, std::size_t i, std::size_t j) {
  const Number u = Number(b[i]) - Number(a[i]), v = Number(b[j]) - Number(a[j]),
               w = Number(c[i]) - Number(a[i]), x = Number(c[j]) - Number(a[j]);
  return Number(u * x - v * w);
}

double largest_difference(const Point& a, const Point& b) {
  return std::max({std::fabs(b[0] - a[0]), std::fabs(b[1] - a[1]), std::fabs(b[2] - a[2])});
}

constexpr long double kError = 1e-17L;  // a hundred times 2^-63

int sign(const Rational& x) { return x.sign(); }

// On which side of the plane through a, b and c the point d lies.
int side(const Point& a, const Point& b, const Point& c, const Point& d) {
  const long double rough = determinant<long double>(a, b, c, d);
  const long double size = static_cast<long double>(largest_difference(a, b)) *
                           largest_difference(a, c) * largest_difference(a, d);
  if (std::fabs(rough) > kError * size && std::isfinite(size)) return rough > 0 ? 1 : -1;
  return sign(determinant<Rational>(a, b, c, d));
}

// The same in the plane of two axes.
int turn(const Point& a, const Point& b, const Point& c, std::size_t i, std::size_t j) {
  const long double rough = determinant<long double>(a, b, c, i, j);
  const long double size =
      static_cast<long double>(largest_difference(a, b)) * largest_difference(a, c);
  if (std::fabs(rough) > kError * size && std::isfinite(size)) return rough > 0 ? 1 : -1;
  return sign(determinant<Rational>(a, b, c, i, j));
}

struct Corners {
  Point a, b, c;
  // Two axes onto which the triangle can be projected; equal if it has no area.
  std::array<std::size_t, 2> axes() const {
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {2, 0}}) {
      if (turn(a, b, c, i, j) != 0) return {i, j};
    }
    return {0, 0};
  }
};

bool is_between(const Point& p, const Point& a, const Point& b, std::size_t i,
                std::size_t j) {  // all on one line
  return std::min(a[i], b[i]) <= p[i] && p[i] <= std::max(a[i], b[i]) &&
         std::min(a[j], b[j]) <= p[j] && p[j] <= std::max(a[j], b[j]);
}

bool segments_intersect(const Point& p, const Point& q, const Point& a, const Point& b,
                        std::size_t i, std::size_t j) {
  const int pa = turn(p, q, a, i, j), pb = turn(p, q, b, i, j), ap = turn(a, b, p, i, j),
            aq = turn(a, b, q, i, j);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && is_between(a, p, q, i, j)) || (pb == 0 && is_between(b, p, q, i, j)) ||
         (ap == 0 && is_between(p, a, b, i, j)) || (aq == 0 && is_between(q, a, b, i, j));
}

bool is_inside(const Point& p, const Corners& t, std::size_t i, std::size_t j) {
  const int u = turn(t.a, t.b, p, i, j), v = turn(t.b, t.c, p, i, j), w = turn(t.c, t.a, p, i, j);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

// Whether a closed segment intersects a closed triangle that has an area.
bool segment_intersects(const Point& p, const Point& q, const Corners& t) {
  const int at_p = side(t.a, t.b, t.c, p), at_q = side(t.a, t.b, t.c, q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) {
    const auto [i, j] = t.axes();
    return is_inside(p, t, i, j) || is_inside(q, t, i, j) ||
           segments_intersect(p, q, t.a, t.b, i, j) || segments_intersect(p, q, t.b, t.c, i, j) ||
           segments_intersect(p, q, t.c, t.a, i, j);
  }
  const int u = side(p, q, t.a, t.b), v = side(p, q, t.b, t.c), w = side(p, q, t.c, t.a);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

class PairIntersection {
 public:
  explicit PairIntersection(const TriangleMesh& mesh) : mesh_(mesh) {}

  bool operator()(const Triangle& first, const Triangle& second) const {
    Triangle s = first, t = second;  // rotated so that common corners come first
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = std::find(t.begin() + static_cast<std::ptrdiff_t>(shared), t.end(), s[i]);
      if (found == t.end()) continue;
      std::swap(s[shared], s[i]);
      std::iter_swap(t.begin() + static_cast<std::ptrdiff_t>(shared), found);
      ++shared;
    }
    const Corners a = corners(s), b = corners(t);
    switch (shared) {
      case 0:
        return segment_intersects(a.a, a.b, b) || segment_intersects(a.b, a.c, b) ||
               segment_intersects(a.c, a.a, b) || segment_intersects(b.a, b.b, a) ||
               segment_intersects(b.b, b.c, a) || segment_intersects(b.c, b.a, a);
      case 1:  // they intersect beyond the corner only if one leaves the other through the side
               // opposite to it
        return segment_intersects(a.b, a.c, b) || segment_intersects(b.b, b.c, a);
      case 2: {
        if (side(a.a, a.b, a.c, b.c) != 0) return false;
        const auto [i, j] = a.axes();
        return turn(a.a, a.b, a.c, i, j) * turn(a.a, a.b, b.c, i, j) > 0;
      }
      default:
        return true;
    }
  }
  Corners corners(const Triangle& t) const {
    return {point(mesh_.positions[t[0]]), point(mesh_.positions[t[1]]),
            point(mesh_.positions[t[2]])};
  }

 private:
  const TriangleMesh& mesh_;
};

struct Box {
  Point low, high;
  std::uint32_t triangle;
};

double winding(const TriangleMesh& mesh, const std::vector<Vec3>& at, Vec3 p) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec3, 3> q;
    std::array<double, 3> l;
    for (std::size_t k = 0; k < 3; ++k) {
      q[k] = {at[t[k]].x - p.x, at[t[k]].y - p.y, at[t[k]].z - p.z};
      l[k] = std::sqrt(q[k].x * q[k].x + q[k].y * q[k].y + q[k].z * q[k].z);
    }
    const auto dot = [&](std::size_t i, std::size_t j) {
      return q[i].x * q[j].x + q[i].y * q[j].y + q[i].z * q[j].z;
    };
    const double over = q[0].x * (q[1].y * q[2].z - q[1].z * q[2].y) +
                        q[0].y * (q[1].z * q[2].x - q[1].x * q[2].z) +
                        q[0].z * (q[1].x * q[2].y - q[1].y * q[2].x);
    sum += std::atan2(over,
                      l[0] * l[1] * l[2] + dot(0, 1) * l[2] + dot(1, 2) * l[0] + dot(2, 0) * l[1]);
  }
  return sum / (2 * std::numbers::pi);
}

std::vector<std::uint32_t> component_of_triangle(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    parent[find(t[0])] = find(t[1]);
    parent[find(t[1])] = find(t[2]);
  }
  std::vector<std::uint32_t> out;
  for (const Triangle& t : mesh.triangles) out.push_back(find(t[0]));
  return out;
}

}  // namespace

EmbeddingCheck check_embedding(const TriangleMesh& mesh) {
  EmbeddingCheck out;
  const PairIntersection intersect(mesh);
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners c = intersect.corners(mesh.triangles[i]);
    if (const auto axes = c.axes(); axes[0] == axes[1]) {
      ++out.without_area;
      continue;
    }
    Box box{c.a, c.a, i};
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min({c.a[k], c.b[k], c.c[k]});
      box.high[k] = std::max({c.a[k], c.b[k], c.c[k]});
    }
    boxes.push_back(box);
  }
  std::ranges::sort(boxes, {}, [](const Box& box) { return box.low[0]; });
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size() && boxes[j].low[0] <= boxes[i].high[0]; ++j) {
      const Box &a = boxes[i], &b = boxes[j];
      if (a.low[1] > b.high[1] || b.low[1] > a.high[1] || a.low[2] > b.high[2] ||
          b.low[2] > a.high[2])
        continue;
      out.pairs += intersect(mesh.triangles[a.triangle], mesh.triangles[b.triangle]) ? 1 : 0;
    }
  }
  return out;
}

std::size_t misplaced_components(const TriangleMesh& mesh) {
  std::vector<Vec3> at;
  double size = 0;
  for (const Vec3& p : mesh.positions) {
    const Vec3 o = mesh.positions.front();
    at.push_back({p.x - o.x, p.y - o.y, p.z - o.z});
    size = std::max({size, std::fabs(at.back().x), std::fabs(at.back().y), std::fabs(at.back().z)});
  }
  const std::vector<std::uint32_t> component = component_of_triangle(mesh);
  struct Largest {
    double area = 0;
    Vec3 centre, normal;
  };
  std::vector<Largest> largest(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3 a = at[t[0]], b = at[t[1]], c = at[t[2]];
    const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
    const Vec3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    const double area = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    if (area <= largest[component[i]].area) continue;
    largest[component[i]] = {area,
                             {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3},
                             {n.x / area, n.y / area, n.z / area}};
  }
  // Winding numbers of the outer side, approaching it until nothing else of the mesh is between: 0
  // or -1, and one more inside.
  std::size_t around_outside = 0, around_inside = 0, components = 0;
  for (const Largest& l : largest) {
    if (l.area == 0) continue;
    ++components;
    for (const double step : {1e-6, 1e-8, 1e-10}) {
      const auto beside = [&](double by) {
        return winding(mesh, at,
                       {l.centre.x + by * size * l.normal.x, l.centre.y + by * size * l.normal.y,
                        l.centre.z + by * size * l.normal.z});
      };
      const double outer = beside(step), inner = beside(-step);
      constexpr double kRounding = 1e-2;
      if (std::fabs(inner - outer - 1) > kRounding ||
          std::fabs(outer - std::round(outer)) > kRounding)
        continue;
      around_outside += std::lround(outer) == 0 ? 1 : 0;
      around_inside += std::lround(outer) == -1 ? 1 : 0;
      break;
    }
  }
  return components - std::max(around_outside, around_inside);
}

}  // namespace isoatlas::detail::test
