// SPDX-License-Identifier: Apache-2.0
// One DICOM file with an image: what its attributes say of each frame.
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
  unsigned high_bit = 15;  ///< place of the highest stored bit
  bool is_signed = false;
  bool is_float = false;

  bool operator==(const DicomSampleFormat&) const = default;
};

/// What all frames of a file share.
struct DicomImage {
  std::filesystem::path path;
  std::string name;  ///< of the file below the folder that is read, for messages
  std::string series, series_number, description, modality, sop_class;
  std::string
      world;  ///< patient, study and frame of reference: positions in others have nothing in common
  std::int64_t instance_number = 0;
  bool is_localizer = false;
  std::size_t rows = 0, columns = 0, frames = 1;
  DicomSampleFormat format;
  DicomPixels pixels;
  std::string transfer_syntax;
  bool is_big_endian = false;
  bool is_lossy = false;
  std::string rescale_type;          ///< e.g. "HU"
  std::string dose_units;            ///< of a dose grid; empty: it is none
  bool is_inverted_display = false;  ///< MONOCHROME1
  std::string padding;               ///< the pixel padding value, as a number; empty: there is none
  std::vector<std::string> warnings;  ///< to be given if this image is read
  std::string frame_places;  ///< how positions of the frames follow, where frames have none of
                             ///< their own; e.g. an attribute's name
  std::string
      damage;  ///< why its samples cannot be read though its attributes can; empty: they can
};

/// An attribute that may tell several volumes of a series apart.
struct DicomLabel {
  enum class Kind {
    volume,  ///< the same in all slices of a volume: time point, echo, b-value
    time,  ///< of volumes at the same places, but slices of one volume may differ too: acquisition,
           ///< trigger time
    other,  ///< slices of one volume may differ; it is no time: kernel, thickness
  };
  std::string name;  ///< e.g. "echo"
  std::string value;
  Kind kind = Kind::time;
};

/// One slice of a volume.
struct DicomFrame {
  std::shared_ptr<const DicomImage> image;
  std::size_t number = 0;  ///< in its file, from 0
  Vec3 position;           ///< of the first sample's centre
  Vec3 along_row,
      along_column;  ///< direction in which columns and rows are counted, as in the file
  double spacing_x = 1, spacing_y = 1;
  double slope = 1, intercept = 0;
  std::string stack;  ///< frames of different stacks are no volume together
  std::shared_ptr<const std::vector<DicomLabel>> labels;

  std::string name()
      const;  ///< for messages: "IM012", "frame 3 of enh.dcm" (counted from 1, as DICOM does)
};

/// What a file is to a reader of volumes.
struct DicomFileFrames {
  std::vector<DicomFrame> frames;
  std::string unusable;  ///< why its frames are no slices; then `frames` is empty
  bool is_image = true;  ///< has pixel data
  bool is_directory = false;
  std::string series;  ///< known of unusable images too
  std::size_t rows = 0, columns = 0;
  std::string modality;
};

/// @param name  of the file for messages
/// @throws Error(bad_file) if the file is damaged so that not even its series is known
DicomFileFrames read_dicom_frames(const std::filesystem::path& path, const std::string& name,
                                  std::uint64_t max_memory);

/// Text of a file made fit for messages and JSON: valid UTF-8 on one line.
std::string dicom_text(const std::string& text);

/// A number as a person would write it: "2", "0.25".
std::string dicom_number(double value);

}  // namespace isoatlas::detail::io
