// SPDX-License-Identifier: Apache-2.0
// Signs of volumes, and winding numbers by counting crossings along a ray. Predicates are those of
// CGAL's Kernel.
#include "geometry/mesh_nesting.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "geometry/closest_point.h"
#include "geometry/triangle_bvh.h"

namespace isoatlas::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_rational;

int sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

constexpr std::size_t kComponentsPerChunk = 16;  // components per chunk of a parallel loop

// -------------------------------------------------------------------------------------------------
// signs of volumes

struct VolumeSum {
  double six_volumes = 0, magnitude = 0;  // sums of the triangles' determinants, and of the
                                          // absolute values of their products
  std::size_t triangles = 0;
};

// Adds the volume of the tetrahedron spanned by the triangle and `origin`, times six.
void add(VolumeSum& sum, Vec3 origin, Vec3 a, Vec3 b, Vec3 c) {
  a = a - origin, b = b - origin, c = c - origin;
  sum.six_volumes += dot(a, cross(b, c));
  const auto absolute = [](Vec3 v) { return Vec3{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; };
  const Vec3 p = absolute(a), q = absolute(b), r = absolute(c);
  sum.magnitude += dot(p, {q.y * r.z + q.z * r.y, q.z * r.x + q.x * r.z, q.x * r.y + q.y * r.x});
  ++sum.triangles;
}

// Returns 0 if doubles do not determine the sign. Differences, products and their sum have relative
// errors below 16 epsilon; the sum of n terms has one more epsilon for each.
int certain_sign(const VolumeSum& sum) {
  const double error = (static_cast<double>(sum.triangles) + 16) *
                       std::numeric_limits<double>::epsilon() * sum.magnitude;
  const bool is_known = std::isfinite(sum.magnitude) && std::fabs(sum.six_volumes) > error &&
                        error > std::numeric_limits<double>::min();
  return is_known ? sign_of(sum.six_volumes) : 0;
}

int exact_sign(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  Exact six_volumes = 0;
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) {
      const Vec3& p = positions[t[k]];
      return std::array<Exact, 3>{Exact(p.x), Exact(p.y), Exact(p.z)};
    };
    const auto a = at(0), b = at(1), c = at(2);
    six_volumes += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return static_cast<int>(CGAL::sign(six_volumes));
}

// -------------------------------------------------------------------------------------------------
// crossings of rays

// The side of the directed line from a to b on which p lies, seen along the x axis, with p moved by
// (e, e^2) in y and z for an infinitely small e > 0: then no line through two vertices contains it,
// and the edges of neighbouring triangles are on one side of it or the other.
int side_of(const Vec3& a, const Vec3& b, const Vec3& p) {
  const CGAL::Orientation side = CGAL::orientation(
      Kernel::Point_2(a.y, a.z), Kernel::Point_2(b.y, b.z), Kernel::Point_2(p.y, p.z));
  if (side != CGAL::COLLINEAR) return static_cast<int>(side);
  if (a.z != b.z) return a.z > b.z ? 1 : -1;
  return b.y == a.y ? 0 : b.y > a.y ? 1 : -1;
}

// The contribution of a triangle to the winding number of its surface at p: 0 unless the ray from p
// in the direction of -x intersects it.
int crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const int side = side_of(a, b, p);
  if (side == 0 || side_of(b, c, p) != side || side_of(c, a, p) != side) return 0;
  const auto point = [](const Vec3& v) { return Kernel::Point_3(v.x, v.y, v.z); };
  const CGAL::Orientation height = CGAL::orientation(point(a), point(b), point(c), point(p));
  return static_cast<int>(height) == side ? -side : 0;  // the normal has the sign of `side` along x
}

