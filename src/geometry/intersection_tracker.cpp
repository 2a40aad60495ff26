// SPDX-License-Identifier: Apache-2.0
#include "geometry/intersection_tracker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kPerChunk = 2048;  // vertices or triangles, of a parallel loop

bool was_removed(const Triangle& t) { return t[0] == t[1] && t[1] == t[2]; }

}  // namespace

// @return the ids of the triangles that changed, sorted
std::vector<std::uint32_t> IntersectionTracker::update_mesh(std::span<const Vec3> positions,
                                                            std::span<const Triangle> triangles) {
  const std::size_t old_count = std::min(positions.size(), positions_.size());
  std::vector<std::uint8_t> moved(positions.size(), 1);
  positions_.resize(positions.size());
  output_.resize(positions.size());
  for_each_index(positions.size(), kPerChunk, [&](std::size_t v) {
    if (v < old_count && positions_[v] == positions[v]) {
      moved[v] = 0;
    } else {
      move(static_cast<std::uint32_t>(v), positions[v]);
    }
  });
  std::vector<std::uint32_t> changed = collect_chunks<std::uint32_t>(
      triangles.size(), kPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
          const Triangle& t = triangles[i];
          if (i >= triangles_.size() || triangles_[i] != t || moved[t[0]] || moved[t[1]] ||
              moved[t[2]])
            found.push_back(i);
        }
      });
  triangles_.assign(triangles.begin(), triangles.end());
  return changed;
}

void IntersectionTracker::move(std::uint32_t vertex, Vec3 to) {
  positions_[vertex] = to;
  output_[vertex] = forms_.in_form(0, to);
}

bool IntersectionTracker::has_area_in_all_forms(const Triangle& t) const {
  if (was_removed(t)) return true;
  if (!has_area(output_, t)) return false;
  for (std::size_t form = 1; form < forms_.form_count(); ++form) {
    const std::array corners{forms_.in_form(form, positions_[t[0]]),
                             forms_.in_form(form, positions_[t[1]]),
                             forms_.in_form(form, positions_[t[2]])};
    if (!has_area(corners, {0, 1, 2})) return false;
  }
  return true;
}

bool IntersectionTracker::intersect_in_any_form(std::uint32_t first, std::uint32_t second) const {
  const Triangle &a = triangles_[first], &b = triangles_[second];
  if (was_removed(a) || was_removed(b)) return false;
  if (are_certainly_disjoint(output_, a, b, forms_.max_rounding())) return false;
  if (intersect_beyond_shared_simplex(output_, a, b)) return true;
  Triangle local = {3, 4, 5};  // b, with the indices of a's corners where they are shared
  for (std::uint32_t& v : local) {
    const auto at = std::find(a.begin(), a.end(), b[v - 3]);
    if (at != a.end()) v = static_cast<std::uint32_t>(at - a.begin());
  }
  for (std::size_t form = 1; form < forms_.form_count(); ++form) {
    std::array<Vec3, 6> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = forms_.in_form(form, positions_[a[k]]);
      corners[3 + k] = forms_.in_form(form, positions_[b[k]]);
    }
    if (intersect_beyond_shared_simplex(corners, {0, 1, 2}, local)) return true;
  }
  return false;
}

void IntersectionTracker::start(std::span<const Vec3> positions,
                                std::span<const Triangle> triangles, const RunControl& control) {
  const ThreadLimit threads(control.threads);
  pairs_.clear();
  update_mesh(positions, triangles);
  close_.start(output_, triangles_, control);
}

std::vector<std::uint32_t> IntersectionTracker::update(std::span<const Vec3> positions,
                                                       std::span<const Triangle> triangles,
                                                       const RunControl& control) {
  const ThreadLimit threads(control.threads);
  return test(update_mesh(positions, triangles), control);
}

std::vector<std::uint32_t> IntersectionTracker::update(std::span<const std::uint32_t> vertices,
                                                       std::span<const Vec3> at,
                                                       std::span<const std::uint32_t> changed,
                                                       std::span<const Triangle> corners,
                                                       const RunControl& control) {
  const ThreadLimit threads(control.threads);
  for (std::size_t i = 0; i < vertices.size(); ++i) move(vertices[i], at[i]);
  for (std::size_t i = 0; i < changed.size(); ++i) triangles_[changed[i]] = corners[i];
  return test(changed, control);
}

// Tests the changed triangles. @return the corners of all pairs
std::vector<std::uint32_t> IntersectionTracker::test(std::span<const std::uint32_t> changed,
                                                     const RunControl& control) {
  std::erase_if(pairs_, [&](const TrianglePair& pair) {
    const auto is_changed = [&](std::uint32_t t) {
      return t >= triangles_.size() || std::binary_search(changed.begin(), changed.end(), t);
    };
    return is_changed(pair.first) || is_changed(pair.second);
  });
  const auto without_area = collect_chunks<TrianglePair>(
      changed.size(), kPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
        control.check_cancelled();
        for (const std::uint32_t t : changed.subspan(begin, end - begin)) {
          if (!has_area_in_all_forms(triangles_[t])) found.emplace_back(t, t);
        }
      });
  pairs_.insert(pairs_.end(), without_area.begin(), without_area.end());
  const auto intersect = [&](std::uint32_t a, std::uint32_t b) {
    return intersect_in_any_form(a, b);
  };
  const std::vector<TrianglePair> found =
      close_.update(output_, triangles_, changed, intersect, control);
  pairs_.insert(pairs_.end(), found.begin(), found.end());

  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : pairs_) {
    corners.insert(corners.end(), triangles_[a].begin(), triangles_[a].end());
    corners.insert(corners.end(), triangles_[b].begin(), triangles_[b].end());
  }
  sort_unique_ids(corners);
  return corners;
}

std::vector<std::uint32_t> IntersectionTracker::largest_corners(
    std::span<const float> size_of_vertex) const {
  std::vector<std::uint32_t> out;
  for (const auto& [first, second] : pairs_) {
    const Triangle &a = triangles_[first], &b = triangles_[second];
    const std::array<std::uint32_t, 6> corner{a[0], a[1], a[2], b[0], b[1], b[2]};
    const auto largest =
        std::max_element(corner.begin(), corner.end(), [&](std::uint32_t v, std::uint32_t w) {
          return size_of_vertex[v] != size_of_vertex[w] ? size_of_vertex[v] < size_of_vertex[w]
                                                        : v > w;
        });
    if (size_of_vertex[*largest] > 0) {
      out.push_back(*largest);
    } else {
      out.insert(out.end(), corner.begin(), corner.end());
    }
  }
  sort_unique_ids(out);
  return out;
}

}  // namespace isoatlas::detail
