// SPDX-License-Identifier: Apache-2.0
#include "embed/intersection_tracker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "embed/triangle_pair.h"

namespace isoatlas {
namespace {

std::vector<std::uint32_t> sorted_once(std::vector<std::uint32_t> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace

// @return the numbers of the triangles that changed, sorted
std::vector<std::uint32_t> IntersectionTracker::take_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const std::size_t known = std::min(positions.size(), positions_.size());
  std::vector<std::uint8_t> moved(positions.size(), 1);
  positions_.resize(positions.size());
  in_space_.resize(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (v < known && positions_[v] == positions[v]) {
      moved[v] = 0;
    } else {
      positions_[v] = positions[v];
      in_space_[v] = written_.in_form(0, positions[v]);
    }
  }
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    if (i >= triangles_.size() || triangles_[i] != t || moved[t[0]] || moved[t[1]] || moved[t[2]]) changed.push_back(i);
  }
  std::erase_if(pairs_, [&](const TrianglePair& pair) {
    const auto is_changed = [&](std::uint32_t t) { return t >= triangles.size() || std::binary_search(changed.begin(), changed.end(), t); };
    return is_changed(pair.first) || is_changed(pair.second);
  });
  triangles_.assign(triangles.begin(), triangles.end());
  planes_.resize(triangles.size());
  for (const std::uint32_t t : changed) planes_[t] = RoughPlane(in_space_, triangles[t], written_.most_rounding());
  return changed;
}

bool IntersectionTracker::has_area_in_all_forms(const Triangle& t) const {
  if (!has_area(in_space_, t)) return false;
  for (std::size_t form = 1; form < written_.form_count(); ++form) {
    const std::array corners{written_.in_form(form, positions_[t[0]]), written_.in_form(form, positions_[t[1]]),
                             written_.in_form(form, positions_[t[2]])};
    if (!has_area(corners, {0, 1, 2})) return false;
  }
  return true;
}

bool IntersectionTracker::intersect_in_any_form(std::uint32_t first, std::uint32_t second) const {
  const Triangle &a = triangles_[first], &b = triangles_[second];
  if (are_surely_apart(in_space_, a, planes_[first], b, planes_[second], written_.most_rounding())) return false;
  if (meet_beyond_shared(in_space_, a, b)) return true;
  Triangle local = {3, 4, 5};  // b with the numbers of a's corners where they share them
  for (std::uint32_t& v : local) {
    const auto at = std::find(a.begin(), a.end(), b[v - 3]);
    if (at != a.end()) v = static_cast<std::uint32_t>(at - a.begin());
  }
  for (std::size_t form = 1; form < written_.form_count(); ++form) {
    std::array<Vec3, 6> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = written_.in_form(form, positions_[a[k]]);
      corners[3 + k] = written_.in_form(form, positions_[b[k]]);
    }
    if (meet_beyond_shared(corners, {0, 1, 2}, local)) return true;
  }
  return false;
}

std::vector<std::uint32_t> IntersectionTracker::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                       const RunControl& control) {
  const std::vector<std::uint32_t> changed = take_mesh(positions, triangles);
  CancelPoll poll(control);
  for (const std::uint32_t t : changed) {
    poll.step();
    if (!has_area_in_all_forms(triangles_[t])) pairs_.emplace_back(t, t);
  }
  const ThreadLimit threads(control.threads);
  const auto intersect = [&](std::uint32_t a, std::uint32_t b) { return intersect_in_any_form(a, b); };
  const std::vector<TrianglePair> found = close_.update(in_space_, triangles_, changed, intersect, control);
  pairs_.insert(pairs_.end(), found.begin(), found.end());

  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : pairs_) {
    corners.insert(corners.end(), triangles_[a].begin(), triangles_[a].end());
    corners.insert(corners.end(), triangles_[b].begin(), triangles_[b].end());
  }
  return sorted_once(std::move(corners));
}

std::vector<std::uint32_t> IntersectionTracker::largest_corners(std::span<const float> size_of_vertex) const {
  std::vector<std::uint32_t> out;
  for (const auto& [first, second] : pairs_) {
    const Triangle &a = triangles_[first], &b = triangles_[second];
    const std::array<std::uint32_t, 6> corner{a[0], a[1], a[2], b[0], b[1], b[2]};
    const auto largest = std::max_element(corner.begin(), corner.end(), [&](std::uint32_t v, std::uint32_t w) {
      return size_of_vertex[v] != size_of_vertex[w] ? size_of_vertex[v] < size_of_vertex[w] : v > w;
    });
    if (size_of_vertex[*largest] > 0) {
      out.push_back(*largest);
    } else {
      out.insert(out.end(), corner.begin(), corner.end());
    }
  }
  return sorted_once(std::move(out));
}

}  // namespace isoatlas
