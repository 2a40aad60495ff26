// SPDX-License-Identifier: Apache-2.0
#include "geometry/close_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kGrain = 4096;     // items per chunk of a parallel loop
constexpr std::size_t kLeafGrain = 64;   // leaves of the BVH, each with its candidates
constexpr std::size_t kQueryGrain = 64;  // triangles, each with its candidates

struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void include(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Box larger_by(double margin) const {
    return {{low.x - margin, low.y - margin, low.z - margin},
            {high.x + margin, high.y + margin, high.z + margin}};
  }
  bool overlaps(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y && low.z <= other.high.z && other.low.z <= high.z;
  }
};

Box box_of(std::span<const Vec3> positions, const Triangle& triangle) {
  Box box;
  for (const std::uint32_t v : triangle) box.include(positions[v]);
  return box;
}

// Calls find(begin, end, found) for chunks of [0, n), in parallel.
template <class Find>
std::vector<TrianglePair> collect(std::size_t n, std::size_t grain, const RunControl& control,
                                  const Find& find) {
  std::vector<TrianglePair> out =
      collect_chunks<TrianglePair>(n, grain, [&](std::size_t begin, std::size_t end, auto& found) {
        control.check_cancelled();
        find(begin, end, found);
      });
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

CloseTriangles::Scaling CloseTriangles::centred_scaling(std::span<const Vec3> positions) {
  double largest = 0;
  for (const Vec3& p : positions)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  const int exponent = largest > 0 ? std::ilogb(largest) + 1 : 0;
  Scaling out{std::ldexp(1.0, -exponent / 2), std::ldexp(1.0, -exponent + exponent / 2), {}};
  Box box;
  for (const Vec3& p : positions) box.include(out(p));
  if (!positions.empty()) out.middle = 0.5 * (box.low + box.high);
  return out;
}

// The margin after scaling, rounded up.
double CloseTriangles::scaled_margin() const {
  constexpr double kRounding = 1e-15;  // of coordinates up to 2
  return margin_ > 0 ? scaling_.second * (scaling_.first * margin_) + kRounding : 0;
}

std::vector<std::uint32_t> CloseTriangles::current(const IndexedBvh& bvh) const {
  std::vector<std::uint32_t> out;
  ranges::copy_if(bvh.ids, std::back_inserter(out),
                  [&](std::uint32_t t) { return t < bvh_of_.size() && bvh_of_[t] == bvh.id; });
  return out;
}

void CloseTriangles::add_bvh(std::vector<std::uint32_t> ids, std::span<const Vec3> positions,
                             std::span<const Triangle> triangles, const RunControl& control) {
  std::vector<Vec3> corners(3 * ids.size());
  std::vector<Triangle> local(ids.size());
  for_each_chunk(ids.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    control.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const auto first = static_cast<std::uint32_t>(3 * i);
      local[i] = {first, first + 1, first + 2};
      for (std::size_t k = 0; k < 3; ++k)
        corners[first + k] = scaling_(positions[triangles[ids[i]][k]]);
    }
  });
  const std::uint32_t id = next_id_++;
  for (const std::uint32_t t : ids) bvh_of_[t] = id;
  const std::size_t count = ids.size();
  bvhs_.push_back({id, count, std::move(ids), TriangleBvh(std::move(corners), local, control)});
}

void CloseTriangles::remove_from_bvh(std::uint32_t t) {
  const auto bvh = ranges::lower_bound(bvhs_, bvh_of_[t], {}, &IndexedBvh::id);
  if (bvh != bvhs_.end() && bvh->id == bvh_of_[t]) --bvh->current;
  bvh_of_[t] = kNone;
}

// Makes one BVH of all triangles.
void CloseTriangles::index_all(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                               const RunControl& control) {
  scaling_ = centred_scaling(positions);
  bvhs_.clear();
  std::vector<std::uint32_t> ids(triangles.size());
  std::iota(ids.begin(), ids.end(), 0u);
  add_bvh(std::move(ids), positions, triangles, control);
}

void CloseTriangles::start(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                           const RunControl& control) {
  bvh_of_.assign(triangles.size(), kNone);
  index_all(positions, triangles, control);
}

