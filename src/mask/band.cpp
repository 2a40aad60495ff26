// SPDX-License-Identifier: Apache-2.0
#include "mask/band.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

// Rings of samples with an unknown value, with thick slices more; where the boundary is flat along
// the grid, as many as it takes to reach its next step, so that no terraces remain.
constexpr int kRings = 5, kRingsOfThickSlices = 6, kMaxRings = 16;
// Least distances from zero, in units of the smallest spacing: of every sample, below the distance
// from the boundary (keeps small parts from shrinking), and next to the boundary in sheets that are
// one sample thin and in rods of one or two samples. (Without kRodMargin a cylinder of radius 1.2
// loses a fifth of its volume, with it a fiftieth.)
constexpr float kLeastMargin = 0.05f, kDistanceSlack = 0.9f, kSheetMargin = 0.35f,
                kThinRodMargin = 0.45f, kRodMargin = 0.3f;
constexpr std::size_t kSamplesPerChunk = 1 << 16;

// Twice the index of the midpoint of a grid edge.
using Midpoint = std::array<std::int32_t, 3>;

struct RingSample {
  std::size_t sample;
  Midpoint nearest;
  std::uint8_t rings_left;
};

class BandMaker {
 public:
  BandMaker(const Grid& grid, std::span<const std::uint8_t> inside, const RunControl& control)
      : size_(grid.size), inside_(inside), control_(control) {
    const double h = grid.smallest_spacing();
    step_ = {1, static_cast<std::ptrdiff_t>(size_[0]),
             static_cast<std::ptrdiff_t>(size_[0] * size_[1])};
    unit_ = {grid.spacing.x / h, grid.spacing.y / h, grid.spacing.z / h};
    least_rings_ = has_thick_slices(grid) ? kRingsOfThickSlices : kRings;
  }

