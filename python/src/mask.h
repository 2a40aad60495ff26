// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "array_volume.h"

namespace isoatlas::detail::python {

/// The field of mask_field() around the samples with one of these labels.
/// @param connectivity  "18", "6" or "field"
/// @return float32, with the shape of the array and its order in memory
/// @throws as mask_of_labels() and mask_field(); Error(bad_argument) for another connectivity
py::array mask_field_of(const ArrayVolume& labels, const std::vector<std::int64_t>& wanted,
                        const std::string& connectivity, int threads, const py::object& progress);

}  // namespace isoatlas::detail::python
