// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace isoatlas::detail::io {

struct TiffDirectory {
  std::uint64_t offset = 0;
  std::uint32_t predictor =
      1;  ///< PREDICTOR_...; libtiff does not report it if it cannot undo it for the compression
};

/// The directories of a TIFF or BigTIFF file, one per page, in the order of the chain.
///
/// libtiff is not used for this: it takes a link that is cut off for the end of the chain.
///
/// @throws Error(bad_file) if a directory is not completely in the file, or the chain returns to an
/// earlier one
/// @cost one short read per page
std::vector<TiffDirectory> tiff_directories(const std::filesystem::path& path,
                                            std::uint64_t file_size);

}  // namespace isoatlas::detail::io
