// SPDX-License-Identifier: Apache-2.0
#include "volume_files/itk_image.h"

#include <itkImageIOBase.h>

#include <algorithm>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "volume_files/grid_of_file.h"
#include "files/library_messages.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

SampleType sample_type_of(const itk::ImageIOBase& image_io, const fs::path& path) {
  using Component = itk::IOComponentEnum;
  const bool is_long_8_bytes = sizeof(long) == 8;
  switch (image_io.GetComponentType()) {
    case Component::CHAR:
      return SampleType::int8;
    case Component::UCHAR:
      return SampleType::uint8;
    case Component::SHORT:
      return SampleType::int16;
    case Component::USHORT:
      return SampleType::uint16;
    case Component::INT:
      return SampleType::int32;
    case Component::UINT:
      return SampleType::uint32;
    case Component::LONG:
      return is_long_8_bytes ? SampleType::int64 : SampleType::int32;
    case Component::ULONG:
      return is_long_8_bytes ? SampleType::uint64 : SampleType::uint32;
    case Component::LONGLONG:
      return SampleType::int64;
    case Component::ULONGLONG:
      return SampleType::uint64;
    case Component::FLOAT:
      return SampleType::float32;
    case Component::DOUBLE:
      return SampleType::float64;
    default:
      throw unsupported(path, "has samples of type " + itk::ImageIOBase::GetComponentTypeAsString(image_io.GetComponentType()) +
                                  ", expected integers of 8 to 64 bits, float or double");
  }
}

Vec3 cross(const Vec3& a, const Vec3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

}  // namespace

void translate_itk_errors(const fs::path& path, const std::function<void()>& read) {
  try {
    read();
  } catch (const itk::MemoryAllocationError&) {
    throw Error(ErrorCode::out_of_memory, one_line(path.string() + ": not enough memory"));
  } catch (const itk::ExceptionObject& error) {
    if (std::string_view(error.GetDescription()).find("orthonormal") != std::string_view::npos) {
      throw unsupported(path, "its axes are not perpendicular to each other (a sheared affine), expected a box-shaped grid");
    }
    throw bad_file(path, "cannot be read: " + short_message(error.GetDescription()));
  }
}

ImageHeader read_itk_header(itk::ImageIOBase& image_io, const fs::path& path, std::string_view format_name) {
  ImageHeader header;
  translate_itk_errors(path, [&] {
    if (!image_io.CanReadFile(path.c_str())) {
      throw bad_file(path, "is not a readable " + std::string(format_name));
    }
    image_io.SetFileName(path.string());
    image_io.ReadImageInformation();
  });

  const unsigned dimensions = image_io.GetNumberOfDimensions();
  std::string shape;
  bool is_volume = dimensions >= 2;
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    shape += (axis > 0 ? " x " : "") + std::to_string(image_io.GetDimensions(axis));
    is_volume = is_volume && (axis < 3 || image_io.GetDimensions(axis) == 1);  // a series of one volume is a volume
  }
  if (!is_volume) {
    throw unsupported(path, "has " + std::to_string(dimensions) + " dimensions (" + shape + "), expected 3");
  }
  if (image_io.GetNumberOfComponents() != 1) {
    throw unsupported(
        path, "has " + std::to_string(image_io.GetNumberOfComponents()) + " values per sample (colour, vector or complex), expected one");
  }
  header.type = sample_type_of(image_io, path);

  const std::array<double*, 3> spacing{&header.spacing.x, &header.spacing.y, &header.spacing.z};
  const std::array<double*, 3> origin{&header.origin.x, &header.origin.y, &header.origin.z};
  header.size = {1, 1, 1};
  for (unsigned axis = 0; axis < std::min(dimensions, 3U); ++axis) {
    header.size[axis] = image_io.GetDimensions(axis);
    *spacing[axis] = image_io.GetSpacing(axis);
    *origin[axis] = image_io.GetOrigin(axis);
    const std::vector<double> direction = image_io.GetDirection(axis);
    header.axes[axis] = {direction[0], direction[1], dimensions > 2 ? direction[2] : 0.0};
  }
  if (dimensions == 2) {
    header.axes[2] = cross(header.axes[0], header.axes[1]);
  }
  return header;
}

void read_itk_samples(itk::ImageIOBase& image_io, const fs::path& path, void* samples) {
  translate_itk_errors(path, [&] {
    itk::ImageIORegion region(image_io.GetNumberOfDimensions());
    for (unsigned axis = 0; axis < image_io.GetNumberOfDimensions(); ++axis) {
      region.SetSize(axis, image_io.GetDimensions(axis));
    }
    image_io.SetIORegion(region);
    image_io.Read(samples);
  });
}

Volume read_itk_volume(itk::ImageIOBase& image_io, const fs::path& path, std::string_view format_name,
                       const std::function<void(const ImageHeader&)>& check_stored_data, const ReadOptions& options) {
  const ImageHeader header = read_itk_header(image_io, path, format_name);
  const std::uint64_t bytes = checked_sample_bytes(path, header.size, bytes_per_sample(header.type));
  Volume volume;
  volume.grid = grid_of_file(path, header.size, header.spacing, header.origin, header.axes);
  volume.type = header.type;
  check_stored_data(header);
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  read_itk_samples(image_io, path, samples.get());
  volume.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace isoatlas::io
