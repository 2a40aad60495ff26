// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace isoatlas {

/// What the certificate looked at, and what it took to pass (docs/theory/02-certificate.md).
struct CertificateReport {
  bool passed = false;
  std::size_t cells_checked =
      0;  ///< every one a disk, with a triangle, meeting the boundary in at most one arc
  std::size_t arcs_checked = 0;  ///< pairs of adjacent cells, every pair meeting in exactly one arc
  std::size_t triples_checked = 0;  ///< triples of cells, every triple meeting in exactly one point
  std::size_t repair_rounds = 0;    ///< rounds of check-and-repair until it passed
  std::size_t repair_sites = 0;     ///< sites added by repair
};

}  // namespace isoatlas
