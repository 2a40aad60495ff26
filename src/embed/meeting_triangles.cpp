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

bool MeetingTriangles::stayed(std::span<const Vec3> positions, const Triangle& t) const {
  return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < positions_.size() && positions_[v] == positions[v]; });
}

std::vector<std::uint8_t> MeetingTriangles::fresh(std::span<const Vec3> positions, std::span<const Triangle> triangles) const {
  std::vector<std::uint8_t> out(triangles.size(), 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle t = with_smallest_first(triangles[i]);
    out[i] = !stayed(positions, t) || !std::binary_search(triangles_.begin(), triangles_.end(), t);
  }
  return out;
}

std::vector<std::uint32_t> MeetingTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const RunControl& control) {
  const std::vector<std::uint8_t> is_fresh = fresh(positions, triangles);
  std::vector<Triangle> sorted(triangles.size());
  std::transform(triangles.begin(), triangles.end(), sorted.begin(), with_smallest_first);
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
  for (const auto& [a, b] : self_intersections(positions, triangles, options, quiet)) pairs.emplace_back(sorted[a], sorted[b]);
  std::sort(sorted.begin(), sorted.end());
  if (!most) {
    const auto is_there = [&](const Triangle& t) { return stayed(positions, t) && std::binary_search(sorted.begin(), sorted.end(), t); };
    for (const auto& [a, b] : pairs_) {
      if (is_there(a) && is_there(b)) pairs.emplace_back(a, b);
    }
  }
  pairs_ = std::move(pairs);
  triangles_ = std::move(sorted);
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
