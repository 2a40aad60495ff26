// SPDX-License-Identifier: Apache-2.0
// Which DICOM files there are to read, and what is left out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

/// The usable frames of all files in a folder and its subfolders. What is left out is said in
/// `warnings`, by reason.
/// @throws Error if there are none, if a file is lost (empty, unreadable), or if one that belongs
/// to a series cannot be a slice
std::vector<DicomFrame> frames_of_folder(const std::filesystem::path& folder,
                                         std::uint64_t max_memory,
                                         std::vector<std::string>& warnings);

/// The frames of one file; of a file with one frame, those of its series in the same folder as
/// well.
std::vector<DicomFrame> frames_of_file(const std::filesystem::path& file, std::uint64_t max_memory,
                                       std::vector<std::string>& warnings);

}  // namespace isoatlas::detail::io
