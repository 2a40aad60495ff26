// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/partition.h"
#include "isoatlas/certificate.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The faults of one cell, as bits.
enum CellFault : std::uint8_t {
  kNotConnected = 1,  ///< several components, connected by neither sides nor chosen diagonals
  kNotADisk = 2,      ///< V - E + F of the cell is not 1
  kNoTriangle = 4,    ///< no dual triangle has the cell as a corner
  kBadBoundary =
      8,  ///< touches the boundary, but not in one arc, or its site is not on the boundary
};

/// Two adjacent cells that do not share exactly one arc with a dual triangle at one end, or whose
/// arc has the same third cell at both ends.
struct PairFault {
  CellId a, b;  ///< a < b
};

struct FaultyCell {
  CellId cell;
  std::uint8_t fault;  ///< bits of CellFault
};

struct PartitionCheck {
  std::vector<DualTriangle> triangles;   ///< of the dual, in the order of the faces
  std::vector<FaultyCell> faulty_cells;  ///< sorted by cell
  std::vector<PairFault> pair_faults;    ///< sorted
  std::size_t cells = 0, pairs = 0;      ///< number of cells and pairs that were checked
  bool passed() const { return faulty_cells.empty() && pair_faults.empty(); }
  std::uint8_t fault_of(CellId cell) const;  ///< bits of CellFault; O(log)
};

/// One end of an arc between two cells.
struct ArcEnd {
  CellId low, high;  ///< the two cells, low < high
  CellId third;      ///< the third cell of the dual triangle there; kNone at the boundary
};

/// Adds the number of arcs to the check, and the pairs of cells whose arcs are faulty.
/// @param ends  grouped by pair of cells
/// @param is_wanted  whether a pair of cells is to be checked
template <class IsWanted>
void check_pairs(std::span<const ArcEnd> ends, IsWanted is_wanted, PartitionCheck& check) {
  // Every arc must have two ends, at least one of them a triangle, and not the same third cell at
  // both.
  for (std::size_t i = 0, j; i < ends.size(); i = j) {
    j = i;
    while (j < ends.size() && ends[j].low == ends[i].low && ends[j].high == ends[i].high) ++j;
    if (!is_wanted(ends[i].low, ends[i].high)) continue;
    ++check.pairs;
    const bool good =
        j - i == 2 &&
        ends[i].third != ends[i + 1].third;  // two boundary ends have equal thirds, kNone
    if (!good) check.pair_faults.push_back({ends[i].low, ends[i].high});
  }
}

/// The closed ball property of a partition, checked cell by cell, pair by pair and triple by
/// triple. If it passes, the dual is a simplicial 2-manifold with boundary, homeomorphic to the
/// complex; docs/theory/02-certificate.md has the proof.
///
/// @param cell_of per c-vertex, < cells; cells without c-vertices are skipped
/// @param site    per cell, its site; empty: sites are not checked, and ABCD is split along the
///                face's own shorter diagonal
/// @param scope   per cell, 1 if it is to be checked; empty: all, and only this is a certificate.
///                Arcs and triples are checked if one of their cells is in the scope, and
///                `triangles` has those with such a corner. ScopedCheck is faster for small scopes.
/// @cost  O(C α(C)); floating point is only used to choose the diagonals of quads with four cells,
///        where either is valid
/// @source Edelsbrunner and Shah 1997; paper, section 3.6
PartitionCheck check_partition(const SurfaceComplex& complex, std::span<const CellId> cell_of,
                               std::uint32_t cells, std::span<const CVertexId> site,
                               std::span<const std::uint8_t> scope = {},
                               const RunControl& control = {});

/// Fills in the counts of a check and whether it passed.
void fill_report(const PartitionCheck& check, CertificateReport& report);

}  // namespace isoatlas::detail
