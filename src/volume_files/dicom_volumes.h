// SPDX-License-Identifier: Apache-2.0
// Groups frames into volumes and determines the position of each volume.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

/// Frames sorted by their positions along their normal.
struct DicomStack {
  std::vector<DicomFrame> frames;
  Vec3 step;  ///< from slice to slice; not perpendicular to the slices if the CT gantry is tilted:
              ///< the grid is then sheared
  std::string problem;               ///< why the frames are not a volume; empty if they are one
  bool has_equal_positions = false;  ///< the problem is that several frames have the same position
};

DicomStack stack_of(std::vector<DicomFrame> frames);

/// One entry of the list of series: one volume, or several at the same positions (time points,
/// echoes).
struct DicomSeries {
  std::string part;  ///< distinguishes it from other entries of the same series; empty if it is the
                     ///< only entry
  std::vector<DicomStack> volumes;
  std::vector<std::string> volume_names;  ///< e.g. "echo 2"

  const DicomImage& image() const { return *volumes.front().frames.front().image; }
  std::string description() const;  ///< "series 3 Abdomen, CT, 16 slices of 512 x 512, UID 1.2.3"
};

/// Splits frames into series by the UID of their series and, within one, by differences that one
/// volume cannot have.
std::vector<DicomSeries> series_of(std::vector<DicomFrame> frames);

}  // namespace isoatlas::detail::io
