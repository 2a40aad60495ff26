// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "isoatlas/mask_field.h"
#include "mask/band.h"

namespace isoatlas::detail {

/// Makes every ambiguous grid face join the side that the connectivity requires: where the field
/// decides otherwise, the two samples to be joined move away from zero, so that their product
/// exceeds that of the other two. Values only grow, so this ends.
/// @param field  per band sample; changed
/// @cost  O(n)
void repair_faces(const Band& band, MaskConnectivity connectivity, std::vector<float>& field,
                  const RunControl& control);

}  // namespace isoatlas::detail
