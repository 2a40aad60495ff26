// SPDX-License-Identifier: Apache-2.0
// NumPy's .npy: every type, order and version that holds a volume; other and damaged files are
// refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"
#include "support/volume_bytes.h"

namespace isoatlas::detail::test {
namespace {

constexpr std::size_t kCount = 24;
constexpr std::array<std::size_t, 3> kSize{4, 3, 2};  // for an array of shape (2, 3, 4)

std::string dictionary(const std::string& descr, const std::string& shape = "(2, 3, 4)",
                       bool is_fortran_order = false) {
  return "{'descr': '" + descr + "', 'fortran_order': " + (is_fortran_order ? "True" : "False") +
         ", 'shape': " + shape + ", }";
}

std::string npy(const std::string& header, const std::string& samples, int version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  const std::string padded = header + std::string(20, ' ') + "\n";
  bytes.append(version == 1 ? 2 : 4, '\0');
  if (version == 1) put(bytes, 8, static_cast<std::uint16_t>(padded.size()), false);
  if (version != 1) put(bytes, 8, static_cast<std::uint32_t>(padded.size()), false);
  return bytes + padded + samples;
}

const std::string kBytes = bytes_of(ramp<std::uint8_t>(kCount));

class Npy : public testing::Test {
 protected:
  TempFolder folder_;

  VolumeFile read(const std::string& bytes, const ReadOptions& options = {}) {
    write_bytes(folder_ / "v.npy", bytes);
    return read_volume_file(folder_ / "v.npy", options);
  }
  void refuse(const std::string& bytes, ErrorCode code, const std::string& message) {
    SCOPED_TRACE(message);
    write_bytes(folder_ / "v.npy", bytes);
    expect_error(code, message, folder_ / "v.npy", [&] { read_volume(folder_ / "v.npy"); });
  }
  template <class T>
  void expect_type(const std::string& code, SampleType type) {
    std::vector<T> values = ramp<T>(kCount);
    values[1] = std::numeric_limits<T>::max();
    values[2] = std::numeric_limits<T>::lowest();
    const std::vector<double> expected(values.begin(), values.end());
    for (const char order : {'<', '>', '=', '|'}) {
      SCOPED_TRACE(order + code);
      if (order == '|' && sizeof(T) > 1) continue;
      for (const int version : {1, 2, 3}) {
        const VolumeFile file =
            read(npy(dictionary(order + code), bytes_of(values, order == '>'), version));
        EXPECT_EQ(file.volume.view.type, type);
        EXPECT_EQ(file.volume.view.grid.size, kSize);
        EXPECT_EQ(samples_as_double(file.volume), expected);
      }
      // The same array in the other order: a[z][y][x] has the value z + 2 (y + 3 x).
      std::vector<T> turned(kCount);
      for (std::size_t i = 0; i < kCount; ++i)
        turned[i / 12 + 2 * (i / 4 % 3 + 3 * (i % 4))] = values[i];
      const VolumeFile file =
          read(npy(dictionary(order + code, "(2, 3, 4)", true), bytes_of(turned, order == '>')));
      EXPECT_EQ(samples_as_double(file.volume), expected);
    }
  }
};

TEST_F(Npy, EveryTypeOrderAndVersion) {
  expect_type<std::int8_t>("i1", SampleType::int8);
  expect_type<std::uint8_t>("u1", SampleType::uint8);
  expect_type<std::int16_t>("i2", SampleType::int16);
  expect_type<std::uint16_t>("u2", SampleType::uint16);
  expect_type<std::int32_t>("i4", SampleType::int32);
  expect_type<std::uint32_t>("u4", SampleType::uint32);
  expect_type<std::int64_t>("i8", SampleType::int64);
  expect_type<std::uint64_t>("u8", SampleType::uint64);
  expect_type<float>("f4", SampleType::float32);
  expect_type<double>("f8", SampleType::float64);
}

// Larger than the part that is in memory twice.
TEST_F(Npy, LargeArraysInFortranOrder) {
  constexpr std::size_t kX = 259, kY = 200, kZ = 201;
  const auto value = [](std::size_t i) { return static_cast<std::uint16_t>(i * 7919); };
  std::vector<std::uint16_t> values(kX * kY * kZ);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(i);
  const std::string header = dictionary("<u2", "(201, 200, 259)", true);
  const VolumeFile file = read(npy(header, bytes_of(values)));
  ASSERT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{kX, kY, kZ}));
  const auto* const samples = static_cast<const std::uint16_t*>(file.volume.view.samples);
  std::size_t wrong = 0;
  for (std::size_t z = 0; z < kZ; ++z) {
    for (std::size_t y = 0; y < kY; ++y) {
      for (std::size_t x = 0; x < kX; ++x)
        wrong += samples[x + kX * (y + kY * z)] != value(z + kZ * (y + kY * x)) ? 1 : 0;
    }
  }
  EXPECT_EQ(wrong, 0U);
}

