// SPDX-License-Identifier: Apache-2.0
// OME-NGFF 0.4 and 0.5: which arrays of a Zarr folder are an image, and their axes and lengths.
// https://ngff.openmicroscopy.org
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// An axis of an image, from slowest to fastest.
struct OmeAxis {
  std::string name, type;  ///< for example "z" and "space"; empty if they are not stated
  LengthUnit unit = LengthUnit::unknown;
  double scale = 1, translation = 0;
};

/// One resolution of an image.
struct OmeImageLevel {
  std::filesystem::path array;
  std::string version = {};  ///< of OME-NGFF; empty for an array of no image
  std::size_t level = 0, level_count = 1;
  std::vector<OmeAxis> axes = {};  ///< empty for an array of no image
  bool has_scale = false;          ///< whether the metadata states the distances between samples
  std::vector<std::string> channel_names = {};
};

/// The array that a path means: itself; or of an image that of the highest resolution; or of a
/// folder with one image that of this image. An array that belongs to an image has its axes.
/// @throws Error(unsupported) for a group without images, with several of them, or a plate; the
///         message lists what it contains
OmeImageLevel find_ome_level(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
