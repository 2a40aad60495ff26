// SPDX-License-Identifier: Apache-2.0
// The volume that `isoatlas view` shows, as its page receives it.
#pragma once

#include <cstddef>
#include <string>

#include "arguments.h"
#include "isoatlas/volume_file.h"

namespace isoatlas::detail::tool {

/// The facts of GET volume: grid, histogram, suggested isovalues, first isovalue and side. JSON of
/// the schema "isoatlas-view-1".
/// @param file  all of it is shown
/// @cost  two passes over the samples
std::string describe_for_page(const ViewArguments& arguments, const VolumeFile& file);

/// The samples of a slice across an axis as float32, little-endian. The earlier of the two other
/// axes is the faster one.
/// @throws Error(bad_argument) if there is no such axis or slice
std::string slice_samples(const VolumeView& volume, std::size_t axis, std::size_t index);

}  // namespace isoatlas::detail::tool