TEST_F(Npy, HalvesInFortranOrder) {
  std::vector<std::uint16_t> halves(kCount, 0x3C00);
  halves[1] = 0xC000;  // a[1][0][0]
  const VolumeFile file = read(npy(dictionary("<f2", "(2, 3, 4)", true), bytes_of(halves)));
  EXPECT_EQ(sample_as_double(file.volume, 12), -2);
  EXPECT_EQ(sample_as_double(file.volume, 1), 1);
}

TEST_F(Npy, StatesNoLengths) {
  const VolumeFile file = read(npy(dictionary("|u1"), kBytes));
  EXPECT_EQ(file.source.format, "NumPy array");
  EXPECT_FALSE(file.source.has_spacing);
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::unknown);
  expect_one_warning(file, "states no voxel size");
  EXPECT_TRUE(
      read(npy(dictionary("|u1"), kBytes), {.spacing = Vec3{1, 2, 3}}).source.warnings.empty());
}

TEST_F(Npy, BooleansAreBytes) {
  std::string values(kCount, '\0');
  values[5] = 1;
  const VolumeFile file = read(npy(dictionary("|b1"), values));
  EXPECT_EQ(file.volume.view.type, SampleType::uint8);
  EXPECT_EQ(sample_as_double(file.volume, 5), 1);
  EXPECT_EQ(sample_as_double(file.volume, 6), 0);
}

TEST_F(Npy, HalfPrecisionBecomesFloat) {
  // By IEEE 754: 1, -2, the largest, the smallest normal, the smallest and the largest subnormal,
  // -0, infinity, NaN.
  std::vector<std::uint16_t> halves{0x3C00, 0xC000, 0x7BFF, 0x0400, 0x0001, 0x03FF,
                                    0x8000, 0x7C00, 0xFC00, 0x7E00, 0x3555, 0x8001};
  halves.resize(kCount);
  const std::vector<double> expected{1,
                                     -2,
                                     65504,
                                     0x1p-14,
                                     0x1p-24,
                                     1023 * 0x1p-24,
                                     -0.0,
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN(),
                                     1365 * 0x1p-12,
                                     -0x1p-24};
  for (const bool big_endian : {false, true}) {
    const VolumeFile file =
        read(npy(dictionary(big_endian ? ">f2" : "<f2"), bytes_of(halves, big_endian)));
    ASSERT_EQ(file.volume.view.type, SampleType::float32);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double value = sample_as_double(file.volume, i);
      EXPECT_TRUE(value == expected[i] || (std::isnan(value) && std::isnan(expected[i])))
          << i << ": " << value;
      EXPECT_EQ(std::signbit(value), i == 9 ? std::signbit(value) : std::signbit(expected[i])) << i;
    }
  }
}

TEST_F(Npy, OtherTypesAreRefused) {
  for (const auto& [descr, kind] : std::vector<std::pair<std::string, std::string>>{
           {"<c8", "complex"},
           {"<f16", "extended floating-point"},
           {"|O", "Python objects, which are never unpickled"},
           {"<U5", "text"},
           {"|S3", "text"},
           {"|V8", "records"},
           {"<M8[ns]", "times"},
           {"", "an unknown type"},
           {"<i3", "an unknown type"}}) {
    refuse(npy(dictionary(descr), std::string(1000, '\0')), ErrorCode::unsupported, kind);
  }
  refuse(
      npy("{'descr': [('a', '<f4'), ('b', '<f4')], 'fortran_order': False, 'shape': (2, 3, 4), }",
          std::string(200, '\0')),
      ErrorCode::unsupported, "structured array");
}