// Per component, the closed components that enclose its lowest vertex.
std::vector<std::vector<std::uint32_t>> find_enclosing_components(
    std::span<const Vec3> positions, std::span<const Triangle> triangles,
    std::span<const std::uint32_t> component_of, std::span<const std::uint8_t> is_open,
    const RunControl& control) {
  const std::size_t components = is_open.size();
  std::vector<std::uint32_t> lowest(components, kNone);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    std::uint32_t& best = lowest[component_of[v]];
    const auto is_lower = [&](const Vec3& p, const Vec3& q) {
      return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    if (best == kNone || is_lower(positions[v], positions[best])) best = v;
  }
  std::vector<std::vector<std::uint32_t>> enclosing(components);
  if (ranges::count(is_open, std::uint8_t{0}) < 2) return enclosing;
  const TriangleBvh bvh({positions.begin(), positions.end()}, triangles, control);
  for_each_index(components, kComponentsPerChunk, &control, [&](std::size_t c) {
    if (is_open[c] != 0 || lowest[c] == kNone) return;
    const Vec3 p = positions[lowest[c]];
    std::vector<std::uint32_t> leaves;
    std::map<std::uint32_t, int> winding;
    bvh.leaves_near({-1e18, p.y, p.z}, p, 0, leaves);
    for (const std::uint32_t leaf : leaves) {
      for (std::uint32_t slot = TriangleBvh::kLeafSize * leaf; slot < bvh.leaf_end(leaf); ++slot) {
        const Triangle& t = bvh.corners_in(slot);
        const std::uint32_t other = component_of[t[0]];
        if (other != c && is_open[other] == 0)
          winding[other] += crossing(positions[t[0]], positions[t[1]], positions[t[2]], p);
      }
    }
    for (const auto& [other, times] : winding) {
      if (times != 0) enclosing[c].push_back(other);
    }
  });
  return enclosing;
}

}  // namespace

std::vector<std::int8_t> mesh_facing(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles,
                                     std::span<const std::uint32_t> component_of,
                                     std::span<const std::uint8_t> is_open) {
  std::vector<VolumeSum> sums(is_open.size());
  // a vertex of the component: relative to the origin distant ones would lose digits
  std::vector<std::uint32_t> first(is_open.size(), kNone);
  for (const Triangle& t : triangles) {
    const std::uint32_t c = component_of[t[0]];
    if (first[c] == kNone) first[c] = t[0];
    add(sums[c], positions[first[c]], positions[t[0]], positions[t[1]], positions[t[2]]);
  }
  std::vector<std::int8_t> facing(is_open.size(), 0);
  std::vector<std::uint8_t> is_uncertain(is_open.size(), 0);
  for (std::size_t c = 0; c < is_open.size(); ++c) {
    if (is_open[c] != 0) continue;
    facing[c] = static_cast<std::int8_t>(certain_sign(sums[c]));
    is_uncertain[c] = facing[c] == 0 ? 1 : 0;
  }
  std::map<std::uint32_t, std::vector<Triangle>> uncertain;
  for (const Triangle& t : triangles) {
    if (is_uncertain[component_of[t[0]]] != 0) uncertain[component_of[t[0]]].push_back(t);
  }
  for (const auto& [c, of_component] : uncertain)
    facing[c] = static_cast<std::int8_t>(exact_sign(positions, of_component));
  return facing;
}

std::vector<std::uint32_t> misplaced_vertices(std::span<const Vec3> positions,
                                              std::span<const Triangle> triangles,
                                              std::span<const std::uint32_t> component_of,
                                              const Nesting& nesting, const Nesting& wanted,
                                              const RunControl& control) {
  const std::vector<std::uint8_t> is_misplaced = differences(nesting, wanted);
  std::vector<std::uint32_t> first(is_misplaced.size(), kNone), out;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const std::uint32_t c = component_of[v];
    if (is_misplaced[c] == 0) continue;
    if (first[c] == kNone) first[c] = v;
    out.push_back(v);
  }
  for (std::uint32_t c = 0; c < is_misplaced.size(); ++c) {
    if (is_misplaced[c] == 0 || first[c] == kNone || nesting.parent[c] == wanted.parent[c])
      continue;
    for (const std::uint32_t other : {nesting.parent[c], wanted.parent[c]}) {
      const Triangle* nearest = nullptr;
      double nearest_distance = std::numeric_limits<double>::infinity();
      control.check_cancelled();
      for (const Triangle& t : triangles) {
        if (component_of[t[0]] != other) continue;
        const double d = closest_on_triangle(positions[first[c]], positions[t[0]], positions[t[1]],
                                             positions[t[2]])
                             .squared_distance;
        if (d < nearest_distance) nearest_distance = d, nearest = &t;
      }
      if (nearest != nullptr) out.insert(out.end(), nearest->begin(), nearest->end());
    }
  }
  ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Nesting mesh_nesting(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                     std::span<const std::uint32_t> component_of,
                     std::span<const std::uint8_t> is_open, const RunControl& control) {
  Nesting nesting;
  run_both([&] { nesting.facing = mesh_facing(positions, triangles, component_of, is_open); },
           [&] {
             nesting.parent = parents_of(
                 find_enclosing_components(positions, triangles, component_of, is_open, control));
           });
  return nesting;
}

}  // namespace isoatlas::detail
