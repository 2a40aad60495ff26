// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::detail::io {

/// The folder has files that are TIFF or PNG by their names, and no DICOM files. Its subfolders are
/// not looked at.
bool is_image_stack(const std::filesystem::path& folder);

}  // namespace isoatlas::detail::io
