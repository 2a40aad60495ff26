// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/vector_math.h"

namespace isoatlas::detail::io {

namespace {

// Polygons with more corners stay fans: cutting takes time proportional to the square of the number
// of corners, or more for difficult shapes.
constexpr std::size_t kMostCorners = 1000;

/// Twice the area of a polygon, which need not be flat, times its mean normal (Newell's formula).
Vec3 area_normal(std::span<const Vec3> positions, std::span<const std::uint32_t> corners) {
  Vec3 sum;
  const Vec3 origin = positions[corners[0]];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum = sum + cross(positions[corners[i]] - origin, positions[corners[i + 1]] - origin);
  }
  return sum;
}

struct Point {
  double x = 0, y = 0;
};

/// Positive if c is to the left of the line from a to b.
double turn(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon projected along the longest coordinate of its normal, counter-clockwise.
std::vector<Point> flattened(std::span<const Vec3> positions,
                             std::span<const std::uint32_t> corners, Vec3 normal) {
  const Vec3 n{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  std::vector<Point> points;
  for (const std::uint32_t v : corners) {
    const Vec3 p = positions[v];
    Point point = n.x >= n.y && n.x >= n.z ? Point{p.y, p.z}
                  : n.y >= n.z             ? Point{p.z, p.x}
                                           : Point{p.x, p.y};
    const double along = n.x >= n.y && n.x >= n.z ? normal.x : n.y >= n.z ? normal.y : normal.z;
    if (along < 0) std::swap(point.x, point.y);
    points.push_back(point);
  }
  return points;
}

/// Cuts off one ear after another; an ear is a corner whose triangle lies inside the polygon.
/// Nothing if no ear is left at some step.
std::optional<std::vector<std::array<std::size_t, 3>>> cut_ears(std::span<const Point> points) {
  std::vector<std::size_t> left(points.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto is_ear = [&](std::size_t a, std::size_t b, std::size_t c) {
    if (!(turn(points[a], points[b], points[c]) > 0)) return false;
    return std::ranges::none_of(left, [&](std::size_t i) {
      if (i == a || i == b || i == c) return false;
      const Point p = points[i];
      return turn(points[a], points[b], p) >= 0 && turn(points[b], points[c], p) >= 0 &&
             turn(points[c], points[a], p) >= 0;
    });
  };
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t k = 0;
    while (k < n && !is_ear(left[(k + n - 1) % n], left[k], left[(k + 1) % n])) ++k;
    if (k == n) return std::nullopt;
    triangles.push_back({left[(k + n - 1) % n], left[k], left[(k + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace

void PolygonCutter::append(std::span<const std::uint32_t> corners) {
  if (corners.size() > 3 && corners.size() <= kMostCorners) {
    polygons_.push_back({mesh_.triangles.size(), corners_.size(), corners.size()});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

void PolygonCutter::cut_concave() {
  const std::vector<Vec3>& positions = mesh_.positions;
  for (const Polygon& polygon : polygons_) {
    const std::span<const std::uint32_t> corners(corners_.data() + polygon.first_corner,
                                                 polygon.corner_count);
    if (std::ranges::any_of(corners, [&](std::uint32_t v) { return v >= positions.size(); }))
      continue;  // read_mesh refuses such a mesh
    const Vec3 normal = area_normal(positions, corners);
    bool is_sound = true;
    for (std::size_t i = 1; is_sound && i + 1 < corners.size(); ++i) {
      const Vec3 origin = positions[corners[0]];
      is_sound = dot(normal, cross(positions[corners[i]] - origin,
                                   positions[corners[i + 1]] - origin)) >= 0;
    }
    if (is_sound) continue;
    if (const auto cut = cut_ears(flattened(positions, corners, normal))) {
      for (std::size_t t = 0; t < cut->size(); ++t) {
        const auto& [a, b, c] = (*cut)[t];
        mesh_.triangles[polygon.first_triangle + t] = {corners[a], corners[b], corners[c]};
      }
    }
  }
}

}  // namespace isoatlas::detail::io
