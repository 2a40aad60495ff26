// SPDX-License-Identifier: Apache-2.0
#include "geometry/close_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kGrain = 4096;     // items per piece of a parallel loop
constexpr std::size_t kLeafGrain = 64;   // leaves of the tree, each with its candidates
constexpr std::size_t kQueryGrain = 64;  // triangles, each with its candidates

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
  std::vector<TrianglePair> out = collect_pieces<TrianglePair>(n, grain, [&](std::size_t begin, std::size_t end, auto& found) {
    control.check_cancelled();
    find(begin, end, found);
  });
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

std::vector<std::uint32_t> CloseTriangles::current(const Tree& tree) const {
  std::vector<std::uint32_t> out;
  std::ranges::copy_if(tree.numbers, std::back_inserter(out),
                       [&](std::uint32_t t) { return t < tree_of_.size() && tree_of_[t] == tree.id; });
  return out;
}

void CloseTriangles::add_tree(std::vector<std::uint32_t> numbers, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                              const RunControl& control) {
  std::vector<Vec3> corners(3 * numbers.size());
  std::vector<Triangle> local(numbers.size());
  for_each_piece(numbers.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    control.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const auto first = static_cast<std::uint32_t>(3 * i);
      local[i] = {first, first + 1, first + 2};
      for (std::size_t k = 0; k < 3; ++k) corners[first + k] = scaling_(positions[triangles[numbers[i]][k]]);
    }
  });
  const std::uint32_t id = next_id_++;
  for (const std::uint32_t t : numbers) tree_of_[t] = id;
  const std::size_t count = numbers.size();
  trees_.push_back({id, count, std::move(numbers), TriangleTree(std::move(corners), local, control)});
}

void CloseTriangles::leave_tree(std::uint32_t t) {
  const auto tree = std::ranges::lower_bound(trees_, tree_of_[t], {}, &Tree::id);
  if (tree != trees_.end() && tree->id == tree_of_[t]) --tree->current;
  tree_of_[t] = kNone;
}

// Of all triangles, in a tree of them all.
std::vector<TrianglePair> CloseTriangles::all_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const PairTest& is_wanted, const RunControl& control) {
  scaling_ = about_origin(positions);
  trees_.clear();
  std::vector<std::uint32_t> numbers(triangles.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  add_tree(std::move(numbers), positions, triangles, control);
  const TriangleTree& tree = trees_.back().tree;
  std::vector<Box> boxes(tree.triangle_count());  // in the order of the tree
  for_each_piece(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    control.check_cancelled();
    for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot)
      boxes[slot] = box_of(positions, triangles[tree.triangle_in(slot)]);
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
  for (auto t = static_cast<std::uint32_t>(triangles.size()); t < tree_of_.size(); ++t) leave_tree(t);
  tree_of_.resize(triangles.size(), kNone);
  is_changed_.clear();
  for (const std::uint32_t t : changed) is_changed_.insert(t);
  if (trees_.empty() || 2 * changed.size() > triangles.size()) {
    std::vector<TrianglePair> pairs = all_pairs(positions, triangles, is_wanted, control);
    std::erase_if(pairs, [&](const TrianglePair& pair) { return !is_changed_.contains(pair.first) && !is_changed_.contains(pair.second); });
    return pairs;
  }
  if (changed.empty()) return {};
  std::vector<std::uint32_t> numbers(changed.begin(), changed.end());
  for (const std::uint32_t t : changed) leave_tree(t);
  for (; !trees_.empty() && trees_.back().current <= 2 * numbers.size(); trees_.pop_back()) {
    const std::vector<std::uint32_t> others = current(trees_.back());
    numbers.insert(numbers.end(), others.begin(), others.end());
  }
  add_tree(std::move(numbers), positions, triangles, control);

  const double reach = 2 * margin_, scaled_reach = 2 * scaled_margin();
  return collect(changed.size(), kQueryGrain, control, [&](std::size_t first, std::size_t last, std::vector<TrianglePair>& found) {
    std::vector<std::uint32_t> leaves;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t t = changed[i];
      const Box box = box_of(positions, triangles[t]).larger_by(reach);
      Box scaled;
      for (const std::uint32_t v : triangles[t]) scaled.include(scaling_(positions[v]));
      scaled = scaled.larger_by(scaled_reach);
      for (const Tree& tree : trees_) {
        leaves.clear();
        tree.tree.leaves_near(scaled.low, scaled.high, 0, leaves);
        for (const std::uint32_t leaf : leaves) {
          for (std::uint32_t slot = TriangleTree::kLeaf * leaf; slot < tree.tree.leaf_end(leaf); ++slot) {
            const std::uint32_t other = tree.numbers[tree.tree.triangle_in(slot)];
            if (other >= tree_of_.size() || tree_of_[other] != tree.id) continue;
            // Of two that changed now the larger one finds the pair.
            if (other >= t && (other == t || is_changed_.contains(other))) continue;
            if (box.overlaps(box_of(positions, triangles[other])) && is_wanted(t, other)) found.push_back(std::minmax(t, other));
          }
        }
      }
    }
  });
}

}  // namespace isoatlas::detail