  Band run() {
    std::vector<std::size_t> boundary = collect_chunks<std::size_t>(
        inside_.size(), kSamplesPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
          control_.check_cancelled();
          for (std::size_t s = begin; s < end; ++s) {
            if (crossed_axes(s, index_of(s)) != 0) found.push_back(s);
          }
        });
    if (boundary.empty())
      throw Error(ErrorCode::empty_surface, inside_[0] != 0 ? "all samples of the mask are inside"
                                                            : "no sample of the mask is inside");
    std::vector<RingSample> ring = first_ring(boundary);
    while (!ring.empty()) {
      for (const RingSample& r : ring) {
        order_.push_back({r.sample, static_cast<std::uint32_t>(order_.size()), r.rings_left});
        distance_of_.push_back(distance(r));
      }
      if (order_.size() >= Band::kOutside)
        throw Error(ErrorCode::unsupported,
                    "the mask has 2^32 - 1 or more samples near its boundary; mesh a part of it");
      ring = next_ring(ring);
    }
    return sorted_band(boundary.size());
  }

 private:
  struct Entry {
    std::size_t sample;
    std::uint32_t rank;  // ring by ring
    std::uint8_t rings_left;
  };

  Midpoint index_of(std::size_t s) const {
    const std::size_t row = s / size_[0];
    return {static_cast<std::int32_t>(s % size_[0]), static_cast<std::int32_t>(row % size_[1]),
            static_cast<std::int32_t>(row / size_[1])};
  }
  bool is_in_volume(const Midpoint& at, std::size_t axis, int direction) const {
    const std::int64_t next = std::int64_t{at[axis]} + direction;
    return next >= 0 && next < static_cast<std::int64_t>(size_[axis]);
  }
  std::size_t neighbour(std::size_t s, std::size_t axis, int direction) const {
    return s + static_cast<std::size_t>(direction * step_[axis]);
  }
  bool crosses(std::size_t s, const Midpoint& at, std::size_t axis, int direction) const {
    return is_in_volume(at, axis, direction) &&
           inside_[neighbour(s, axis, direction)] != inside_[s];
  }
  // Bit k: a grid edge along axis k crosses the boundary.
  unsigned crossed_axes(std::size_t s, const Midpoint& at) const {
    unsigned out = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (crosses(s, at, a, -1) || crosses(s, at, a, 1)) out |= 1u << a;
    }
    return out;
  }

  // Ring 0. Samples whose crossed edges are along one axis form flat parts of the boundary; the
  // number of steps within these parts to their ends decides how many rings they need.
  std::vector<RingSample> first_ring(const std::vector<std::size_t>& boundary) {
    rings_left_.assign(inside_.size(), 0);
    std::vector<std::uint8_t> axes(boundary.size());
    std::vector<std::size_t> front;
    for (std::size_t i = 0; i < boundary.size(); ++i) {
      const Midpoint at = index_of(boundary[i]);
      axes[i] = static_cast<std::uint8_t>(crossed_axes(boundary[i], at));
      const bool is_flat = (axes[i] & (axes[i] - 1)) == 0;
      rings_left_[boundary[i]] = is_flat ? kUnknown : static_cast<std::uint8_t>(least_rings_);
      if (!is_flat) front.push_back(boundary[i]);
    }
    // Breadth first, from the steps into the flat parts.
    for (int steps = 1; steps <= kMaxRings && !front.empty(); ++steps) {
      std::vector<std::size_t> next;
      for (const std::size_t s : front) {
        const Midpoint at = index_of(s);
        for (std::size_t a = 0; a < 3; ++a) {
          for (const int direction : {-1, 1}) {
            if (!is_in_volume(at, a, direction)) continue;
            const std::size_t n = neighbour(s, a, direction);
            if (rings_left_[n] != kUnknown) continue;
            rings_left_[n] =
                static_cast<std::uint8_t>(std::clamp(steps + 2, least_rings_, kMaxRings));
            next.push_back(n);
          }
        }
      }
      front = std::move(next);
    }
    std::vector<RingSample> out;
    for (const std::size_t s : boundary) {
      const int rings = rings_left_[s] == kUnknown ? least_rings_ : rings_left_[s];  // large planes
      rings_left_[s] = static_cast<std::uint8_t>(rings + Band::kFixedRings);
      out.push_back({s, nearest_crossing(s), rings_left_[s]});
    }
    return out;
  }

  Midpoint nearest_crossing(std::size_t s) const {
    const Midpoint at = index_of(s);
    Midpoint out{};
    double best = INFINITY;
    for (std::size_t a = 0; a < 3; ++a) {
      for (const int direction : {-1, 1}) {
        if (!crosses(s, at, a, direction) || unit_[a] >= best) continue;
        best = unit_[a];
        out = {2 * at[0], 2 * at[1], 2 * at[2]};
        out[a] += direction;
      }
    }
    return out;
  }

  float distance(const RingSample& r) const {
    const Midpoint at = index_of(r.sample);
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = unit_[a] * (at[a] - 0.5 * r.nearest[a]);
      sum += d * d;
    }
    return static_cast<float>(std::sqrt(sum));
  }

  std::vector<RingSample> next_ring(const std::vector<RingSample>& ring) {
    CancelPoll poll(control_);
    std::vector<RingSample> found;
    for (const RingSample& r : ring) {
      poll.step();
      if (r.rings_left <= 1) continue;
      const Midpoint at = index_of(r.sample);
      for (std::size_t a = 0; a < 3; ++a) {
        for (const int direction : {-1, 1}) {
          if (!is_in_volume(at, a, direction)) continue;
          const std::size_t n = neighbour(r.sample, a, direction);
          if (rings_left_[n] == 0)
            found.push_back({n, r.nearest, static_cast<std::uint8_t>(r.rings_left - 1)});
        }
      }
    }
    // Of several candidates for one sample the nearest boundary and the largest number of rings.
    ranges::stable_sort(found, std::less<>(), &RingSample::sample);
    std::vector<RingSample> out;
    for (const RingSample& r : found) {
      if (out.empty() || out.back().sample != r.sample) {
        out.push_back(r);
        continue;
      }
      RingSample& best = out.back();
      best.rings_left = std::max(best.rings_left, r.rings_left);
      if (distance(r) < distance(best)) best.nearest = r.nearest;
    }
    for (const RingSample& r : out) rings_left_[r.sample] = r.rings_left;
    return out;
  }

  Band sorted_band(std::size_t boundary_count) {
    rings_left_ = {};
    ranges::sort(order_, std::less<>(), &Entry::sample);
    Band out;
    std::vector<std::uint32_t> id(inside_.size(), Band::kOutside);
    for (std::size_t i = 0; i < order_.size(); ++i)
      id[order_[i].sample] = static_cast<std::uint32_t>(i);
    const std::size_t n = order_.size();
    out.sample.resize(n);
    out.neighbour.resize(n);
    out.is_inside.resize(n);
    out.distance.resize(n);
    out.margin.resize(n);
    out.rings_left.resize(n);
    out.axes.resize(n);
    for_each_index(n, kSamplesPerChunk, &control_, [&](std::size_t i) {
      const std::size_t s = order_[i].sample;
      const std::uint8_t rings_left = order_[i].rings_left;
      const std::uint32_t rank = order_[i].rank;
      const Midpoint at = index_of(s);
      out.sample[i] = s;
      out.is_inside[i] = inside_[s];
      out.distance[i] = distance_of_[rank];
      out.rings_left[i] = rings_left;
      for (std::size_t a = 0; a < 3; ++a) {
        for (const int direction : {-1, 1})
          out.neighbour[i][2 * a + (direction > 0)] =
              is_in_volume(at, a, direction) ? id[neighbour(s, a, direction)] : Band::kOutside;
        const bool is_between = is_in_volume(at, a, -1) && is_in_volume(at, a, 1);
        if (rings_left > 1 && is_between) out.axes[i] |= static_cast<std::uint8_t>(1 << a);
      }
      const bool is_boundary = rank < boundary_count;
      out.margin[i] = is_boundary ? boundary_margin(s, at)
                                  : std::max(kLeastMargin, out.distance[i] - kDistanceSlack);
    });
    return out;
  }

  // Larger in thin parts, which would shrink otherwise: sheets are one sample thin along an axis,
  // rods at most two along two axes.
  float boundary_margin(std::size_t s, const Midpoint& at) const {
    std::array<int, 3> thickness{};
    for (std::size_t a = 0; a < 3; ++a) thickness[a] = thickness_along(s, at, a);
    ranges::sort(thickness);
    if (thickness[1] == 1) return kThinRodMargin;
    if (thickness[0] == 1) return kSheetMargin;
    return thickness[1] == 2 ? kRodMargin : kLeastMargin;
  }

  // The number of samples on this side along an axis, 1 or 2; 3 if there are more, or the volume
  // ends.
  int thickness_along(std::size_t s, const Midpoint& at, std::size_t axis) const {
    int count = 1;
    for (const int direction : {-1, 1}) {
      if (!is_in_volume(at, axis, direction)) return 3;
      if (crosses(s, at, axis, direction)) continue;
      Midpoint next = at;
      next[axis] += direction;
      if (++count > 2 || !crosses(neighbour(s, axis, direction), next, axis, direction)) return 3;
    }
    return count;
  }

  static constexpr std::uint8_t kUnknown = 255;

  Size3 size_;
  std::span<const std::uint8_t> inside_;
  const RunControl& control_;
  std::array<std::ptrdiff_t, 3> step_{};
  std::array<double, 3> unit_{};  // spacing over the smallest spacing
  int least_rings_ = kRings;
  std::vector<std::uint8_t> rings_left_;  // per sample; 0: not reached
  std::vector<float> distance_of_;        // per entry of order_
  std::vector<Entry> order_;
};

}  // namespace

bool has_thick_slices(const Grid& grid) {
  const auto [least, largest] = std::minmax({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  return largest >= 2 * least;
}

Band make_band(const Grid& grid, std::span<const std::uint8_t> inside, const RunControl& control) {
  return BandMaker(grid, inside, control).run();
}

}  // namespace isoatlas::detail
