// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "isoatlas/volume.h"
#include "volume/classify.h"

namespace isoatlas {

/// World-space direction from inside to outside at points on the isosurface: minus the gradient of the trilinear interpolant,
/// in scaled coordinates (spacing applied, axes not turned).
/// @param points sample-index coordinates, within the volume
/// @return per point, of any length; zero where the field is flat
std::vector<Vec3> outward_directions(const VolumeView& volume, const InsideRule& rule, std::span<const Vec3> points);

}  // namespace isoatlas
