// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/vector_math.h"
#include "error/level_mesh.h"
#include "geometry/closest_point.h"

namespace isoatlas::detail {

/// The triangles with a corner at a cell's vertex or at one of its neighbours, for closest-point
/// queries. Each triangle has a bounding ball relative to the cell's vertex, so that most triangles
/// are rejected after one distance; flat arrays of float let the compiler vectorize this. The
/// triangles of the cell itself come first, and are often sufficient.
class TwoRing {
 public:
  explicit TwoRing(const LevelMesh& mesh) : mesh_(mesh) {}

  void set_cell(CellId cell) {
    const auto own = mesh_.triangles_of.row(cell);
    cell_ = cell;
    own_count_ = own.size();
    last_closest_ = 0;
    triangles_.assign(own.begin(), own.end());
    make_balls(0);
  }

  /// @param exact_above  a distance up to this need not be the smallest
  std::pair<std::uint32_t, TrianglePoint> closest(Vec3 p, double exact_above = 0) {
    // Consecutive query points are near each other, so the triangle of the last one is tried first.
    TrianglePoint found = closest_on(last_closest_, p);
    const double squared_exact_above = exact_above * exact_above;
    if (found.squared_distance > squared_exact_above || exact_above == 0) {
      update_closest(0, own_count_, p, found);
      if (found.squared_distance > squared_exact_above || exact_above == 0) {
        if (triangles_.size() == own_count_) add_neighbours();
        update_closest(own_count_, triangles_.size(), p, found);
      }
    }
    return {triangles_[last_closest_], found};
  }

  /// Whether some query needed triangles that are not the cell's own.
  bool uses_neighbours() const { return triangles_.size() > own_count_; }

 private:
  static constexpr double kRounding = 1e-6;  // of float, with a margin

  void add_neighbours() {
    for (std::size_t i = 0; i < own_count_; ++i) {
      for (const CellId neighbour : mesh_.triangles[triangles_[i]]) {
        if (neighbour == cell_) continue;
        const auto neighbour_triangles = mesh_.triangles_of.row(neighbour);
        triangles_.insert(triangles_.end(), neighbour_triangles.begin(), neighbour_triangles.end());
      }
    }
    const auto others = triangles_.begin() + static_cast<std::ptrdiff_t>(own_count_);
    const auto is_own = [&](std::uint32_t t) {
      return std::find(triangles_.begin(), others, t) != others;
    };
    std::sort(others, triangles_.end());
    triangles_.erase(std::remove_if(others, std::unique(others, triangles_.end()), is_own),
                     triangles_.end());
    make_balls(own_count_);
  }

  void make_balls(std::size_t from) {
    const std::size_t n = triangles_.size();
    for (auto* v : {&x_, &y_, &z_, &radius_, &ball_distance_}) v->resize(n);
    for (std::size_t k = from; k < n; ++k) {
      const std::array<Vec3, 3> corners = mesh_.corners(triangles_[k]);
      const Vec3 centre = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]),
                 seen = centre - mesh_.point[cell_];
      double squared = 0;
      for (const Vec3& p : corners) squared = std::max(squared, squared_length(p - centre));
      x_[k] = static_cast<float>(seen.x);
      y_[k] = static_cast<float>(seen.y);
      z_[k] = static_cast<float>(seen.z);
      radius_[k] = static_cast<float>(std::sqrt(squared) + kRounding * length(seen));
    }
  }

  // Updates `found` if a triangle of [begin, end) is nearer.
  void update_closest(std::size_t begin, std::size_t end, Vec3 p, TrianglePoint& found) {
    const Vec3 seen = p - mesh_.point[cell_];
    const auto px = static_cast<float>(seen.x), py = static_cast<float>(seen.y),
               pz = static_cast<float>(seen.z);
    const auto reach = [&] {
      return static_cast<float>(std::sqrt(found.squared_distance) + kRounding * length(seen));
    };
    float search_radius = reach();
    for (std::size_t k = begin; k < end; ++k) {
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz,
                  limit = search_radius + radius_[k];
      ball_distance_[k] = dx * dx + dy * dy + dz * dz - limit * limit;
    }
    for (std::size_t k = begin; k < end; ++k) {
      if (ball_distance_[k] >= 0 || k == last_closest_) continue;
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz,
                  limit = search_radius + radius_[k];
      if (dx * dx + dy * dy + dz * dz >= limit * limit) continue;  // a nearer one was found since
      const TrianglePoint other = closest_on(k, p);
      if (other.squared_distance >= found.squared_distance) continue;
      found = other;
      last_closest_ = k;
      search_radius = reach();
    }
  }

  TrianglePoint closest_on(std::size_t k, Vec3 p) const {
    const auto [a, b, c] = mesh_.corners(triangles_[k]);
    return closest_on_triangle(p, a, b, c);
  }

  const LevelMesh& mesh_;
  CellId cell_ = 0;
  std::size_t own_count_ = 0, last_closest_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<float> x_, y_, z_, radius_, ball_distance_;
};

}  // namespace isoatlas::detail
