// SPDX-License-Identifier: Apache-2.0
#include "embed/close_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas {
namespace {

constexpr std::size_t kGrain = 4096;      // items per piece of a parallel loop
constexpr std::size_t kLeafGrain = 256;   // leaves of the tree, each with its candidates
constexpr std::size_t kQueryGrain = 256;  // triangles, each with its candidates

struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void include(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Box larger_by(double margin) const {
    return {{low.x - margin, low.y - margin, low.z - margin}, {high.x + margin, high.y + margin, high.z + margin}};
  }
  bool overlaps(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y && low.z <= other.high.z &&
           other.low.z <= high.z;
  }
};

Box box_of(std::span<const Vec3> positions, const Triangle& triangle) {
  Box box;
  for (const std::uint32_t v : triangle) box.include(positions[v]);
  return box;
}

// Calls find(begin, end, found) for pieces of [0, n), in parallel.
template <class Find>
std::vector<TrianglePair> collect(std::size_t n, std::size_t grain, const RunControl& control, const Find& find) {
  const std::size_t pieces = (n + grain - 1) / grain;
  std::vector<std::vector<TrianglePair>> found(pieces);
  for_each_piece(pieces, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t piece = begin; piece < end; ++piece) {
      control.check_cancelled();
      find(piece * grain, std::min(n, (piece + 1) * grain), found[piece]);
    }
  });
  std::vector<TrianglePair> out;
  for (const auto& part : found) out.insert(out.end(), part.begin(), part.end());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

CloseTriangles::Scaling CloseTriangles::about_origin(std::span<const Vec3> positions) {
  double largest = 0;
  for (const Vec3& p : positions) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  const int exponent = largest > 0 ? std::ilogb(largest) + 1 : 0;
  Scaling out{std::ldexp(1.0, -exponent / 2), std::ldexp(1.0, -exponent + exponent / 2), {}};
  Box box;
  for (const Vec3& p : positions) box.include(out(p));
  if (!positions.empty()) out.middle = 0.5 * (box.low + box.high);
  return out;
}

// No less than what the margin becomes.
double CloseTriangles::scaled_margin() const {
  constexpr double kRounding = 1e-15;  // of coordinates up to 2
  return margin_ > 0 ? scaling_.second * (scaling_.first * margin_) + kRounding : 0;
}

void CloseTriangles::make_tree(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  scaling_ = about_origin(positions);
  std::vector<Vec3> scaled(positions.size());
  for_each_piece(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) scaled[v] = scaling_(positions[v]);
  });
  tree_.emplace(std::move(scaled), triangles);
  is_in_tree_.assign(triangles.size(), 1);
  changed_since_.clear();
  is_changed_.clear();
}

TriangleTree CloseTriangles::tree_of_changed(std::span<const Vec3> positions, std::span<const Triangle> triangles) const {
  std::vector<Vec3> corners;
  std::vector<Triangle> local;
  corners.reserve(3 * changed_since_.size());
  for (const std::uint32_t t : changed_since_) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    for (const std::uint32_t v : triangles[t]) corners.push_back(scaling_(positions[v]));
    local.push_back({first, first + 1, first + 2});
  }
  return {std::move(corners), local};
}

