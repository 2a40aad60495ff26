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

/// The dual of a covering, kept certified while the covering changes: where a check fails, sites are added that mend it.
/// Always ends: where every c-vertex is a site the dual is the complex itself, which is simplicial.
class CertifiedDual {
 public:
  CertifiedDual(const SurfaceComplex& complex, Covering& covering) : complex_(complex), covering_(covering) {}
  /// A copy for a copy of the covering.
  CertifiedDual(const CertifiedDual& other, Covering& covering);

  /// The complex has more c-vertices, faces are others at some, and sites may be elsewhere: the next update() looks there, too.
  /// @param changed  per c-vertex of the complex as it is now, 1 if it is elsewhere or its row in G is not what it was
  void continue_on(std::span<const std::uint8_t> changed);

  /// The covering has no more than these sites: the last ones were removed.
  void remove_cells(std::uint32_t count);

  /// Checks all that changed since the last call, and repairs.
  /// @cost   what is around the changed c-vertices; the first time O(C)
  /// @throws Error(internal) if a round of repair adds nothing, which would be a bug
  void update(CertificateReport& report, const RunControl& control);

  /// update(), then a look at everything: the certificate.
  void certify(CertificateReport& report, const RunControl& control);

  /// Those of the last check; see DualTriangles for their numbers.
  const std::vector<DualTriangle>& triangles() const { return triangles_.list(); }

  /// Per cell, 1 if its c-vertices or triangles may be others than at the last call of forget_touched().
  const std::vector<std::uint8_t>& touched() const { return touched_; }
  /// The cells that share a face with one of the c-vertices count as touched.
  void touch_near(std::span<const CVertexId> c_vertices, const RunControl& control);
  void forget_touched() { touched_.assign(touched_.size(), 0); }

 private:
  void check_and_repair(std::vector<CellId> scope, CertificateReport& report, const RunControl& control);
  PartitionCheck check(std::span<const CellId> scope, const RunControl& control);
  void take_triangles(std::span<const CellId> scope, PartitionCheck& check, const RunControl& control);
  std::vector<CVertexId> find_fixes(const PartitionCheck& check);
  std::vector<CellId> cells_near_changes(const RunControl& control);
  const ComplexAdjacency& adjacency(const RunControl& control);
  bool is_what_a_full_check_finds();

  const SurfaceComplex& complex_;
  Covering& covering_;
  std::shared_ptr<const ComplexAdjacency> adjacency_;  // once something was checked locally
  std::vector<CVertexId> other_faces_;                 // c-vertices whose faces are others than those that were checked
  std::vector<Vec3> site_points_;                      // between which quads with four cells were split at the shorter diagonal
  ScopedCheck scoped_;
  DualTriangles triangles_;
  std::vector<std::uint8_t> touched_;
  bool fresh_ = true;      // nothing was checked yet
  bool complete_ = false;  // the last check that passed was of everything
};

}  // namespace isoatlas::detail
