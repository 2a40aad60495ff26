// SPDX-License-Identifier: Apache-2.0
#include "embed/meeting_triangles.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "embed/find_pairs.h"
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

// @return the triangles that are new since the last mesh or have a corner that moved
std::vector<std::uint32_t> MeetingTriangles::take_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const std::size_t known = std::min(positions.size(), positions_.size());
  stayed_.assign(positions.size(), 0);
  positions_.resize(positions.size());
  in_space_.resize(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (v < known && positions_[v] == positions[v]) {
      stayed_[v] = 1;
    } else {
      positions_[v] = positions[v];
      in_space_[v] = written_.in_form(0, positions[v]);
    }
  }
  const bool same = std::ranges::equal(triangles, list_);
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    if (!stayed_[t[0]] || !stayed_[t[1]] || !stayed_[t[2]] || (!same && !triangles_.contains(with_smallest_first(t)))) fresh.push_back(i);
  }
  // Pairs of triangles that are both still there.
  TriangleSet now = same ? std::move(triangles_) : TriangleSet(triangles, positions.size());
  std::erase_if(pairs_, [&](const auto& pair) {
    const auto is_known = [&](const Triangle& t) {
      return std::ranges::all_of(t, [&](std::uint32_t v) { return v < stayed_.size() && stayed_[v] != 0; }) && now.contains(t);
    };
    return !is_known(pair.first) || !is_known(pair.second);
  });
  triangles_ = std::move(now);
  if (!same) list_.assign(triangles.begin(), triangles.end());
  return fresh;
}

bool MeetingTriangles::has_area_in_all_forms(const Triangle& t) const {
  if (!has_area(in_space_, t)) return false;
  for (std::size_t form = 1; form < written_.form_count(); ++form) {
    const std::array corners{written_.in_form(form, positions_[t[0]]), written_.in_form(form, positions_[t[1]]),
                             written_.in_form(form, positions_[t[2]])};
    if (!has_area(corners, {0, 1, 2})) return false;
  }
  return true;
}

bool MeetingTriangles::intersect_in_any_form(const Triangle& a, const Triangle& b) const {
  if (are_surely_apart(in_space_, a, b, written_.most_rounding())) return false;
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

std::vector<std::uint32_t> MeetingTriangles::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                    const RunControl& control) {
  const std::vector<std::uint32_t> fresh = take_mesh(positions, triangles);
  for (const std::uint32_t i : fresh) {
    const Triangle t = with_smallest_first(triangles[i]);
    if (!has_area_in_all_forms(t)) pairs_.emplace_back(t, t);
  }
  const auto is_wanted = [&](std::uint32_t a, std::uint32_t b) { return intersect_in_any_form(triangles[a], triangles[b]); };
  const bool most = 2 * fresh.size() > triangles.size();
  if (most) std::erase_if(pairs_, [](const auto& pair) { return pair.first != pair.second; });  // they are found again
  const ThreadLimit threads(control.threads);
  for (const auto& [a, b] : find_pairs(in_space_, triangles, written_.most_rounding(),
                                       most ? std::nullopt : std::optional<std::span<const std::uint32_t>>(fresh), is_wanted, control))
    pairs_.emplace_back(with_smallest_first(triangles[a]), with_smallest_first(triangles[b]));

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
