// SPDX-License-Identifier: Apache-2.0
// Selects the DICOM files to read and reports the files that are skipped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

/// The usable frames of all files in a folder and its subfolders. Skipped files are listed in
/// `warnings`, by reason.
/// @throws Error if there are no usable frames, if a file is lost (empty, unreadable), or if an
/// image of a series cannot be a slice
std::vector<DicomFrame> frames_of_folder(const std::filesystem::path& folder,
                                         std::uint64_t max_memory,
                                         std::vector<std::string>& warnings);

/// The frames of a file. If the file has one frame, also those of the other files of its series in
/// the same folder.
std::vector<DicomFrame> frames_of_file(const std::filesystem::path& file, std::uint64_t max_memory,
                                       std::vector<std::string>& warnings);

}  // namespace isoatlas::detail::io
