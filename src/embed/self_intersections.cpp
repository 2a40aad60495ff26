// SPDX-License-Identifier: Apache-2.0
// All pairs of triangles that meet where they should not: candidates from boxes within boxes, then exact tests.
#include "isoatlas/self_intersections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "core/ids.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "embed/find_pairs.h"
#include "embed/triangle_pair.h"
#include "isoatlas/error.h"
#include "mesh/triangle_tree.h"

namespace isoatlas {
namespace {

constexpr std::size_t kGrain = 4096;      // items per piece of a parallel loop
constexpr std::size_t kLeafGrain = 256;   // leaves of the tree, each with its candidates
constexpr std::size_t kScanGrain = 8192;  // triangles to compare with a tree that is small and mostly elsewhere

struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void include(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Box larger_by(double margin) const {
    return {{low.x - margin, low.y - margin, low.z - margin}, {high.x + margin, high.y + margin, high.z + margin}};
  }
  bool meets(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y && low.z <= other.high.z &&
           other.low.z <= high.z;
  }
};

Box box_of(std::span<const Vec3> positions, const Triangle& triangle) {
  Box box;
  for (const std::uint32_t v : triangle) box.include(positions[v]);
  return box;
}

void check_input(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  checked_id(positions.size(), "vertices");
  checked_id(triangles.size(), "triangles");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 p = positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(ErrorCode::bad_argument, "vertex " + std::to_string(v) + " is not finite");
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t]) {
      if (v >= positions.size())
        throw Error(ErrorCode::bad_argument,
                    "triangle " + std::to_string(t) + " has vertex " + std::to_string(v) + " of " + std::to_string(positions.size()));
    }
  }
}

// Positions about the origin and no longer than 2, for boxes in single precision. Neither step turns an order of coordinates around, so
// boxes that meet still do.
struct AboutOrigin {
  std::vector<Vec3> positions;
  double margin;  // no less than what a margin becomes

  AboutOrigin(std::span<const Vec3> at, double old_margin) {
    double largest = 0;
    for (const Vec3& p : at) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    const int exponent = largest > 0 ? std::ilogb(largest) + 1 : 0;
    // In two steps: one power of two alone may not be a double.
    const double scale = std::ldexp(1.0, -exponent / 2), rest = std::ldexp(1.0, -exponent + exponent / 2);
    margin = old_margin > 0 ? rest * (scale * old_margin) + kRounding : 0;
    Box box;
    for (const Vec3& p : at) box.include(rest * (scale * p));
    const Vec3 middle = 0.5 * (box.low + box.high);
    positions.resize(at.size());
    for_each_piece(at.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) positions[v] = rest * (scale * at[v]) - middle;
    });
  }

 private:
  static constexpr double kRounding = 1e-15;  // of coordinates up to 2
};

