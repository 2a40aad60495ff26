// SPDX-License-Identifier: Apache-2.0
#include "partition/triangle_slots.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace isoatlas {
namespace {

bool is_empty(const DualTriangle& t) { return t.cell[0] == kNone; }

bool same_corners(const std::array<CellId, 3>& a, const std::array<CellId, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3]) return true;
  }
  return false;
}

}  // namespace

TriangleSlots::TriangleSlots(std::vector<DualTriangle> triangles, std::uint32_t cells) : slots_(std::move(triangles)) {
  std::vector<std::uint32_t> count(cells, 0);
  for (const DualTriangle& t : slots_) {
    for (const CellId c : t.cell) ++count[c];
  }
  of_cell_.reserve(count);
  for (std::uint32_t slot = 0; slot < slots_.size(); ++slot) {
    for (const CellId c : slots_[slot].cell) of_cell_.push_back(c, slot);
  }
}

std::vector<DualTriangle> TriangleSlots::triangles() const {
  std::vector<DualTriangle> out;
  out.reserve(triangle_count());
  std::ranges::copy_if(slots_, std::back_inserter(out), [](const DualTriangle& t) { return !is_empty(t); });
  return out;
}

void TriangleSlots::replace(std::span<const CellId> scope, std::span<const DualTriangle> triangles, std::uint32_t cells) {
  if (cells > of_cell_.row_count()) of_cell_.add_rows(cells - of_cell_.row_count());
  std::vector<std::uint32_t> old;
  for (const CellId c : scope) {
    const auto row = of_cell_.row(c);
    old.insert(old.end(), row.begin(), row.end());
  }
  std::sort(old.begin(), old.end());
  old.erase(std::unique(old.begin(), old.end()), old.end());
  std::vector<std::uint8_t> stays(old.size(), 0);
  std::vector<DualTriangle> added;
  for (const DualTriangle& t : triangles) {
    bool found = false;
    for (const std::uint32_t slot : of_cell_.row(t.cell[0])) {
      if (!same_corners(slots_[slot].cell, t.cell)) continue;
      const auto at = std::lower_bound(old.begin(), old.end(), slot) - old.begin();
      found = !std::exchange(stays[static_cast<std::size_t>(at)], std::uint8_t{1});
      if (!found) continue;
      slots_[slot] = t;  // it may start at another corner, or be at another place of the surface
      break;
    }
    if (!found) added.push_back(t);
  }
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (!stays[i]) remove(old[i]);
  }
  for (const DualTriangle& t : added) add(t);
}

void TriangleSlots::add(const DualTriangle& triangle) {
  std::uint32_t slot;
  if (empty_.empty()) {
    slot = checked_id(slots_.size(), "triangles");
    slots_.push_back(triangle);
  } else {
    slot = empty_.back();
    empty_.pop_back();
    slots_[slot] = triangle;
  }
  for (const CellId c : triangle.cell) of_cell_.push_back(c, slot);
}

void TriangleSlots::remove(std::uint32_t slot) {
  for (const CellId c : slots_[slot].cell) of_cell_.erase(c, slot);
  slots_[slot] = {{kNone, kNone, kNone}, kNone};
  empty_.push_back(slot);
}

}  // namespace isoatlas
