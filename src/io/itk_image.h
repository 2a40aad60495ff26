// SPDX-License-Identifier: Apache-2.0
// The part of reading through ITK that files and DICOM series share.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "isoatlas/volume.h"

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
};

/// @param format_name  for messages, e.g. "NRRD file"
ImageHeader read_image_header(itk::ImageIOBase& image_io, const std::filesystem::path& path, std::string_view format_name);

/// Reads the samples of `header`'s file to `samples`, which has room for all of them.
void read_image_samples(itk::ImageIOBase& image_io, const std::filesystem::path& path, void* samples);

/// Runs `read` and turns what ITK throws into one line about `path`.
void translate_itk_errors(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace isoatlas::io
