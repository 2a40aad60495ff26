// SPDX-License-Identifier: Apache-2.0
// The meaning of the pages of a TIFF file according to its description, for every program that
// writes one.
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

/// World value = slope * stored value + intercept.
struct LinearRescale {
  double slope = 1, intercept = 0;
  friend bool operator==(const LinearRescale&, const LinearRescale&) = default;
};

/// Pages as channels x slices x times. A page may hold several channels, as the values of its
/// samples.
struct TiffStack {
  std::string format = "TIFF";  ///< for VolumeSource
  std::size_t channels = 1, slices = 1, times = 1;
  std::vector<std::string> channel_names =
      {};  ///< empty, or one for each channel, including channels within a page
  /// The page of a channel, slice and time, all counted from 0. Throws Error if the file has no
  /// such page.
  std::function<std::size_t(std::size_t channel, std::size_t slice, std::size_t time)> page_of = {};
  bool is_contiguous =
      false;  ///< one page has a directory; the samples of the others follow its samples

  std::array<std::optional<double>, 3> spacing = {};  ///< along x, y and z; empty if not stated
  Vec3 origin = {};
  LengthUnit unit = LengthUnit::unknown;
  std::optional<LinearRescale> rescale = {};
};

/// Sets the order of the pages: `axes` is a permutation of "CZT", fastest first; `pages` maps an
/// index in that order to a page.
void set_page_order(TiffStack& stack, const std::string& axes, std::vector<std::size_t> pages);

// Each returns the stack by its kind of description, or nothing if the file has no such
// description. The current page is the first page before the call, and a page of the stack after
// it. They select a series if there are several, and add their decisions and warnings to `source`.
std::optional<TiffStack> describe_ome(TiffFile& tiff, const ReadOptions& options,
                                      VolumeSource& source);
std::optional<TiffStack> describe_imagej(TiffFile& tiff, VolumeSource& source);
std::optional<TiffStack> describe_scifio(TiffFile& tiff, VolumeSource& source);
std::optional<TiffStack> describe_lsm(TiffFile& tiff, VolumeSource& source);

/// By tifffile's JSON; without it, the pages are slices.
TiffStack describe_pages(TiffFile& tiff, const ReadOptions& options, VolumeSource& source);

/// For a file that is one slice of several: the lengths and the rescaling that ImageJ's description
/// in the current page states.
/// @throws Error(unsupported) if more images follow the page
TiffStack describe_slice(TiffFile& tiff, VolumeSource& source);

/// The pages that are not previews or masks of others, from 0. Calls `at_page` with the index of
/// each in the result while it is the current page.
/// @throws Error(unsupported) if all pages are previews or masks
std::vector<std::size_t> pages_without_previews(
    TiffFile& tiff, VolumeSource& source,
    const std::function<void(std::size_t index)>& at_page = {});

}  // namespace isoatlas::detail::io
