// SPDX-License-Identifier: Apache-2.0
// What a TIFF file's description says of its pages, whichever program wrote it.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/length_unit.h"
#include "isoatlas/volume_file.h"
#include "volume_files/tiff_file.h"

namespace isoatlas::detail::io {

/// Value in the world = slope * stored value + intercept.
struct LinearRescale {
  double slope = 1, intercept = 0;
  friend bool operator==(const LinearRescale&, const LinearRescale&) = default;
};

/// Pages as channels x slices x times. A page may hold several channels, the values of its samples.
struct TiffStack {
  std::string format = "TIFF";  ///< for VolumeSource
  std::size_t channels = 1, slices = 1, times = 1;
  std::vector<std::string> channel_names =
      {};  ///< empty, or one for each channel, those within a page counted too
  /// The page of a channel, slice and time, all from 0. Throws Error if the file has no such page.
  std::function<std::size_t(std::size_t channel, std::size_t slice, std::size_t time)> page_of = {};
  bool is_contiguous =
      false;  ///< one page stands for all: their samples follow its own without directories

  std::array<std::optional<double>, 3> spacing = {};  ///< along x, y and z; none: not stated
  Vec3 origin = {};
  LengthUnit unit = LengthUnit::unknown;
  std::optional<LinearRescale> rescale = {};
};

/// Pages in the order of `axes`, fastest first, a permutation of "CZT"; `pages` maps a place in
/// that order to a page.
void set_page_order(TiffStack& stack, const std::string& axes, std::vector<std::size_t> pages);

// Each describes the file by its kind of description, or returns nothing if it has none of that
// kind. The current page is the first one before; after, it is a page of the stack. They take the
// choice of a series, and add to `source` what they decide and warn of.
std::optional<TiffStack> describe_ome(TiffFile& tiff, const ReadOptions& options,
                                      VolumeSource& source);
std::optional<TiffStack> describe_imagej(TiffFile& tiff, VolumeSource& source);
std::optional<TiffStack> describe_scifio(TiffFile& tiff, VolumeSource& source);
std::optional<TiffStack> describe_lsm(TiffFile& tiff, VolumeSource& source);

/// By tifffile's JSON, or pages that are slices.
TiffStack describe_pages(TiffFile& tiff, const ReadOptions& options, VolumeSource& source);

/// The lengths and the rescale that ImageJ's description in the current page states, for a file
/// that is one slice of several.
/// @throws Error(unsupported) if further images are behind the page
TiffStack describe_slice(TiffFile& tiff, VolumeSource& source);

/// Pages that are no previews or masks of others, from 0. `at_page` is called with each, by its
/// place in the result, while it is the current one.
/// @throws Error(unsupported) if there is none
std::vector<std::size_t> pages_without_previews(
    TiffFile& tiff, VolumeSource& source,
    const std::function<void(std::size_t place)>& at_page = {});

}  // namespace isoatlas::detail::io
