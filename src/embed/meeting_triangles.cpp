// SPDX-License-Identifier: Apache-2.0
#include "embed/meeting_triangles.h"

#include <algorithm>
#include <array>
#include <utility>

namespace isoatlas {
namespace {

Triangle with_smallest_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

std::vector<std::uint32_t> sorted_once(std::vector<std::uint32_t> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace

MeetingTriangles::TriangleSet::TriangleSet(std::span<const Triangle> triangles, std::size_t vertices)
    : first_(vertices + 1, 0), triangles_(triangles.size()) {
  for (const Triangle& t : triangles) ++first_[std::min({t[0], t[1], t[2]}) + 1];
  for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Triangle& t : triangles) {
    const Triangle turned = with_smallest_first(t);
    triangles_[next[turned[0]]++] = turned;
  }
}

bool MeetingTriangles::TriangleSet::contains(const Triangle& t) const {
  if (t[0] + 1 >= first_.size()) return false;
  return std::any_of(triangles_.begin() + first_[t[0]], triangles_.begin() + first_[t[0] + 1],
                     [&](const Triangle& other) { return other[1] == t[1] && other[2] == t[2]; });
}

std::vector<std::uint8_t> MeetingTriangles::vertices_that_stayed(std::span<const Vec3> positions) const {
  std::vector<std::uint8_t> out(positions.size(), 0);
  for (std::size_t v = 0; v < std::min(positions.size(), positions_.size()); ++v) out[v] = positions_[v] == positions[v];
  return out;
}

std::vector<std::uint8_t> MeetingTriangles::fresh(std::span<const Vec3> positions, std::span<const Triangle> triangles) const {
  const std::vector<std::uint8_t> stayed = vertices_that_stayed(positions);
  const bool same = std::ranges::equal(triangles, list_);
  std::vector<std::uint8_t> out(triangles.size(), 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    out[i] = !stayed[t[0]] || !stayed[t[1]] || !stayed[t[2]] || (!same && !triangles_.contains(with_smallest_first(t)));
  }
  return out;
}

std::vector<std::uint32_t> MeetingTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const RunControl& control) {
  const std::vector<std::uint8_t> is_fresh = fresh(positions, triangles);
  std::vector<std::uint32_t> to_look_at;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (is_fresh[i]) to_look_at.push_back(i);
  }
  const bool most = 2 * to_look_at.size() > triangles.size();
  std::vector<std::pair<Triangle, Triangle>> pairs;
  SelfIntersectionOptions options;
  if (!most) options.involving = to_look_at;
  RunControl quiet = control;  // it is not the stage that tells its progress
  quiet.progress = nullptr;
  for (const auto& [a, b] : self_intersections(positions, triangles, options, quiet))
    pairs.emplace_back(with_smallest_first(triangles[a]), with_smallest_first(triangles[b]));
  if (!std::ranges::equal(triangles, list_)) {
    list_.assign(triangles.begin(), triangles.end());
    triangles_ = TriangleSet(list_, positions.size());
  }
  if (!most) {
    const std::vector<std::uint8_t> stayed = vertices_that_stayed(positions);
    const auto is_there = [&](const Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < stayed.size() && stayed[v] != 0; }) &&
             triangles_.contains(t);
    };
    for (const auto& [a, b] : pairs_) {
      if (is_there(a) && is_there(b)) pairs.emplace_back(a, b);
    }
  }
  pairs_ = std::move(pairs);
  positions_.assign(positions.begin(), positions.end());

  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : pairs_) {
    corners.insert(corners.end(), a.begin(), a.end());
    corners.insert(corners.end(), b.begin(), b.end());
  }
  return sorted_once(std::move(corners));
}

std::vector<std::uint32_t> MeetingTriangles::largest_corners(std::span<const float> size_of_vertex) const {
  std::vector<std::uint32_t> out;
  for (const auto& [a, b] : pairs_) {
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
