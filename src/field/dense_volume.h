// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The volume itself if its samples are x fastest and without gaps; else a copy that is. O(N) for a
/// copy.
/// @param owner  of the view's samples; kept where they are not copied
Volume dense_volume(const VolumeView& view, std::shared_ptr<const void> owner = nullptr);

}  // namespace isoatlas::detail
