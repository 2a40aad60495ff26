// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace isoatlas {

/// The result of the certificate, the check of the closed ball property that proves the topology
/// of a mesh: how much was checked and how much repair was needed until the check passed. The
/// argument is in docs/theory/02-certificate.md. "Cell" means Voronoi cell: the c-vertices nearest
/// to one site.
struct CertificateReport {
  bool passed = false;
  /// Number of Voronoi cells. Each is a disk, has a triangle, and shares at most one arc with the
  /// surface's boundary.
  std::size_t cells_checked = 0;
  /// Number of pairs of adjacent Voronoi cells. Each pair shares exactly one arc.
  std::size_t arcs_checked = 0;
  /// Number of triples of adjacent Voronoi cells. Each triple shares exactly one point.
  std::size_t triples_checked = 0;
  std::size_t repair_rounds = 0;  ///< rounds of check and repair until the check passed
  std::size_t repair_sites = 0;   ///< sites added by repair
};

}  // namespace isoatlas