// @pre the tree was made just now
std::vector<TrianglePair> CloseTriangles::all_pairs(std::span<const Vec3> positions, const PairTest& is_wanted, const RunControl& control) const {
  const TriangleTree& tree = *tree_;
  std::vector<Box> boxes(tree.triangle_count());  // in the order of the tree
  for_each_piece(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot) boxes[slot] = box_of(positions, tree.corners_in(slot));
  });
  const double reach = 2 * margin_, scaled_reach = 2 * scaled_margin();
  return collect(tree.leaf_count(), kLeafGrain, control, [&](std::size_t first, std::size_t last, std::vector<TrianglePair>& found) {
    std::vector<std::uint32_t> leaves;
    for (auto leaf = static_cast<std::uint32_t>(first); leaf < last; ++leaf) {  // its triangles with those after them in the tree
      const std::uint32_t begin = TriangleTree::kLeaf * leaf, end = tree.leaf_end(leaf);
      Box all;
      std::array<Box, TriangleTree::kLeaf> own;
      for (std::uint32_t slot = begin; slot < end; ++slot) {
        own[slot - begin] = boxes[slot].larger_by(reach);
        for (const std::uint32_t v : tree.corners_in(slot)) all.include(tree.positions()[v]);
      }
      all = all.larger_by(scaled_reach);
      leaves.clear();
      tree.leaves_near(all.low, all.high, leaf, leaves);
      for (const std::uint32_t near : leaves) {
        for (std::uint32_t other = TriangleTree::kLeaf * near; other < tree.leaf_end(near); ++other) {
          for (std::uint32_t slot = begin; slot < std::min(end, other); ++slot) {
            if (!own[slot - begin].overlaps(boxes[other])) continue;
            const std::uint32_t a = tree.triangle_in(slot), b = tree.triangle_in(other);
            if (is_wanted(a, b)) found.push_back(std::minmax(a, b));
          }
        }
      }
    }
  });
}

std::vector<TrianglePair> CloseTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                 std::span<const std::uint32_t> changed, const PairTest& is_wanted,
                                                 const RunControl& control) {
  if (!tree_ || 2 * changed.size() > triangles.size()) {
    make_tree(positions, triangles);
    std::vector<TrianglePair> pairs = all_pairs(positions, is_wanted, control);
    if (changed.size() == triangles.size()) return pairs;
    std::erase_if(pairs, [&](const TrianglePair& pair) {
      return !std::binary_search(changed.begin(), changed.end(), pair.first) && !std::binary_search(changed.begin(), changed.end(), pair.second);
    });
    return pairs;
  }
  std::erase_if(changed_since_, [&](std::uint32_t t) { return t >= triangles.size(); });
  for (std::size_t t = triangles.size(); t < is_in_tree_.size(); ++t) is_in_tree_[t] = 0;
  is_changed_now_.clear();
  for (const std::uint32_t t : changed) {
    is_changed_now_.insert(t);
    if (t < is_in_tree_.size()) is_in_tree_[t] = 0;
  }
  is_changed_.clear();
  for (const std::uint32_t t : changed_since_) is_changed_.insert(t);
  for (const std::uint32_t t : changed) {
    if (is_changed_.insert(t)) changed_since_.push_back(t);
  }
  if (2 * changed_since_.size() > triangles.size()) make_tree(positions, triangles);
  const TriangleTree latest = tree_of_changed(positions, triangles);
  const double reach = 2 * margin_, scaled_reach = 2 * scaled_margin();
  return collect(changed.size(), kQueryGrain, control, [&](std::size_t first, std::size_t last, std::vector<TrianglePair>& found) {
    std::vector<std::uint32_t> leaves;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t t = changed[i];
      const Box box = box_of(positions, triangles[t]).larger_by(reach);
      Box scaled;
      for (const std::uint32_t v : triangles[t]) scaled.include(scaling_(positions[v]));
      scaled = scaled.larger_by(scaled_reach);
      const auto look_in = [&](const TriangleTree& tree, auto number_of) {
        leaves.clear();
        tree.leaves_near(scaled.low, scaled.high, 0, leaves);
        for (const std::uint32_t leaf : leaves) {
          for (std::uint32_t slot = TriangleTree::kLeaf * leaf; slot < tree.leaf_end(leaf); ++slot) {
            const std::uint32_t other = number_of(tree.triangle_in(slot));
            // Of two that changed now the larger one finds the pair.
            if (other == kNone || (other >= t && is_changed_now_.contains(other)) || !box.overlaps(box_of(positions, triangles[other]))) continue;
            if (is_wanted(t, other)) found.push_back(std::minmax(t, other));
          }
        }
      };
      look_in(*tree_, [&](std::uint32_t other) { return is_in_tree_[other] != 0 ? other : kNone; });
      look_in(latest, [&](std::uint32_t other) { return changed_since_[other]; });
    }
  });
}

}  // namespace isoatlas