// The space around some triangles in blocks, each marked if the box of a triangle reaches into it. Tells quickly of most other triangles
// that their boxes meet none of these.
class MarkedBlocks {
 public:
  /// @param positions  about the origin, see AboutOrigin
  /// @param triangles  at least one
  /// @param margin     that boxes meet with
  MarkedBlocks(std::span<const Vec3> positions, std::span<const Triangle> triangles, double margin)
      : blocks_per_axis_(std::clamp<std::size_t>(static_cast<std::size_t>(2 * std::cbrt(static_cast<double>(triangles.size()))), 1, kMostBlocks)),
        marked_(blocks_per_axis_ * blocks_per_axis_ * blocks_per_axis_, false) {
    Box all;
    for (const Triangle& t : triangles) {
      for (const std::uint32_t v : t) all.include(positions[v]);
    }
    all = all.larger_by(2 * margin);
    const auto n = static_cast<double>(blocks_per_axis_);
    const auto per_length = [n](double low, double high) { return high > low ? n / (high - low) : 0; };
    const Vec3 scale{per_length(all.low.x, all.high.x), per_length(all.low.y, all.high.y), per_length(all.low.z, all.high.z)};
    // It never decreases with the coordinate, whatever the rounding: so boxes that meet have a block in common.
    const auto index = [n](double x, double low, double blocks) {
      return static_cast<std::uint8_t>(std::clamp((x - low) * blocks, 0.0, n - 1));
    };
    blocks_.resize(positions.size());
    for_each_piece(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3 p = positions[v];
        const auto around = [&](double x, double low, double blocks) {
          return std::array{index(x - margin, low, blocks), index(x + margin, low, blocks)};
        };
        blocks_[v] = {around(p.x, all.low.x, scale.x), around(p.y, all.low.y, scale.y), around(p.z, all.low.z, scale.z)};
      }
    });
    for (const Triangle& t : triangles) {
      any_block(t, [&](std::size_t block) {
        marked_[block] = true;
        return false;
      });
    }
  }

  /// False only if the triangle's box meets the box of none of the triangles.
  bool may_meet(const Triangle& triangle) const {
    return any_block(triangle, [&](std::size_t block) { return marked_[block]; });
  }

 private:
  static constexpr std::size_t kMostBlocks = 64;  // along each axis

  // Whether `visit` says yes to one of the blocks that a triangle's box reaches into; those after it are not asked about.
  template <class Visit>
  bool any_block(const Triangle& t, Visit visit) const {
    const auto &a = blocks_[t[0]], &b = blocks_[t[1]], &c = blocks_[t[2]];
    std::array<std::size_t, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min({a[k][0], b[k][0], c[k][0]});
      high[k] = std::max({a[k][1], b[k][1], c[k][1]});
    }
    for (std::size_t z = low[2]; z <= high[2]; ++z) {
      for (std::size_t y = low[1]; y <= high[1]; ++y) {
        for (std::size_t x = low[0]; x <= high[0]; ++x) {
          if (visit((z * blocks_per_axis_ + y) * blocks_per_axis_ + x)) return true;
        }
      }
    }
    return false;
  }

  std::size_t blocks_per_axis_;  // few for few triangles, of which each then reaches into few
  using Range = std::array<std::uint8_t, 2>;
  std::vector<std::array<Range, 3>> blocks_;  // per vertex, along each axis, the blocks that it is in, within the margin
  std::vector<bool> marked_;
};

class Search {
 public:
  Search(std::span<const Vec3> positions, std::span<const Triangle> triangles, double margin, const PairTest& is_wanted,
         const RunControl& control)
      : positions_(positions), triangles_(triangles), margin_(margin), is_wanted_(is_wanted), control_(control) {}

  std::vector<TrianglePair> all() const {
    AboutOrigin scaled(positions_, margin_);
    const TriangleTree tree(std::move(scaled.positions), triangles_);
    const std::vector<Box> boxes = boxes_of(tree, positions_);
    return collect(tree.leaf_count(), kLeafGrain, [&](std::size_t begin, std::size_t end, std::vector<TrianglePair>& found) {
      std::vector<std::uint32_t> leaves;
      for (auto leaf = static_cast<std::uint32_t>(begin); leaf < end; ++leaf) pairs_of_leaf(tree, boxes, scaled.margin, leaf, leaves, found);
    });
  }

