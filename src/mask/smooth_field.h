// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"
#include "mask/band.h"

namespace isoatlas::detail {

/// The field of least squared second differences, weighted by spacing, that is at least `margin`
/// from zero on the side of each band sample, and the signed distance where the band is fixed.
///
/// Based on: Lempitsky (CVPR 2010); accelerated projected gradient with restarts (O'Donoghue and
/// Candes, 2015).
///
/// @return per band sample, > 0 inside
/// @cost  O(n) per step, parallel; the same bytes for any number of threads
std::vector<float> smooth_field(const Band& band, const Grid& grid, const RunControl& control);

}  // namespace isoatlas::detail
