// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/slack_rows.h"
#include "partition/partition.h"

namespace isoatlas {

/// The triangles of a dual that changes. Each is in a slot as long as it exists; slots of removed triangles are used again.
class TriangleSlots {
 public:
  TriangleSlots() = default;
  TriangleSlots(std::vector<DualTriangle> triangles, std::uint32_t cells);

  /// Empty slots have no cells: their corners are kNone.
  std::span<const DualTriangle> slots() const { return slots_; }
  /// The slots of the triangles with a corner in a cell.
  std::span<const std::uint32_t> of_cell(CellId cell) const { return of_cell_.row(cell); }
  std::size_t triangle_count() const { return slots_.size() - empty_.size(); }
  std::vector<DualTriangle> triangles() const;  ///< without the empty slots; O(slots)

  /// Replaces all triangles with a corner in a cell of `scope` by `triangles`. Those that are the same keep their slots.
  /// @param cells  how many cells there are now
  void replace(std::span<const CellId> scope, std::span<const DualTriangle> triangles, std::uint32_t cells);

 private:
  void add(const DualTriangle& triangle);
  void remove(std::uint32_t slot);

  std::vector<DualTriangle> slots_;
  std::vector<std::uint32_t> empty_;
  SlackRows<std::uint32_t> of_cell_;
};

}  // namespace isoatlas
