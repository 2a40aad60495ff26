// SPDX-License-Identifier: Apache-2.0
#include "embed/meeting_triangles.h"

#include <algorithm>

namespace isoatlas {
namespace {

Triangle with_smallest_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

std::vector<std::uint32_t> MeetingTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const RunControl& control) {
  const auto stayed = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < positions_.size() && positions_[v] == positions[v]; });
  };
  std::vector<Triangle> sorted(triangles.size());
  std::transform(triangles.begin(), triangles.end(), sorted.begin(), with_smallest_first);
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (!stayed(sorted[i]) || !std::binary_search(triangles_.begin(), triangles_.end(), sorted[i])) fresh.push_back(i);
  }
  const bool most = 2 * fresh.size() > triangles.size();
  std::vector<std::pair<Triangle, Triangle>> pairs;
  SelfIntersectionOptions options;
  if (!most) options.involving = fresh;
  RunControl quiet = control;  // it is not the stage that tells its progress
  quiet.progress = nullptr;
  for (const auto& [a, b] : self_intersections(positions, triangles, options, quiet)) pairs.emplace_back(sorted[a], sorted[b]);
  std::sort(sorted.begin(), sorted.end());
  if (!most) {
    const auto is_there = [&](const Triangle& t) { return stayed(t) && std::binary_search(sorted.begin(), sorted.end(), t); };
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
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace isoatlas
