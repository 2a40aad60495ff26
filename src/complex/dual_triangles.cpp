// SPDX-License-Identifier: Apache-2.0
#include "complex/dual_triangles.h"

#include <algorithm>
#include <utility>

#include "core/cancel_poll.h"

namespace isoatlas::detail {
namespace {

bool same_corners(const std::array<CellId, 3>& a, const std::array<CellId, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3]) return true;
  }
  return false;
}

}  // namespace

DualTriangles::DualTriangles(std::vector<DualTriangle> triangles, std::uint32_t cells)
    : list_(std::move(triangles)) {
  std::vector<std::uint32_t> count(cells, 0);
  for (const DualTriangle& t : list_) {
    for (const CellId c : t.cell) ++count[c];
  }
  of_cell_.reserve(count);
  for (std::uint32_t i = 0; i < list_.size(); ++i) {
    for (const CellId c : list_[i].cell) of_cell_.push_back(c, i);
  }
}

void DualTriangles::replace(std::span<const CellId> scope, std::span<const DualTriangle> triangles,
                            std::uint32_t cells, const RunControl& control) {
  CancelPoll poll(control);
  if (cells > of_cell_.row_count()) of_cell_.resize_rows(cells);
  std::vector<std::uint32_t> old;
  const auto add_row = [&](CellId c) {
    poll.step();
    old.insert(old.end(), of_cell_.row(c).begin(), of_cell_.row(c).end());
  };
  for (const CellId c : scope) add_row(c);
  for (CellId c = cells; c < of_cell_.row_count(); ++c) add_row(c);
  std::sort(old.begin(), old.end());
  old.erase(std::unique(old.begin(), old.end()), old.end());
  control.check_cancelled();
  std::vector<std::uint8_t> is_kept(old.size(), 0);
  std::vector<DualTriangle> added;
  for (const DualTriangle& t : triangles) {
    poll.step();
    bool found = false;
    for (const std::uint32_t i : of_cell_.row(t.cell[0])) {
      if (!same_corners(list_[i].cell, t.cell)) continue;
      const auto at = std::lower_bound(old.begin(), old.end(), i) - old.begin();
      if (std::exchange(is_kept[static_cast<std::size_t>(at)], std::uint8_t{1}))
        continue;  // there are two with these corners
      list_[i].at = t.at;
      found = true;
      break;
    }
    if (!found) added.push_back(t);
  }
  std::size_t reused = 0;  // number of added triangles that reuse the id of a removed one
  for (std::size_t k = old.size(); k-- > 0;) {  // from the last one, so that earlier ids stay valid
    if (is_kept[k]) continue;
    poll.step();
    if (reused < added.size()) {
      for (const CellId c : list_[old[k]].cell) of_cell_.erase(c, old[k]);
      list_[old[k]] = added[reused++];
      for (const CellId c : list_[old[k]].cell) of_cell_.push_back(c, old[k]);
    } else {
      remove(old[k]);
    }
  }
  for (; reused < added.size(); ++reused) {
    poll.step();
    add(added[reused]);
  }
  of_cell_.resize_rows(cells);
}

void DualTriangles::add(const DualTriangle& triangle) {
  const std::uint32_t id = checked_id(list_.size(), "triangles");
  list_.push_back(triangle);
  for (const CellId c : triangle.cell) of_cell_.push_back(c, id);
}

void DualTriangles::remove(std::uint32_t id) {
  for (const CellId c : list_[id].cell) of_cell_.erase(c, id);
  const auto last = static_cast<std::uint32_t>(list_.size() - 1);
  if (id != last) {
    list_[id] = list_[last];
    for (const CellId c : list_[id].cell) {
      of_cell_.erase(c, last);
      of_cell_.push_back(c, id);
    }
  }
  list_.pop_back();
}

}  // namespace isoatlas::detail
