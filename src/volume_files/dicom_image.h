// SPDX-License-Identifier: Apache-2.0
// One DICOM file with an image: the geometry and other attributes of each frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"
#include "volume_files/dicom_contents.h"

namespace isoatlas::detail::io {

/// How samples are stored, after decompression.
struct DicomSampleFormat {
  unsigned bits_allocated = 16;  ///< 1, 8, 16 or 32; 32 or 64 if `is_float`
  unsigned bits_stored = 16;
  unsigned high_bit = 15;  ///< index of the highest stored bit
  bool is_signed = false;
  bool is_float = false;

  bool operator==(const DicomSampleFormat&) const = default;
};

/// The attributes that all frames of a file share.
struct DicomImage {
  std::filesystem::path path;
  std::string name;  ///< path of the file relative to the folder that is read, for messages
  std::string series, series_number, description, modality, sop_class;
  std::string world;  ///< patient, study and frame of reference: positions are comparable only if
                      ///< all three agree
  std::int64_t instance_number = 0;
  bool is_localizer = false;
  std::size_t rows = 0, columns = 0, frames = 1;
  DicomSampleFormat format;
  DicomPixels pixels;
  std::string transfer_syntax;
  bool is_big_endian = false;
  bool is_lossy = false;
  std::string rescale_type;           ///< e.g. "HU"
  std::string dose_units;             ///< of a dose grid; empty if it is not a dose grid
  bool is_inverted_display = false;   ///< MONOCHROME1
  std::string padding;                ///< the pixel padding value, as a number; empty if not stated
  std::vector<std::string> warnings;  ///< issued if this image is read
  std::string position_source;  ///< the source of the frames' positions if the frames state none,
                                ///< e.g. an attribute's name
  std::string
      damage;  ///< why its samples cannot be read although its attributes can; empty if they can
};

/// An attribute that may distinguish the volumes of a series.
struct DicomLabel {
  enum class Kind {
    volume,  ///< the same in all slices of a volume: time point, echo, b-value
    time,    ///< distinguishes volumes at the same positions, but may also differ between slices of
             ///< a volume: acquisition, trigger time
    other,   ///< may differ between slices of a volume, and is not a time: kernel, thickness
  };
  std::string name;  ///< e.g. "echo"
  std::string value;
  Kind kind = Kind::time;
};

/// One slice of a volume.
struct DicomFrame {
  std::shared_ptr<const DicomImage> image;
  std::size_t number = 0;  ///< index in its file, from 0
  Vec3 position;           ///< of the first sample's centre
  Vec3 along_row,
      along_column;  ///< directions in which the column and row index increase, as in the file
  double spacing_x = 1, spacing_y = 1;
  double slope = 1, intercept = 0;
  std::string stack;  ///< frames of different stacks never form one volume
  std::shared_ptr<const std::vector<DicomLabel>> labels;

  std::string name()
      const;  ///< for messages: "IM012", "frame 3 of enh.dcm" (counted from 1, as DICOM does)
};

/// The frames of a file, or the reason why they are not usable.
struct DicomFileFrames {
  std::vector<DicomFrame> frames;
  std::string unusable;  ///< why its frames are not slices; then `frames` is empty
  bool is_image = true;  ///< has pixel data
  bool is_directory = false;
  std::string series;  ///< also set for unusable images
  std::size_t rows = 0, columns = 0;
  std::string modality;
};

/// @param name  of the file, for messages
/// @throws Error(bad_file) if the file is so damaged that its series is unknown
DicomFileFrames read_dicom_frames(const std::filesystem::path& path, const std::string& name,
                                  std::uint64_t max_memory);

/// Text of a file made fit for messages and JSON: valid UTF-8 on one line.
std::string dicom_text(const std::string& text);

/// A number with the digits that it needs: "2", "0.25".
std::string dicom_number(double value);

}  // namespace isoatlas::detail::io
