// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Points spread evenly over triangles: each represents the same area. Positions and triangles must
/// outlive this.
///
/// The triangles are laid one after another along a line by area, each of them filled by a
/// Sierpinski curve; the samples are equidistant on that line. So large and small triangles are
/// sampled equally densely, each sample has a compact patch of its own, and if neighbours in the
/// list are neighbours in space, consecutive samples are close to each other. Triangles without
/// area count equally if there are no others.
class AreaSamples {
 public:
  /// @pre at least one triangle if `count` > 0
  AreaSamples(std::span<const Vec3> positions, std::span<const Triangle> triangles,
              std::size_t count);

  std::size_t size() const { return samples_.size(); }
  double area() const { return area_; }  ///< of all triangles
  std::uint32_t triangle(std::size_t i) const { return samples_[i].triangle; }
  Vec3 point(std::size_t i) const;

 private:
  struct Sample {
    std::uint32_t triangle;
    float curve_share;  ///< share of the triangle's curve before the sample
  };
  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  std::vector<Sample> samples_;
  double area_ = 0;
};

}  // namespace isoatlas::detail
