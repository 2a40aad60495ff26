// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/cell_members.h"
#include "complex/certificate.h"
#include "complex/complex_adjacency.h"
#include "core/epoch_set.h"

namespace isoatlas::detail {

/// check_partition() for some cells only. For few cells the cost depends on the faces around them,
/// not on the size of the complex. Use one object for many checks: it keeps its scratch memory.
class ScopedCheck {
 public:
  /// @param scope  the cells to check, each once; arcs and triples are checked if one of their
  ///               cells is in the scope, and `triangles` of the result are those with such a
  ///               corner
  PartitionCheck run(const SurfaceComplex& complex, const ComplexAdjacency& adjacency,
                     std::span<const CellId> cell_of, const CellMembers& members,
                     std::span<const CVertexId> site, std::span<const CellId> scope,
                     const RunControl& control = {});

  /// The cells that may have become faulty or correct because of a change of the partition: all
  /// that share a face with a changed c-vertex. Sorted.
  /// @cost  the faces around the changed c-vertices
  std::vector<CellId> cells_near(const SurfaceComplex& complex, const ComplexAdjacency& adjacency,
                                 std::span<const CellId> cell_of,
                                 std::span<const CVertexId> changed,
                                 const RunControl& control = {});

 private:
  struct CellCount {
    std::int64_t twice_euler = 0;
    int boundary_ends = 0;
    std::uint32_t arc_ends = 0;
    bool has_triangle = false, touches_boundary = false;
  };
  class Run;

  EpochSet in_scope_;                // cells
  EpochSet seen_;                    // faces
  std::vector<std::uint32_t> slot_;  // per cell in scope, its index in counts_
  std::vector<CellCount> counts_;
  std::vector<CVertexId> parent_;  // per c-vertex of a cell in scope, union-find
  std::vector<ArcEnd> ends_, sorted_ends_;
};

}  // namespace isoatlas::detail
