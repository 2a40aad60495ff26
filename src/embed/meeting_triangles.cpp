// SPDX-License-Identifier: Apache-2.0
#include "embed/meeting_triangles.h"

#include <algorithm>
#include <array>
#include <utility>

#include "embed/triangle_pair.h"

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

std::vector<std::uint8_t> MeetingTriangles::Form::vertices_that_stayed(std::span<const Vec3> moved) const {
  std::vector<std::uint8_t> out(moved.size(), 0);
  for (std::size_t v = 0; v < std::min(moved.size(), positions.size()); ++v) out[v] = positions[v] == moved[v];
  return out;
}

// The triangles that are new since the last update() or have a corner that moved.
std::vector<std::uint32_t> MeetingTriangles::Form::fresh(std::span<const Vec3> moved, std::span<const Triangle> given) const {
  const std::vector<std::uint8_t> stayed = vertices_that_stayed(moved);
  const bool same = std::ranges::equal(given, list);
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < given.size(); ++i) {
    const Triangle& t = given[i];
    if (!stayed[t[0]] || !stayed[t[1]] || !stayed[t[2]] || (!same && !triangles.contains(with_smallest_first(t)))) out.push_back(i);
  }
  return out;
}

void MeetingTriangles::Form::update(std::vector<Vec3> moved, std::span<const Triangle> given, const RunControl& control) {
  const std::vector<std::uint32_t> to_look_at = fresh(moved, given);
  const bool most = 2 * to_look_at.size() > given.size();
  std::vector<std::pair<Triangle, Triangle>> found;
  for (const std::uint32_t i : to_look_at) {
    const Triangle t = with_smallest_first(given[i]);
    if (!has_area(moved, t)) found.emplace_back(t, t);
  }
  SelfIntersectionOptions options;
  if (!most) options.involving = to_look_at;
  RunControl quiet = control;  // it is not the stage that tells its progress
  quiet.progress = nullptr;
  for (const auto& [a, b] : self_intersections(moved, given, options, quiet))
    found.emplace_back(with_smallest_first(given[a]), with_smallest_first(given[b]));
  if (!std::ranges::equal(given, list)) {
    list.assign(given.begin(), given.end());
    triangles = TriangleSet(list, moved.size());
  }
  const std::vector<std::uint8_t> stayed = vertices_that_stayed(moved);
  const auto is_known = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < stayed.size() && stayed[v] != 0; }) && triangles.contains(t);
  };
  for (const auto& [a, b] : pairs) {
    if ((a == b || !most) && is_known(a) && is_known(b)) found.emplace_back(a, b);
  }
  pairs = std::move(found);
  positions = std::move(moved);
}

std::vector<std::uint32_t> MeetingTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const RunControl& control) {
  for (last_ = 0;; ++last_) {
    forms_[last_].update(written_.in_form(last_, positions), triangles, control);
    if (pairs() > 0 || last_ + 1 == forms_.size()) break;
  }
  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : forms_[last_].pairs) {
    corners.insert(corners.end(), a.begin(), a.end());
    corners.insert(corners.end(), b.begin(), b.end());
  }
  return sorted_once(std::move(corners));
}

std::vector<std::uint32_t> MeetingTriangles::largest_corners(std::span<const float> size_of_vertex) const {
  std::vector<std::uint32_t> out;
  for (const auto& [a, b] : forms_[last_].pairs) {
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