TEST_F(Npy, ShapesOfOtherVolumes) {
  EXPECT_EQ(read(npy(dictionary("|u1", "(1, 2, 3, 4, 1)"), kBytes)).volume.view.grid.size, kSize);
  EXPECT_EQ(read(npy(dictionary("|u1", "(2L, 3L, 4L)"), kBytes)).volume.view.grid.size,
            kSize);  // Python 2
  refuse(npy(dictionary("|u1", "(2, 3, 2, 2)"), kBytes), ErrorCode::unsupported,
         "shape (2, 3, 2, 2), expected three axes (z, y, x); save");
  refuse(npy(dictionary("|u1", "(24,)"), kBytes), ErrorCode::unsupported,
         "shape (24,), expected three axes (z, y, x)");
  refuse(npy(dictionary("|u1", "()"), kBytes), ErrorCode::unsupported, "shape ()");
  refuse(npy(dictionary("|u1", "(1, 6, 4)"), kBytes), ErrorCode::unsupported, "4 x 6 x 1 samples");
  refuse(npy(dictionary("|u1", "(0, 6, 4)"), kBytes), ErrorCode::unsupported, "4 x 6 x 0 samples");
}

TEST_F(Npy, DictionariesInAnyOrderAndWithDoubleQuotes) {
  EXPECT_EQ(read(npy("{\"shape\":(2,3,4),\"descr\":\"|u1\",\"fortran_order\":False}", kBytes))
                .volume.view.grid.size,
            kSize);
}

TEST_F(Npy, DamagedHeadersAreRefused) {
  for (const std::string& header :
       {std::string("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3, 4)"),
        std::string("{'descr': '|u1', 'shape': (2, 3, 4)}"),
        std::string("{'descr': '|u1', 'fortran_order': 0, 'shape': (2, 3, 4)}"),
        std::string("{'descr': '|u1"), std::string(""), std::string("[]"),
        std::string("{'descr': '|u1', 'fortran_order': False, 'shape': (2, -3, 4)}"),
        std::string("{'descr': '|u1', 'fortran_order': False, 'shape': (2 3 4)}"),
        std::string(
            "{'descr': '|u1', 'fortran_order': False, 'shape': (99999999999999999999, 3, 4)}"),
        std::string("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3, 4), 'code': 'x'}"),
        std::string("{'descr': __import__('os'), 'fortran_order': False, 'shape': (2, 3, 4)}")}) {
    refuse(npy(header, kBytes), ErrorCode::bad_file, "its header is damaged");
  }
  const std::string bytes = npy(dictionary("|u1"), kBytes);
  for (std::size_t length = 1; length < bytes.size(); ++length)
    refuse(bytes.substr(0, length), ErrorCode::bad_file, "");
  refuse(npy(dictionary("|u1"), kBytes, 4), ErrorCode::unsupported, "version 4 of the .npy format");
  refuse(npy(dictionary("<f8", "(4294967296, 4294967296, 4)"), kBytes), ErrorCode::bad_file,
         "more than any file can hold");
  refuse(npy(dictionary("<f8", "(1000000, 1000000, 4)"), kBytes), ErrorCode::bad_file,
         "states 32000000000000 bytes");
  refuse(gzipped(npy(dictionary("<f8", "(1000000, 1000000, 4)"), kBytes)), ErrorCode::bad_file,
         "far more than");
  std::string long_header = npy(dictionary("|u1"), kBytes, 2);
  put(long_header, 8, std::uint32_t{0xFFFFFFFF}, false);
  refuse(long_header, ErrorCode::bad_file, "its header is cut off");
}

TEST_F(Npy, MoreBytesThanStatedGiveAWarning) {
  const VolumeFile file = read(npy(dictionary("|u1"), kBytes + "more"), {.spacing = Vec3{1, 1, 1}});
  expect_one_warning(file, "has 4 bytes after the samples");
}

TEST_F(Npy, ArchivesAreRefused) {
  write_bytes(folder_ / "v.npz", "PK\x03\x04 and so on");
  expect_error(ErrorCode::unsupported,
               "is an archive of NumPy arrays (numpy.save writes one array as .npy)",
               folder_ / "v.npz", [&] { read_volume(folder_ / "v.npz"); });
}

}  // namespace
}  // namespace isoatlas::detail::test
