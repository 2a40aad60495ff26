// SPDX-License-Identifier: Apache-2.0
// Writes test volumes with the libraries that define the formats.
#pragma once

#include <itkImageIOBase.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail::test {

inline constexpr std::array kAllTypes{SampleType::int8,   SampleType::uint8,  SampleType::int16,
                                      SampleType::uint16, SampleType::int32,  SampleType::uint32,
                                      SampleType::int64,  SampleType::uint64, SampleType::float32,
                                      SampleType::float64};

/// Calls `use` with a value of the C++ type.
template <class Use>
void with_type(SampleType type, Use use) {
  switch (type) {
    case SampleType::int8:
      return use(std::int8_t{});
    case SampleType::uint8:
      return use(std::uint8_t{});
    case SampleType::int16:
      return use(std::int16_t{});
    case SampleType::uint16:
      return use(std::uint16_t{});
    case SampleType::int32:
      return use(std::int32_t{});
    case SampleType::uint32:
      return use(std::uint32_t{});
    case SampleType::int64:
      return use(std::int64_t{});
    case SampleType::uint64:
      return use(std::uint64_t{});
    case SampleType::float32:
      return use(float{});
    case SampleType::float64:
      return use(double{});
  }
}

/// A volume of 5 x 4 x 3 samples whose values use the whole range of the type, in a rotated grid
/// away from the origin.
struct TestVolume {
  Grid grid;
  SampleType type;
  std::string bytes;

  explicit TestVolume(SampleType sample_type) : type(sample_type) {
    grid.size = {5, 4, 3};
    grid.spacing = {0.5, 1.25, 3};
    grid.origin = {-10.5, 20, 300.25};
    const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
    grid.direction = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
    with_type(type, [&](auto zero) {
      using T = decltype(zero);
      for (std::size_t i = 0; i < grid.sample_count(); ++i) {
        const double fraction =
            static_cast<double>(i) / static_cast<double>(grid.sample_count() - 1);
        T value{};
        if constexpr (std::is_floating_point_v<T>) {
          value = static_cast<T>(1000 * fraction - 300.7);
        } else if (i == 1) {
          value = std::numeric_limits<T>::max();
        } else if (i == 2) {
          value = std::numeric_limits<T>::min();
        } else {
          value = static_cast<T>(100 * fraction);
        }
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    });
  }
};

inline itk::IOComponentEnum itk_component(SampleType type) {
  using Component = itk::IOComponentEnum;
  constexpr std::array kComponents{
      Component::CHAR, Component::UCHAR, Component::SHORT, Component::USHORT, Component::INT,
      Component::UINT, Component::LONG,  Component::ULONG, Component::FLOAT,  Component::DOUBLE};
  return kComponents[static_cast<std::size_t>(type)];
}

inline void write_with(itk::ImageIOBase& image_io, const std::filesystem::path& path,
                       const Grid& grid, SampleType type, const std::string& bytes,
                       bool compress = false) {
  image_io.SetNumberOfDimensions(3);
  const std::array<double, 3> spacing{grid.spacing.x, grid.spacing.y, grid.spacing.z};
  const std::array<double, 3> origin{grid.origin.x, grid.origin.y, grid.origin.z};
  itk::ImageIORegion region(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    image_io.SetDimensions(axis, grid.size[axis]);
    image_io.SetSpacing(axis, spacing[axis]);
    image_io.SetOrigin(axis, origin[axis]);
    const Vec3& d = grid.direction[axis];
    image_io.SetDirection(axis, std::vector<double>{d.x, d.y, d.z});
    region.SetSize(axis, grid.size[axis]);
  }
  image_io.SetNumberOfComponents(1);
  image_io.SetPixelType(itk::IOPixelEnum::SCALAR);
  image_io.SetComponentType(itk_component(type));
  image_io.SetIORegion(region);
  image_io.SetUseCompression(compress);
  image_io.SetFileName(path.string());
  image_io.WriteImageInformation();
  image_io.Write(bytes.data());
}

}  // namespace isoatlas::detail::test
