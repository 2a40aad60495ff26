// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::io {

/// Throws Error(bad_file) if a DICOM file ends before its data elements do. GDCM reads such a file without complaint, so
/// that half a slice becomes half a slice of zeros, or leaves it out of its series, so that a slice is missing.
///
/// Walks over the lengths of the data elements as far as the pixel data. Says nothing about what it cannot walk over:
/// files without the DICM mark, deflated or big-endian data sets, all of which are rare, and files that are no DICOM.
void require_whole_dicom_file(const std::filesystem::path& path);

}  // namespace isoatlas::io
