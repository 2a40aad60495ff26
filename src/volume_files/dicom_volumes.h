// SPDX-License-Identifier: Apache-2.0
// Which frames are a volume together, and where it lies in the world.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

/// Frames in the order of their places along their normal.
struct DicomStack {
  std::vector<DicomFrame> frames;
  Vec3 step;  ///< from slice to slice; need not be perpendicular to them: a CT with a tilted gantry
              ///< is a sheared grid
  std::string problem;           ///< why the frames are no volume; empty: they are one
  bool is_at_one_place = false;  ///< that is the problem: several frames at a place
};

DicomStack stack_of(std::vector<DicomFrame> frames);

/// One entry of the list of series: one volume, or several at the same places (time points,
/// echoes).
struct DicomSeries {
  std::string part;  ///< what tells it from another entry of the same series; empty: there is none
  std::vector<DicomStack> volumes;
  std::vector<std::string> volume_names;  ///< e.g. "echo 2"

  const DicomImage& image() const { return *volumes.front().frames.front().image; }
  std::string description() const;  ///< "series 3 Abdomen, CT, 16 slices of 512 x 512, UID 1.2.3"
};

/// Splits frames into series, by their series' UID and, within one, by what cannot be one volume.
std::vector<DicomSeries> series_of(std::vector<DicomFrame> frames);

}  // namespace isoatlas::detail::io