  std::vector<TrianglePair> involving(std::span<const std::uint32_t> wanted) const {
    std::vector<bool> listed(triangles_.size());
    for (const std::uint32_t t : wanted) {
      if (t >= triangles_.size())
        throw Error(ErrorCode::bad_argument,
                    "triangle " + std::to_string(t) + " of " + std::to_string(triangles_.size()) + " is to be looked at");
      listed[t] = true;
    }
    std::vector<std::uint32_t> list;
    std::vector<Triangle> corners;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!listed[t]) continue;
      list.push_back(t);
      corners.push_back(triangles_[t]);
    }
    if (list.empty()) return {};
    AboutOrigin scaled(positions_, margin_);
    const TriangleTree tree(std::move(scaled.positions), corners);
    const MarkedBlocks blocks(tree.positions(), corners, scaled.margin);
    const std::vector<Box> boxes = boxes_of(tree, positions_);
    return collect(triangles_.size(), kScanGrain, [&](std::size_t begin, std::size_t end, std::vector<TrianglePair>& found) {
      std::vector<std::uint32_t> leaves;
      for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
        if (!blocks.may_meet(triangles_[t])) continue;
        const Box scaled_box = box_of(tree.positions(), triangles_[t]).larger_by(2 * scaled.margin);
        const Box box = box_of(positions_, triangles_[t]).larger_by(2 * margin_);
        leaves.clear();
        tree.leaves_near(scaled_box.low, scaled_box.high, 0, leaves);
        for (const std::uint32_t leaf : leaves) {
          for (std::uint32_t slot = TriangleTree::kLeaf * leaf; slot < tree.leaf_end(leaf); ++slot) {
            if (!box.meets(boxes[slot])) continue;
            const std::uint32_t other = list[tree.triangle_in(slot)];
            const bool from_the_other_side = listed[t] && other <= t;
            if (!from_the_other_side) test(t, other, found);
          }
        }
      }
    });
  }

 private:
  void test(std::uint32_t t, std::uint32_t other, std::vector<TrianglePair>& found) const {
    if (is_wanted_(t, other)) found.push_back(std::minmax(t, other));
  }

  // Per slot of the tree, the box of its triangle.
  static std::vector<Box> boxes_of(const TriangleTree& tree, std::span<const Vec3> positions) {
    std::vector<Box> out(tree.triangle_count());
    for_each_piece(out.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot) out[slot] = box_of(positions, tree.corners_in(slot));
    });
    return out;
  }

  // The pairs of a leaf's triangles with those after them in the tree.
  void pairs_of_leaf(const TriangleTree& tree, std::span<const Box> boxes, double scaled_margin, std::uint32_t leaf,
                     std::vector<std::uint32_t>& leaves, std::vector<TrianglePair>& found) const {
    const std::uint32_t begin = TriangleTree::kLeaf * leaf, end = tree.leaf_end(leaf);
    Box all;
    for (std::uint32_t slot = begin; slot < end; ++slot) {
      for (const std::uint32_t v : tree.corners_in(slot)) all.include(tree.positions()[v]);
    }
    all = all.larger_by(2 * scaled_margin);
    leaves.clear();
    tree.leaves_near(all.low, all.high, leaf, leaves);
    for (const std::uint32_t near : leaves) {
      for (std::uint32_t other = TriangleTree::kLeaf * near; other < tree.leaf_end(near); ++other) {
        for (std::uint32_t slot = begin; slot < std::min(end, other); ++slot)
          if (boxes[slot].larger_by(2 * margin_).meets(boxes[other])) test(tree.triangle_in(slot), tree.triangle_in(other), found);
      }
    }
  }

  template <class Find>
  std::vector<TrianglePair> collect(std::size_t n, std::size_t grain, const Find& find) const {
    const std::size_t pieces = (n + grain - 1) / grain;
    std::vector<std::vector<TrianglePair>> found(pieces);
    for_each_piece(pieces, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t piece = begin; piece < end; ++piece) {
        control_.check_cancelled();
        find(piece * grain, std::min(n, (piece + 1) * grain), found[piece]);
      }
    });
    std::vector<TrianglePair> out;
    for (const auto& part : found) out.insert(out.end(), part.begin(), part.end());
    std::sort(out.begin(), out.end());
    return out;
  }

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  double margin_;
  const PairTest& is_wanted_;
  const RunControl& control_;
};

}  // namespace

std::vector<TrianglePair> find_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles, double margin,
                                     std::optional<std::span<const std::uint32_t>> involving, const PairTest& is_wanted,
                                     const RunControl& control) {
  const Search search(positions, triangles, margin, is_wanted, control);
  return involving ? search.involving(*involving) : search.all();
}

std::vector<TrianglePair> self_intersections(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                             const SelfIntersectionOptions& options, const RunControl& control) {
  const ThreadLimit threads(control.threads);
  control.report("intersect", 0);
  check_input(positions, triangles);
  const auto intersect = [&](std::uint32_t a, std::uint32_t b) { return meet_beyond_shared(positions, triangles[a], triangles[b]); };
  return find_pairs(positions, triangles, 0, options.involving, intersect, control);
}

Vec3 meeting_place(std::span<const Vec3> positions, const Triangle& a, const Triangle& b) {
  const Box one = box_of(positions, a), other = box_of(positions, b);
  const Vec3 low{std::max(one.low.x, other.low.x), std::max(one.low.y, other.low.y), std::max(one.low.z, other.low.z)};
  const Vec3 high{std::min(one.high.x, other.high.x), std::min(one.high.y, other.high.y), std::min(one.high.z, other.high.z)};
  return 0.5 * low + 0.5 * high;
}

}  // namespace isoatlas
