// SPDX-License-Identifier: Apache-2.0
// Volumes in the forms that common programs write: tests/data/field, whose README.md describes each
// of them.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::test {

inline std::filesystem::path field_file(const std::string& name) {
  return std::filesystem::path(ISOATLAS_FIELD_DATA) / name;
}

inline double sample_as_double(const VolumeView& volume, std::size_t index) {
  const auto value = [&](auto zero) {
    std::memcpy(&zero, static_cast<const char*>(volume.samples) + index * sizeof zero, sizeof zero);
    return static_cast<double>(zero);
  };
  switch (volume.type) {
    case SampleType::int8:
      return value(std::int8_t{});
    case SampleType::uint8:
      return value(std::uint8_t{});
    case SampleType::int16:
      return value(std::int16_t{});
    case SampleType::uint16:
      return value(std::uint16_t{});
    case SampleType::int32:
      return value(std::int32_t{});
    case SampleType::uint32:
      return value(std::uint32_t{});
    case SampleType::int64:
      return value(std::int64_t{});
    case SampleType::uint64:
      return value(std::uint64_t{});
    case SampleType::float32:
      return value(float{});
    case SampleType::float64:
      return value(double{});
  }
  return 0;
}

inline std::vector<double> samples_as_double(const VolumeView& volume) {
  std::vector<double> values(volume.grid.sample_count());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = sample_as_double(volume, i);
  return values;
}

inline void expect_size_and_spacing(const VolumeView& volume, std::array<std::size_t, 3> size,
                                    Vec3 spacing, double tolerance = 1e-6) {
  EXPECT_EQ(volume.grid.size, size);
  EXPECT_NEAR(volume.grid.spacing.x, spacing.x, tolerance);
  EXPECT_NEAR(volume.grid.spacing.y, spacing.y, tolerance);
  EXPECT_NEAR(volume.grid.spacing.z, spacing.z, tolerance);
}

/// The content of all field volumes that hold floats: positive inside a pair of ellipsoids.
inline std::vector<double> field_samples() {
  return samples_as_double(read_volume(field_file("n_nifti2.nii")));
}

}  // namespace isoatlas::detail::test