// Finds all pairs, with one BVH of all triangles.
std::vector<TrianglePair> CloseTriangles::all_pairs(std::span<const Vec3> positions,
                                                    std::span<const Triangle> triangles,
                                                    const PairTest& is_wanted,
                                                    const RunControl& control) {
  index_all(positions, triangles, control);
  const TriangleBvh& bvh = bvhs_.back().bvh;
  std::vector<Box> boxes(bvh.triangle_count());  // in the order of the BVH
  for_each_chunk(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    control.check_cancelled();
    for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot)
      boxes[slot] = box_of(positions, triangles[bvh.triangle_in(slot)]);
  });
  const double reach = 2 * margin_, scaled_reach = 2 * scaled_margin();
  return collect(
      bvh.leaf_count(), kLeafGrain, control,
      [&](std::size_t first, std::size_t last, std::vector<TrianglePair>& found) {
        std::vector<std::uint32_t> leaves;
        for (auto leaf = static_cast<std::uint32_t>(first); leaf < last;
             ++leaf) {  // tests its triangles against those after them in the BVH
          const std::uint32_t begin = TriangleBvh::kLeafSize * leaf, end = bvh.leaf_end(leaf);
          Box all;
          std::array<Box, TriangleBvh::kLeafSize> own;
          for (std::uint32_t slot = begin; slot < end; ++slot) {
            own[slot - begin] = boxes[slot].larger_by(reach);
            for (const std::uint32_t v : bvh.corners_in(slot)) all.include(bvh.points()[v]);
          }
          all = all.larger_by(scaled_reach);
          leaves.clear();
          bvh.leaves_near(all.low, all.high, leaf, leaves);
          for (const std::uint32_t candidate : leaves) {
            for (std::uint32_t other = TriangleBvh::kLeafSize * candidate;
                 other < bvh.leaf_end(candidate); ++other) {
              for (std::uint32_t slot = begin; slot < std::min(end, other); ++slot) {
                if (!own[slot - begin].overlaps(boxes[other])) continue;
                const std::uint32_t a = bvh.triangle_in(slot), b = bvh.triangle_in(other);
                if (is_wanted(a, b)) found.push_back(std::minmax(a, b));
              }
            }
          }
        }
      });
}

std::vector<TrianglePair> CloseTriangles::update(std::span<const Vec3> positions,
                                                 std::span<const Triangle> triangles,
                                                 std::span<const std::uint32_t> changed,
                                                 const PairTest& is_wanted,
                                                 const RunControl& control) {
  for (auto t = static_cast<std::uint32_t>(triangles.size()); t < bvh_of_.size(); ++t)
    remove_from_bvh(t);
  bvh_of_.resize(triangles.size(), kNone);
  is_changed_.clear();
  for (const std::uint32_t t : changed) is_changed_.insert(t);
  if (bvhs_.empty() || 2 * changed.size() > triangles.size()) {
    std::vector<TrianglePair> pairs = all_pairs(positions, triangles, is_wanted, control);
    std::erase_if(pairs, [&](const TrianglePair& pair) {
      return !is_changed_.contains(pair.first) && !is_changed_.contains(pair.second);
    });
    return pairs;
  }
  if (changed.empty()) return {};
  std::vector<std::uint32_t> ids(changed.begin(), changed.end());
  for (const std::uint32_t t : changed) remove_from_bvh(t);
  for (; !bvhs_.empty() && bvhs_.back().current <= 2 * ids.size(); bvhs_.pop_back()) {
    const std::vector<std::uint32_t> others = current(bvhs_.back());
    ids.insert(ids.end(), others.begin(), others.end());
  }
  add_bvh(std::move(ids), positions, triangles, control);

  const double reach = 2 * margin_, scaled_reach = 2 * scaled_margin();
  return collect(
      changed.size(), kQueryGrain, control,
      [&](std::size_t first, std::size_t last, std::vector<TrianglePair>& found) {
        std::vector<std::uint32_t> leaves;
        for (std::size_t i = first; i < last; ++i) {
          const std::uint32_t t = changed[i];
          const Box box = box_of(positions, triangles[t]).larger_by(reach);
          Box scaled;
          for (const std::uint32_t v : triangles[t]) scaled.include(scaling_(positions[v]));
          scaled = scaled.larger_by(scaled_reach);
          for (const IndexedBvh& bvh : bvhs_) {
            leaves.clear();
            bvh.bvh.leaves_near(scaled.low, scaled.high, 0, leaves);
            for (const std::uint32_t leaf : leaves) {
              for (std::uint32_t slot = TriangleBvh::kLeafSize * leaf;
                   slot < bvh.bvh.leaf_end(leaf); ++slot) {
                const std::uint32_t other = bvh.ids[bvh.bvh.triangle_in(slot)];
                if (other >= bvh_of_.size() || bvh_of_[other] != bvh.id) continue;
                // If both have changed, the pair is found from the larger one.
                if (other >= t && (other == t || is_changed_.contains(other))) continue;
                if (box.overlaps(box_of(positions, triangles[other])) && is_wanted(t, other))
                  found.push_back(std::minmax(t, other));
              }
            }
          }
        }
      });
}

}  // namespace isoatlas::detail
