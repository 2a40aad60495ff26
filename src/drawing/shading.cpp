// SPDX-License-Identifier: Apache-2.0
#include "drawing/shading.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "core/disjoint_sets.h"
#include "core/ids.h"
#include "core/ranges.h"
#include "core/vector_math.h"

namespace isoatlas::detail::drawing {
namespace {

/// A side of a triangle, from corner `3 * t + k` to the next corner of the same triangle.
struct Side {
  std::uint32_t low, high;  // its vertices
  std::uint32_t corner;
  bool ascends;  // from `low` to `high`
};

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::vector<Vec3> triangle_normals(const MeshView& mesh) {
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 p = mesh.positions[t[0]];
    normals.push_back(normalized(cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p)));
  }
  return normals;
}

/// The sides, those of one edge after each other.
std::vector<Side> sorted_sides(const MeshView& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), 3 * t + k, from < to});
    }
  }
  ranges::sort(sides, [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

double angle_at(const MeshView& mesh, const Triangle& t, std::size_t k) {
  const Vec3 p = mesh.positions[t[k]], u = mesh.positions[t[(k + 1) % 3]] - p,
             v = mesh.positions[t[(k + 2) % 3]] - p;
  return std::atan2(length(cross(u, v)), dot(u, v));
}

}  // namespace

ShadedMesh split_at_sharp_edges(const MeshView& mesh, double degrees) {
  const std::uint32_t corners = checked_id(3 * mesh.triangles.size(), "triangle corners");
  const std::vector<Vec3> normals = triangle_normals(mesh);
  const double least_cosine = std::cos(degrees * std::numbers::pi / 180);
  // Two corners are joined if they are at the same vertex, on both sides of a smooth edge. A
  // triangle without area has no normal and is smooth with all neighbours.
  const auto is_smooth = [&](std::uint32_t first, std::uint32_t second) {
    const Vec3 a = normals[first / 3], b = normals[second / 3];
    return a == Vec3{} || b == Vec3{} || dot(a, b) >= least_cosine;
  };
  DisjointSets joined(corners);
  const std::vector<Side> sides = sorted_sides(mesh);
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    while (j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high) ++j;
    if (j - i != 2 || sides[i].ascends == sides[i + 1].ascends) continue;
    const std::uint32_t a = sides[i].corner, b = sides[i + 1].corner;
    if (!is_smooth(a, b)) continue;
    joined.unite(a, next_corner(b));  // the sides run in opposite directions
    joined.unite(next_corner(a), b);
  }

  ShadedMesh out;
  out.mesh.triangles.resize(mesh.triangles.size());
  std::vector<std::uint32_t> vertex_of(corners, kNone);  // per set of joined corners
  for (std::uint32_t corner = 0; corner < corners; ++corner) {
    const Triangle& t = mesh.triangles[corner / 3];
    std::uint32_t& vertex = vertex_of[joined.find(corner)];
    if (vertex == kNone) {
      vertex = static_cast<std::uint32_t>(out.mesh.positions.size());
      out.mesh.positions.push_back(mesh.positions[t[corner % 3]]);
      out.normals.emplace_back();
    }
    out.mesh.triangles[corner / 3][corner % 3] = vertex;
    Vec3& sum = out.normals[vertex];
    sum = sum + angle_at(mesh, t, corner % 3) * normals[corner / 3];
  }
  for (Vec3& normal : out.normals) normal = normalized(normal);
  return out;
}

}  // namespace isoatlas::detail::drawing
