// SPDX-License-Identifier: Apache-2.0
// The samples of DICOM frames: their type, and reading them slice by slice into a volume.
#pragma once

#include <cstddef>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

/// The type that holds all samples after rescaling. Without rescaling it is the stored type. With
/// integer slopes and intercepts it is the smallest integer type for every value that the stored
/// bits can have; with fractions it is float64.
SampleType dicom_sample_type(const std::vector<DicomFrame>& frames);

/// Reads the frames in order into `samples`, which has room for all of them. One frame at a time is
/// in memory twice.
void read_dicom_samples(const std::vector<DicomFrame>& frames, SampleType type,
                        std::uint64_t max_memory, std::byte* samples);

}  // namespace isoatlas::detail::io
