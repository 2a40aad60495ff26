// SPDX-License-Identifier: Apache-2.0
// Bounding boxes over triangles, packed from the top down.
//
// Based on:
//   [lee2003] OMT: cuts at multiples of a full node, so that all nodes but the last of each level
//   are full.
// Ours: implicit nodes; boxes as floats that are never too small.
#include "geometry/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kBoxesPerChunk = 4096;  // items per chunk of a parallel loop

// Queries compare boxes in single precision. Boxes are widened by this share of the largest
// coordinate and squared distances to them are shortened, so that rounding never makes a box seem
// farther than it is, for any point.
constexpr double kWiden = 0x1p-21;
constexpr float kShorten = 1 - 0x1p-18f, kTiny = std::numeric_limits<float>::min();

struct Item {
  std::array<float, 3> centre;
  std::uint32_t triangle;
};

// Splits items in two across the longest side of their centres' box, with a multiple of `block`
// before the split, and recursively both parts; a part of at most one block is split into smaller
// blocks, down to `leaf`.
class Splitter {
 public:
  Splitter(std::size_t leaf, std::size_t children, const RunControl& control)
      : leaf_(leaf), children_(children), control_(control) {}

  void split(Item* first, Item* last, std::size_t block) const {
    const auto count = static_cast<std::size_t>(last - first);
    while (block > leaf_ && count <= block) block /= children_;
    if (count <= block) return;
    const std::size_t axis = longest_axis(first, last), blocks = (count + block - 1) / block;
    Item* const middle = first + blocks / 2 * block;
    std::nth_element(first, middle, last, [axis](const Item& i, const Item& j) {
      return i.centre[axis] < j.centre[axis] ||
             (i.centre[axis] == j.centre[axis] && i.triangle < j.triangle);
    });
    if (count <= 2 * kBoxesPerChunk) {
      split(first, middle, block);
      split(middle, last, block);
      return;
    }
    for_each_chunk(2, 1, [&](std::size_t begin, std::size_t end) {
      control_.check_cancelled();
      if (begin == 0) split(first, middle, block);
      if (end == 2) split(middle, last, block);
    });
  }

 private:
  static std::size_t longest_axis(const Item* first, const Item* last) {
    std::array<float, 3> low = first->centre, high = low;
    for (const Item* i = first; i != last; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], i->centre[a]);
        high[a] = std::max(high[a], i->centre[a]);
      }
    }
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
      if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    }
    return axis;
  }

  std::size_t leaf_, children_;
  const RunControl& control_;
};

double axis(Vec3 p, int a) { return a == 0 ? p.x : a == 1 ? p.y : p.z; }

}  // namespace

TriangleBvh::TriangleBvh(std::vector<Vec3> points, std::span<const Triangle> triangles,
                         const RunControl& control)
    : points_(std::move(points)) {
  checked_id(triangles.size(), "triangles");
  sort_triangles(triangles, control);
  make_boxes(control);
}

void TriangleBvh::sort_triangles(std::span<const Triangle> triangles, const RunControl& control) {
  std::vector<Item> items(triangles.size());
  for_each_chunk(triangles.size(), kBoxesPerChunk, [&](std::size_t begin, std::size_t end) {
    control.check_cancelled();
    for (std::size_t t = begin; t < end; ++t) {
      const auto [a, b, c] = triangles[t];
      const Vec3 sum = points_[a] + points_[b] + points_[c];
      items[t] = {{static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)},
                  static_cast<std::uint32_t>(t)};
    }
  });
  std::size_t block = kLeafSize;
  while (block < items.size()) block *= kChildren;
  Splitter(kLeafSize, kChildren, control).split(items.data(), items.data() + items.size(), block);
  control.check_cancelled();
  slots_.resize(triangles.size());
  for_each_chunk(triangles.size(), kBoxesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      slots_[s] = {triangles[items[s].triangle], items[s].triangle};
  });
}

void TriangleBvh::make_boxes(const RunControl& control) {
  if (slots_.empty()) return;
  const std::size_t leaves = (slots_.size() + kLeafSize - 1) / kLeafSize;
  std::size_t total = 0;
  for (std::size_t boxes = leaves; levels_.empty() || boxes > 1;) {
    boxes = (boxes + kChildren - 1) / kChildren;
    levels_.push_back({total, boxes});
    total += boxes;
  }
  nodes_.resize(total);

  double largest = 0;
  for (const Vec3& p : points_)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double widen = kWiden * largest;

  struct Interval {
    double low = INFINITY, high = -INFINITY;
  };
  // The extent of box `box` along an axis: of the slots of a leaf, or of the node below.
  const auto extent = [&](std::size_t level, std::size_t box, int a) {
    Interval out;
    const auto include = [&](double low, double high) {
      out = {std::min(out.low, low), std::max(out.high, high)};
    };
    if (level == 0) {
      for (std::size_t s = kLeafSize * box; s < std::min(slots_.size(), kLeafSize * (box + 1));
           ++s) {
        for (const std::uint32_t v : slots_[s].corners)
          include(axis(points_[v], a), axis(points_[v], a));
      }
      return Interval{out.low - widen, out.high + widen};
    }
    const Node& node = nodes_[levels_[level - 1].first + box];
    for (std::size_t k = 0; k < kChildren; ++k) {
      if (node.half[a][k] >= 0)
        include(double{node.centre[a][k]} - node.half[a][k],
                double{node.centre[a][k]} + node.half[a][k]);
    }
    return out;
  };
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const std::size_t boxes = level == 0 ? leaves : levels_[level - 1].nodes;
    for_each_chunk(
        levels_[level].nodes, kBoxesPerChunk / 16, [&](std::size_t begin, std::size_t end) {
          control.check_cancelled();
          for (std::size_t i = begin; i < end; ++i) {
            Node& node = nodes_[levels_[level].first + i];
            for (std::size_t k = 0; k < kChildren; ++k) {
              for (int a = 0; a < 3; ++a) {
                const std::size_t box = kChildren * i + k;
                if (box >= boxes) {  // a missing child is infinitely far away
                  node.centre[a][k] = 0;
                  node.half[a][k] = -INFINITY;
                  continue;
                }
                const Interval e = extent(level, box, a);
                const auto centre = static_cast<float>(0.5 * (e.low + e.high));
                node.centre[a][k] = centre;
                node.half[a][k] = std::nextafter(
                    static_cast<float>(std::max(e.high - centre, centre - e.low)), INFINITY);
              }
            }
          }
        });
  }
}

