// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "cover/covering.h"
#include "partition/certificate.h"

namespace isoatlas {

/// The dual of a covering, kept certified while the covering changes: where a check fails, sites are added that mend it.
/// Always ends: where every c-vertex is a site the dual is the complex itself, which is simplicial.
class CertifiedDual {
 public:
  CertifiedDual(const SurfaceComplex& complex, Covering& covering) : complex_(complex), covering_(covering) {}
  /// A copy for a copy of the covering.
  CertifiedDual(const CertifiedDual& other, Covering& covering)
      : complex_(other.complex_),
        covering_(covering),
        triangles_(other.triangles_),
        touched_(other.touched_),
        fresh_(other.fresh_),
        complete_(other.complete_) {}

  /// Takes over the other's state, whose covering this one's has taken over.
  void assign(const CertifiedDual& other) {
    triangles_ = other.triangles_;
    touched_ = other.touched_;
    fresh_ = other.fresh_;
    complete_ = other.complete_;
  }

  /// Checks all that changed since the last call, and repairs. O(C) with a small constant, plus the changed cells.
  /// @throws Error(internal) if a round of repair adds nothing, which would be a bug
  void update(CertificateReport& report, const RunControl& control);

  /// update(), then a look at everything: the certificate. Triangles are in the order of the faces after it.
  void certify(CertificateReport& report, const RunControl& control);

  const std::vector<DualTriangle>& triangles() const { return triangles_; }

  /// Per cell, 1 if its c-vertices or triangles may be others than at the last call of forget_touched().
  const std::vector<std::uint8_t>& touched() const { return touched_; }
  void touch(std::vector<std::uint8_t> cells) { touched_ = std::move(cells); }  ///< per cell, 1 if it is to count as touched
  void forget_touched() { touched_.assign(touched_.size(), 0); }

 private:
  void check_and_repair(std::vector<std::uint8_t> scope, CertificateReport& report, const RunControl& control);

  const SurfaceComplex& complex_;
  Covering& covering_;
  std::vector<DualTriangle> triangles_;
  std::vector<std::uint8_t> touched_;
  bool fresh_ = true;      // nothing was checked yet
  bool complete_ = false;  // the last check that passed was of everything
};

}  // namespace isoatlas
