// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_tree.h"

namespace isoatlas {

/// Points spread evenly over the triangles of a tree, which must outlive this: each stands for the same area.
///
/// The triangles are laid one after another, in the tree's order, along a line by area, each of them filled by a Sierpinski curve;
/// the samples are equidistant on that line. So triangles large or small are sampled alike, each sample has a compact patch of its
/// own, and one sample is close to the next. Triangles without area count as equals if there are no others.
class AreaSamples {
 public:
  /// @pre at least one triangle if `count` > 0
  AreaSamples(const TriangleTree& tree, std::size_t count);

  std::size_t size() const { return samples_.size(); }
  double area() const { return area_; }  ///< of all triangles
  std::uint32_t slot(std::size_t i) const { return samples_[i].slot; }
  Vec3 point(std::size_t i) const;

 private:
  struct Sample {
    std::uint32_t slot;
    float along;  ///< share of the triangle's curve before it
  };
  const TriangleTree& tree_;
  std::vector<Sample> samples_;
  double area_ = 0;
};

}  // namespace isoatlas