TriangleBvh::Hit TriangleBvh::closest(Vec3 p, double max_distance) const {
  Hit best;
  best.squared_distance = std::min(max_distance * max_distance,
                                   1e300);  // less than infinity, the distance of missing children
  if (slots_.empty() || !(max_distance >= 0)) return best;

  const float q[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  // Boxes still to be visited, by level and index. A path down the hierarchy leaves at most seven
  // behind per level, and there are at most ten levels: 8^10 leaves.
  struct Pending {
    float squared_distance, to_centre;
    std::uint32_t level, index;
  };
  std::array<Pending, 10 * (kChildren - 1) + 1> stack;
  std::size_t pending = 0;
  stack[pending++] = {0, 0, static_cast<std::uint32_t>(levels_.size()),
                      0};  // level: one above that of the node itself
  while (pending > 0) {
    const Pending at = stack[--pending];
    if (at.squared_distance > best.squared_distance) continue;
    if (at.level == 0) {
      const std::size_t end = std::min(slots_.size(), kLeafSize * (std::size_t{at.index} + 1));
      for (std::size_t s = kLeafSize * std::size_t{at.index}; s < end; ++s) {
        const Slot& slot = slots_[s];
        const TrianglePoint found = closest_on_triangle(
            p, points_[slot.corners[0]], points_[slot.corners[1]], points_[slot.corners[2]]);
        if (found.squared_distance < best.squared_distance ||
            (found.squared_distance == best.squared_distance && slot.triangle < best.triangle)) {
          static_cast<TrianglePoint&>(best) = found;
          best.triangle = slot.triangle;
        }
      }
      continue;
    }
    const Node& node = nodes_[levels_[at.level - 1].first + at.index];
    // Boxes contain each other and possibly the point: the distance to a box prunes, the distance
    // to its centre determines the order of visits; the last one pushed is visited first.
    float to_box[kChildren] = {}, to_centre[kChildren] = {};
    for (int a = 0; a < 3; ++a) {
      for (std::size_t k = 0; k < kChildren; ++k) {
        const float from_centre = std::fabs(q[a] - node.centre[a][k]);
        const float beyond = from_centre - node.half[a][k];
        const float clamped = beyond > 0 ? beyond : 0;
        to_box[k] += clamped * clamped;
        to_centre[k] += from_centre * from_centre;
      }
    }
    const std::size_t first = pending;
    for (std::size_t k = 0; k < kChildren; ++k) {
      const float squared = to_box[k] * kShorten - kTiny;
      if (squared > best.squared_distance) continue;
      stack[pending] = {squared, to_centre[k], at.level - 1,
                        static_cast<std::uint32_t>(kChildren * at.index + k)};
      if (pending > first && stack[pending].to_centre > stack[pending - 1].to_centre)
        std::swap(stack[pending], stack[pending - 1]);
      ++pending;
    }
  }
  return best;
}

void TriangleBvh::leaves_near(Vec3 low, Vec3 high, std::uint32_t first,
                              std::vector<std::uint32_t>& out) const {
  if (slots_.empty()) return;
  float centre[3], half[3];  // rounded so that the box is never too small
  for (int a = 0; a < 3; ++a) {
    const double l = axis(low, a), h = axis(high, a);
    centre[a] = static_cast<float>(0.5 * (l + h));
    half[a] = std::nextafter(static_cast<float>(std::max(h - centre[a], centre[a] - l)), INFINITY);
  }
  struct Pending {
    std::uint32_t level, index;
  };
  std::array<Pending, 10 * (kChildren - 1) + 1> stack;  // as in closest()
  std::size_t pending = 0;
  stack[pending++] = {static_cast<std::uint32_t>(levels_.size()), 0};
  while (pending > 0) {
    const Pending at = stack[--pending];
    if (at.level == 0) {
      out.push_back(at.index);
      continue;
    }
    const Node& node = nodes_[levels_[at.level - 1].first + at.index];
    // Distances are shortened by more than rounding lengthens them, so the distance of two
    // overlapping boxes is at most the sum of their halves.
    bool overlaps[kChildren];
    for (std::size_t k = 0; k < kChildren; ++k) {
      bool all = true;
      for (int a = 0; a < 3; ++a)
        all &= std::fabs(centre[a] - node.centre[a][k]) * kShorten <= half[a] + node.half[a][k];
      overlaps[k] = all;
    }
    const std::uint32_t below = at.level - 1;
    for (std::size_t k = 0; k < kChildren; ++k) {
      const auto index = static_cast<std::uint32_t>(kChildren * at.index + k);
      // The last leaf below child k is leaf (number + 1) 8^below - 1.
      if (overlaps[k] && ((std::uint64_t{index} + 1) << (3 * below)) > first)
        stack[pending++] = {below, index};
    }
  }
}

}  // namespace isoatlas::detail
