// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::detail::io {

/// True if the folder has files with the extension of TIFF or PNG and no DICOM files. Subfolders
/// are ignored.
bool is_image_stack(const std::filesystem::path& folder);

}  // namespace isoatlas::detail::io
