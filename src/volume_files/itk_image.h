// SPDX-License-Identifier: Apache-2.0
// Volumes through ITK's ImageIO classes, used directly: an itk::Image would fix the sample type at compile time and an
// itk::ImageFileReader would ask every registered format. Samples go straight from the file to our memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include "isoatlas/volume_file.h"

namespace itk {
class ImageIOBase;
}

namespace isoatlas::io {

/// What a file's header says, nothing checked but the number of dimensions and that samples are scalars.
/// A 2-D image has size[2] == 1 and the plane's normal as z axis.
struct ImageHeader {
  std::array<std::size_t, 3> size{};
  Vec3 spacing{1, 1, 1};
  Vec3 origin{};
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  SampleType type = SampleType::uint8;

  std::uint64_t sample_count() const { return std::uint64_t{size[0]} * size[1] * size[2]; }
};

/// The whole reading of one file.
///
/// @param format_name  for messages, e.g. "NRRD file"
/// @param check_stored_data  called with the header before memory is allocated and samples are read; throws if the
///                           file does not hold them
Volume read_itk_volume(itk::ImageIOBase& image_io, const std::filesystem::path& path, std::string_view format_name,
                       const std::function<void(const ImageHeader&)>& check_stored_data, const ReadOptions& options);

// The steps of it, for DICOM.
ImageHeader read_itk_header(itk::ImageIOBase& image_io, const std::filesystem::path& path, std::string_view format_name);
void read_itk_samples(itk::ImageIOBase& image_io, const std::filesystem::path& path, void* samples);

/// Runs `read` and turns what ITK throws into one line about `path`.
void translate_itk_errors(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace isoatlas::io
