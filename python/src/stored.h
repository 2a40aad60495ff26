// SPDX-License-Identifier: Apache-2.0
// Meshes and facts about files as bytes, for pickle and copy.deepcopy.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "isoatlas/volume_source.h"
#include "levels.h"

namespace isoatlas::detail::python {

/// All data of the levels, with their report. The same levels give the same bytes.
/// @cost O(V + T) time and memory
std::string stored(const Levels& levels);
std::string stored(const VolumeSource& source);

/// The inverse of stored().
/// @throws Error(bad_argument) if the bytes are incomplete, or come from another version of
/// isoatlas
std::shared_ptr<Levels> levels_from(std::string_view bytes);
VolumeSource volume_source_from(std::string_view bytes);

}  // namespace isoatlas::detail::python
