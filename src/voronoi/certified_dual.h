// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "complex/certificate.h"
#include "complex/dual_triangles.h"
#include "complex/scoped_check.h"
#include "voronoi/covering.h"

namespace isoatlas::detail {

/// The dual of a covering, kept certified while the covering changes: where a check fails, sites
/// are inserted that repair the fault. Always ends: if every c-vertex is a site, the dual is the
/// complex itself, which is simplicial.
class CertifiedDual {
 public:
  CertifiedDual(const SurfaceComplex& complex, Covering& covering)
      : complex_(complex), covering_(covering) {}
  /// Copies the state for a copy of the covering.
  CertifiedDual(const CertifiedDual& other, Covering& covering);

  /// Adapts to a complex that has more c-vertices, other faces at some of them, and possibly other
  /// sites: the next update() checks these places as well.
  /// @param changed  per c-vertex of the new complex, 1 if it has moved or its row in G has changed
  void adapt_to(std::span<const std::uint8_t> changed);

  /// To be called after Covering::remove_sites(count).
  void remove_cells(std::uint32_t count);

  /// Checks everything that changed since the last call, and repairs faults.
  /// @cost   the neighbourhood of the changed c-vertices; O(C) for the first call
  /// @throws Error(internal) if a round of repair inserts no site, which would be a bug
  void update(CertificateReport& report, const RunControl& control);

  /// update(), then a complete check: the certificate.
  void certify(CertificateReport& report, const RunControl& control);

  /// The dual triangles of the last check; see DualTriangles for their numbering.
  const std::vector<DualTriangle>& triangles() const { return triangles_.list(); }

  /// Per cell, 1 if its c-vertices or triangles may have changed since the last clear_touched().
  const std::vector<std::uint8_t>& touched() const { return touched_; }
  /// Marks the cells that share a face with one of the c-vertices as touched.
  void mark_touched_near(std::span<const CVertexId> c_vertices, const RunControl& control);
  void clear_touched() { touched_.assign(touched_.size(), 0); }

 private:
  void check_and_repair(std::vector<CellId> scope, CertificateReport& report,
                        const RunControl& control);
  PartitionCheck check(std::span<const CellId> scope, const RunControl& control);
  void store_triangles(std::span<const CellId> scope, PartitionCheck& check,
                       const RunControl& control);
  std::vector<CVertexId> find_fixes(const PartitionCheck& check);
  std::vector<CellId> cells_near_changes(const RunControl& control);
  const ComplexAdjacency& adjacency(const RunControl& control);
  bool matches_complete_check();

  const SurfaceComplex& complex_;
  Covering& covering_;
  std::shared_ptr<const ComplexAdjacency> adjacency_;  // made by the first local check
  std::vector<CVertexId>
      changed_c_vertices_;            // c-vertices whose faces have changed since they were checked
  std::vector<Vec3> site_positions_;  // per site, its position when quads with four cells were
                                      // split along the shorter diagonal
  ScopedCheck scoped_;
  DualTriangles triangles_;
  std::vector<std::uint8_t> touched_;
  bool nothing_checked_ = true;  // nothing was checked yet
  bool all_checked_ = false;     // the last check that passed was of all cells
};

}  // namespace isoatlas::detail
