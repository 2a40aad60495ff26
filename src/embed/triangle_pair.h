// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "isoatlas/mesh.h"

namespace isoatlas {

/// Whether two triangles have a point in common beyond the convex hull of the corners they share, as self_intersections() has it.
/// Exact for all finite coordinates.
bool meet_beyond_shared(std::span<const Vec3> positions, const Triangle& a, const Triangle& b);

}  // namespace isoatlas
