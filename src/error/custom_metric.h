// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/level_mesh.h"
#include "error/surfels.h"
#include "isoatlas/refine.h"

namespace isoatlas::detail {

/// The caller's metric of one cell. @throws Error(bad_argument) if it is NaN, and whatever the
/// caller's function throws
double custom_value(const CustomMetric& metric, const Surfels& surfels, const LevelMesh& mesh,
                    CellId cell);

/// Its maximum over all cells.
double custom_maximum(const CustomMetric& metric, const Surfels& surfels, const LevelMesh& mesh);

}  // namespace isoatlas::detail
