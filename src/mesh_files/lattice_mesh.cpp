// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/lattice_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "core/ids.h"

namespace isoatlas::detail::io {
namespace {

// Cuts a mesh at planes normal to one axis.
class AxisCutter {
 public:
  AxisCutter(LatticeMesh& mesh, std::size_t axis, const PlaneAbove& plane_above)
      : mesh_(mesh), axis_(axis), plane_above_(plane_above) {}

  void cut() {
    std::vector<Triangle> todo = std::move(mesh_.triangles);
    mesh_.triangles.clear();
    while (!todo.empty()) {
      const Triangle t = todo.back();
      todo.pop_back();
      const auto [low, high] = std::minmax({at(t[0]), at(t[1]), at(t[2])});
      // From low to high planes, so that all triangles cut a common edge in the same order.
      const std::int64_t plane = plane_above_(low);
      if (plane < high)
        cut_triangle(t, plane, todo);
      else
        mesh_.triangles.push_back(t);
    }
  }

 private:
  std::int64_t at(std::uint32_t v) const { return mesh_.positions[v][axis_]; }

  // Appends the two or three parts of a triangle.
  void cut_triangle(Triangle t, std::int64_t plane, std::vector<Triangle>& parts) {
    const auto side = [&](std::uint32_t v) { return at(v) < plane ? -1 : at(v) > plane ? 1 : 0; };
    // The first corner is the one alone on its side, or the one on the plane.
    const int sum = side(t[0]) + side(t[1]) + side(t[2]);
    const auto is_first = [&](std::uint32_t v) {
      return sum == 0 ? side(v) == 0 : side(v) == -sum;
    };
    while (!is_first(t[0])) std::rotate(t.begin(), t.begin() + 1, t.end());
    if (sum == 0) {
      const std::uint32_t p = point_on_edge(t[1], t[2], plane);
      parts.push_back({t[0], t[1], p});
      parts.push_back({t[0], p, t[2]});
      return;
    }
    const std::uint32_t p = point_on_edge(t[0], t[1], plane), q = point_on_edge(t[2], t[0], plane);
    parts.push_back({t[0], p, q});
    parts.push_back({p, t[1], t[2]});
    parts.push_back({p, t[2], q});
  }

  std::uint32_t point_on_edge(std::uint32_t a, std::uint32_t b, std::int64_t plane) {
    if (a > b) std::swap(a, b);
    const auto [found, is_new] = points_.try_emplace({a, b, plane}, 0u);
    if (!is_new) return found->second;
    const LatticePoint from = mesh_.positions[a], to = mesh_.positions[b];
    const double share =
        static_cast<double>(plane - from[axis_]) / static_cast<double>(to[axis_] - from[axis_]);
    LatticePoint p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = from[k] + std::llround(share * static_cast<double>(to[k] - from[k]));
    p[axis_] = plane;
    found->second = checked_id(mesh_.positions.size(), "vertices");
    mesh_.positions.push_back(p);
    return found->second;
  }

  LatticeMesh& mesh_;
  std::size_t axis_;
  const PlaneAbove& plane_above_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::int64_t>, std::uint32_t> points_;
};

}  // namespace

LatticeMesh on_lattice(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                       Vec3 origin, double step) {
  LatticeMesh out;
  out.positions.reserve(positions.size());
  for (const Vec3& p : positions)
    out.positions.push_back({std::llround((p.x - origin.x) / step),
                             std::llround((p.y - origin.y) / step),
                             std::llround((p.z - origin.z) / step)});
  out.triangles.assign(triangles.begin(), triangles.end());
  return out;
}

void separate(LatticeMesh& mesh, const IsAllowed& is_allowed) {
  constexpr std::int64_t kReach = 2;
  std::vector<LatticePoint> offsets;
  for (std::int64_t x = -kReach; x <= kReach; ++x)
    for (std::int64_t y = -kReach; y <= kReach; ++y)
      for (std::int64_t z = -kReach; z <= kReach; ++z) offsets.push_back({x, y, z});
  const auto squared = [](const LatticePoint& p) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  };
  std::stable_sort(offsets.begin(), offsets.end(),
                   [&](const auto& a, const auto& b) { return squared(a) < squared(b); });
  std::set<LatticePoint> occupied;
  for (LatticePoint& p : mesh.positions) {
    for (const LatticePoint& offset : offsets) {
      LatticePoint q;
      bool is_possible = true;
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = p[k] + offset[k];
        is_possible = is_possible && is_allowed(p[k], q[k]);
      }
      if (!is_possible || !occupied.insert(q).second) continue;
      p = q;
      break;
    }
  }
}

void cut_at_planes(LatticeMesh& mesh, const PlaneAbove& plane_above) {
  for (std::size_t axis = 0; axis < 3; ++axis) AxisCutter(mesh, axis, plane_above).cut();
}

void weld(LatticeMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size()), number(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(mesh.positions[a], a) < std::tie(mesh.positions[b], b);
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    number[order[i]] = i > 0 && mesh.positions[order[i]] == mesh.positions[order[i - 1]]
                           ? number[order[i - 1]]
                           : order[i];
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = number[v];
  }
  std::erase_if(mesh.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

}  // namespace isoatlas::detail::io
