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

/// The triangles around a cell, those with a corner at it or at a neighbour of it, to be asked for closest points. Each has a ball
/// around it, as seen from the cell's vertex, so that most triangles are passed over after one distance; flat arrays of float, so
/// that a compiler does several at a time. Those of the cell itself come first, and often suffice.
class Ring {
 public:
  explicit Ring(const LevelMesh& mesh) : mesh_(mesh) {}

  void move_to(CellId cell) {
    const auto own = mesh_.triangles_of.row(cell);
    cell_ = cell;
    own_ = own.size();
    guess_ = 0;
    triangles_.assign(own.begin(), own.end());
    make_balls(0);
  }

  /// @param enough  a distance up to this need not be the smallest
  std::pair<std::uint32_t, TrianglePoint> closest(Vec3 p, double enough = 0) {
    // Points that follow each other are near each other: the last one's triangle is often right again.
    TrianglePoint found = look_at(guess_, p);
    const double squared_enough = enough * enough;
    if (found.squared_distance > squared_enough || enough == 0) {
      look_among(0, own_, p, found);
      if (found.squared_distance > squared_enough || enough == 0) {
        if (triangles_.size() == own_) add_neighbours();
        look_among(own_, triangles_.size(), p, found);
      }
    }
    return {triangles_[guess_], found};
  }

  /// Whether a point was farther than it had to be from the triangles of the cell itself.
  bool has_neighbours() const { return triangles_.size() > own_; }

 private:
  static constexpr double kRounding = 1e-6;  // of float, with room to spare

  void add_neighbours() {
    for (std::size_t i = 0; i < own_; ++i) {
      for (const CellId neighbour : mesh_.triangles[triangles_[i]]) {
        if (neighbour == cell_) continue;
        const auto theirs = mesh_.triangles_of.row(neighbour);
        triangles_.insert(triangles_.end(), theirs.begin(), theirs.end());
      }
    }
    const auto others = triangles_.begin() + static_cast<std::ptrdiff_t>(own_);
    const auto is_own = [&](std::uint32_t t) { return std::find(triangles_.begin(), others, t) != others; };
    std::sort(others, triangles_.end());
    triangles_.erase(std::remove_if(others, std::unique(others, triangles_.end()), is_own), triangles_.end());
    make_balls(own_);
  }

  void make_balls(std::size_t from) {
    const std::size_t n = triangles_.size();
    for (auto* v : {&x_, &y_, &z_, &radius_, &gap_}) v->resize(n);
    for (std::size_t k = from; k < n; ++k) {
      const std::array<Vec3, 3> corners = mesh_.corners(triangles_[k]);
      const Vec3 centre = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]), seen = centre - mesh_.point[cell_];
      double squared = 0;
      for (const Vec3& p : corners) squared = std::max(squared, squared_length(p - centre));
      x_[k] = static_cast<float>(seen.x);
      y_[k] = static_cast<float>(seen.y);
      z_[k] = static_cast<float>(seen.z);
      radius_[k] = static_cast<float>(std::sqrt(squared) + kRounding * length(seen));
    }
  }

  // Takes a nearer one of [begin, end), if there is one.
  void look_among(std::size_t begin, std::size_t end, Vec3 p, TrianglePoint& found) {
    const Vec3 seen = p - mesh_.point[cell_];
    const auto px = static_cast<float>(seen.x), py = static_cast<float>(seen.y), pz = static_cast<float>(seen.z);
    const auto reach = [&] { return static_cast<float>(std::sqrt(found.squared_distance) + kRounding * length(seen)); };
    float within = reach();
    for (std::size_t k = begin; k < end; ++k) {
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz, far = within + radius_[k];
      gap_[k] = dx * dx + dy * dy + dz * dz - far * far;
    }
    for (std::size_t k = begin; k < end; ++k) {
      if (gap_[k] >= 0 || k == guess_) continue;
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz, far = within + radius_[k];
      if (dx * dx + dy * dy + dz * dz >= far * far) continue;  // nearer ones have been found since
      const TrianglePoint other = look_at(k, p);
      if (other.squared_distance >= found.squared_distance) continue;
      found = other;
      guess_ = k;
      within = reach();
    }
  }

  TrianglePoint look_at(std::size_t k, Vec3 p) const {
    const auto [a, b, c] = mesh_.corners(triangles_[k]);
    return closest_on_triangle(p, a, b, c);
  }

  const LevelMesh& mesh_;
  CellId cell_ = 0;
  std::size_t own_ = 0, guess_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<float> x_, y_, z_, radius_, gap_;
};

}  // namespace isoatlas::detail
