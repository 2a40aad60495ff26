// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/partition.h"
#include "core/slack_rows.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The triangles of a dual that changes locally. A triangle that is not replaced keeps its id,
/// unless it was the last one and fills a gap.
class DualTriangles {
 public:
  DualTriangles() = default;
  DualTriangles(std::vector<DualTriangle> triangles, std::uint32_t cells);

  const std::vector<DualTriangle>& list() const { return list_; }
  /// The ids of the triangles with a corner in a cell.
  std::span<const std::uint32_t> of_cell(CellId cell) const { return of_cell_.row(cell); }

  /// Replaces all triangles with a corner in a cell of `scope` by `triangles`. Triangles in both
  /// sets are kept.
  /// @param cells  the number of cells now; triangles with a corner in a cell beyond are replaced
  ///               as well
  /// @cost  number of removed and added triangles, times its logarithm
  void replace(std::span<const CellId> scope, std::span<const DualTriangle> triangles,
               std::uint32_t cells, const RunControl& control = {});

 private:
  void add(const DualTriangle& triangle);
  void remove(std::uint32_t id);

  std::vector<DualTriangle> list_;
  SlackRows<std::uint32_t> of_cell_;
};

}  // namespace isoatlas::detail
