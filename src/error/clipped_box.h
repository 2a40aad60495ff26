// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/vector_math.h"
#include "field/field.h"

namespace isoatlas::detail {

inline constexpr double kMinBoxSize = 1.0 / 16;  ///< of a box that is bisected, in grid cells

/// A cube inside a grid cell, in coordinates from 0 to 1 of this grid cell.
struct GridCellBox {
  Vec3 low;
  double size;
  Vec3 corner(std::size_t k) const {
    return low + size * Vec3{static_cast<double>(k & 1), static_cast<double>(k >> 1 & 1),
                             static_cast<double>(k >> 2)};
  }
  /// One of the eight parts of the bisected box.
  GridCellBox part(std::size_t k) const {
    return {GridCellBox{low, 0.5 * size}.corner(k), 0.5 * size};
  }
};

/// A convex body that contains the isosurface in a box, given by its corners: the part of the box
/// between two parallel planes. There are at most the corners of the box and two on each of its
/// edges.
class ClippedBox {
 public:
  /// @return false if there is no isosurface in the box
  bool cut(const TrilinearCell& field, const GridCellBox& box) {
    count_ = 0;
    std::array<double, 8> value;
    bool inside = false, outside = false;
    double mean = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      value[k] = field.value(box.corner(k));
      (value[k] >= 0 ? inside : outside) = true;
      mean += value[k] / 8;
    }
    if (!std::isfinite(mean)) {
      add_all_corners(box);
      return true;
    }
    if (!inside || !outside) return false;
    // A linear function that interpolates the field, and the range of its differences from the
    // field.
    Vec3 slope;
    for (std::size_t k = 0; k < 8; ++k)
      slope = slope +
              (0.25 * value[k]) * Vec3{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0};
    std::array<double, 8> linear;
    double lowest = INFINITY, highest = -INFINITY, largest = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      linear[k] =
          mean + 0.5 * dot(slope, Vec3{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
      lowest = std::min(lowest, linear[k] - value[k]);
      highest = std::max(highest, linear[k] - value[k]);
      largest = std::max(largest, std::abs(value[k]));
    }
    lowest -= kFieldRounding * largest;
    highest += kFieldRounding * largest;
    for (std::size_t k = 0; k < 8; ++k) {
      if (linear[k] >= lowest && linear[k] <= highest) add(box.corner(k));
    }
    for (std::size_t axis = 1; axis < 8; axis *= 2) {
      for (std::size_t k = 0; k < 8; ++k) {
        if (k & axis) continue;
        const double from = linear[k], to = linear[k | axis];
        for (const double plane : {lowest, highest}) {
          if ((from < plane) == (to < plane)) continue;
          const double t = (plane - from) / (to - from);
          const Vec3 a = box.corner(k), b = box.corner(k | axis);
          add(a + t * (b - a));
        }
      }
    }
    if (count_ == 0) add_all_corners(box);  // because of rounding
    return true;
  }

  /// Converts to metric coordinates. @param low  corner of the grid cell with the smallest index
  void convert_to_metric(Vec3 low, Vec3 spacing) {
    for (std::size_t i = 0; i < count_; ++i) corner_[i] = to_metric(low + corner_[i], spacing);
  }
  Vec3 centre() const {
    Vec3 sum;
    for (const Vec3& p : corners()) sum = sum + p;
    return (1.0 / static_cast<double>(count_)) * sum;
  }
  double radius(Vec3 centre) const {
    double squared = 0;
    for (const Vec3& p : corners()) squared = std::max(squared, squared_length(p - centre));
    return std::sqrt(squared);
  }
  std::span<const Vec3> corners() const { return {corner_.data(), count_}; }

 private:
  static constexpr double kFieldRounding = 1e-9;  // of the values in a box, with a margin

  void add(Vec3 p) { corner_[count_++] = p; }
  void add_all_corners(const GridCellBox& box) {
    for (std::size_t k = 0; k < 8; ++k) add(box.corner(k));
  }

  std::array<Vec3, 32> corner_;
  std::size_t count_ = 0;
};

}  // namespace isoatlas::detail
