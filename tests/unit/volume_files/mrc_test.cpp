// SPDX-License-Identifier: Apache-2.0
// MRC2014, CCP4 maps and IMOD's variant.
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
constexpr std::array<std::size_t, 3> kSize{4, 3, 2};

struct MrcOptions {
  std::array<int, 3> size{4, 3, 2};
  int mode = 0;
  std::array<int, 3> start{0, 0, 0};
  std::array<int, 3> intervals{4, 3, 2};
  std::array<float, 3> cell{4, 3, 2};
  std::array<float, 3> angles{90, 90, 90};
  std::array<int, 3> axes{1, 2, 3};
  std::array<float, 2> range{0, -1};  // unknown
  int space_group = 1;
  int extended_bytes = 0;
  int imod_stamp = 0, imod_flags = 0;
  std::array<float, 3> origin{0, 0, 0};
  std::string map = "MAP ";
  std::string stamp = "";  // empty: the stamp of the byte order
  bool big_endian = false;
};

std::string mrc(const MrcOptions& options,
                const std::string& samples = bytes_of(ramp<std::uint8_t>(kCount))) {
  std::string bytes(1024, '\0');
  const auto put_all = [&](std::size_t offset, const auto& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      put(bytes, offset + 4 * i, values[i], options.big_endian);
  };
  put_all(0, options.size);
  put_all(12, std::array{options.mode});
  put_all(16, options.start);
  put_all(28, options.intervals);
  put_all(40, options.cell);
  put_all(52, options.angles);
  put_all(64, options.axes);
  put_all(76, options.range);
  put_all(88, std::array{options.space_group, options.extended_bytes});
  put_all(152, std::array{options.imod_stamp, options.imod_flags});
  put_all(196, options.origin);
  bytes.replace(208, options.map.size(), options.map);
  bytes.replace(212, 2,
                !options.stamp.empty() ? options.stamp
                : options.big_endian   ? "\x11\x11"
                                       : "\x44\x44");
  return bytes + std::string(static_cast<std::size_t>(std::max(options.extended_bytes, 0)), 'x') +
         samples;
}

class Mrc : public testing::Test {
 protected:
  TempFolder folder_;

  VolumeFile read(const std::string& bytes, const ReadOptions& options = {},
                  const std::string& name = "v.mrc") {
    write_bytes(folder_ / name, bytes);
    return read_volume_file(folder_ / name, options);
  }
  void refuse(const std::string& bytes, ErrorCode code, const std::string& message,
              const ReadOptions& options = {}) {
    SCOPED_TRACE(message);
    write_bytes(folder_ / "v.mrc", bytes);
    expect_error(code, message, folder_ / "v.mrc",
                 [&] { read_volume(folder_ / "v.mrc", options); });
  }
  template <class T>
  void expect_mode(int mode, SampleType type) {
    std::vector<T> values = ramp<T>(kCount);
    values[1] = std::numeric_limits<T>::max();
    values[2] = std::numeric_limits<T>::lowest();
    for (const bool big_endian : {false, true}) {
      const std::string bytes =
          mrc({.mode = mode, .big_endian = big_endian}, bytes_of(values, big_endian));
      for (const std::string& packed : {bytes, gzipped(bytes)}) {
        const VolumeFile file = read(packed);
        EXPECT_EQ(file.source.format, "MRC");
        EXPECT_EQ(file.volume.view.type, type);
        expect_size_and_spacing(file.volume, kSize, {1, 1, 1}, 0);
        EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::angstrom);
        EXPECT_EQ(samples_as_double(file.volume),
                  std::vector<double>(values.begin(), values.end()));
        EXPECT_TRUE(file.source.warnings.empty());
      }
    }
  }
};

TEST_F(Mrc, EveryMode) {
  expect_mode<std::int8_t>(0, SampleType::int8);
  expect_mode<std::int16_t>(1, SampleType::int16);
  expect_mode<float>(2, SampleType::float32);
  expect_mode<std::uint16_t>(6, SampleType::uint16);
  const VolumeFile half =
      read(mrc({.mode = 12}, bytes_of(std::vector<std::uint16_t>(kCount, 0x3E00))));
  EXPECT_EQ(half.volume.view.type, SampleType::float32);
  EXPECT_EQ(sample_as_double(half.volume, 23), 1.5);
  for (const auto& [mode, kind] :
       std::vector<std::pair<int, std::string>>{{3, "complex"},
                                                {4, "complex"},
                                                {16, "colours"},
                                                {101, "4-bit integers"},
                                                {7, "no type that MRC2014 knows"}}) {
    refuse(mrc({.mode = mode}, std::string(1000, '\0')), ErrorCode::unsupported, kind);
  }
}

TEST_F(Mrc, BytesAreSignedOrNot) {
  const std::string samples(kCount, '\xF0');
  const auto expect = [&](const MrcOptions& options, double value, const std::string& reason) {
    const VolumeFile file = read(mrc(options, samples));
    EXPECT_EQ(sample_as_double(file.volume, 7), value) << reason;
    EXPECT_EQ(decision(file, "bytes"), reason);
  };
  constexpr int kImod = 1146047817;
  expect({}, -16, "signed, MRC2014");
  expect({.range = {0, 240}}, 240, "unsigned, the stated maximum is 240");
  expect({.range = {-16, 100}}, -16, "signed, MRC2014");
  expect({.range = {0, 1000}}, -16, "signed, MRC2014");
  expect({.imod_stamp = kImod}, 240, "unsigned, IMOD's flag");
  expect({.range = {0, 240}, .imod_stamp = kImod, .imod_flags = 1}, -16, "signed, IMOD's flag");
  EXPECT_THROW(read(mrc({.imod_stamp = kImod, .imod_flags = 16}, samples)), Error);  // 4 bits
  expect({.imod_flags = 17}, -16,
         "signed, MRC2014");  // without IMOD's stamp the field has no meaning
}

TEST_F(Mrc, SpacingIsTheCellDividedByItsIntervals) {
  const VolumeFile file = read(mrc({.intervals = {8, 3, 4}, .cell = {4, 6, 10}}));
  expect_size_and_spacing(file.volume, kSize, {0.5, 2, 2.5}, 0);
  for (const MrcOptions& options :
       {MrcOptions{.cell = {0, 0, 0}}, MrcOptions{.intervals = {0, 3, 2}}}) {
    const VolumeFile without = read(mrc(options));
    EXPECT_FALSE(without.source.has_spacing);
    EXPECT_EQ(without.volume.view.grid.spacing, (Vec3{1, 1, 1}));
    EXPECT_EQ(without.volume.view.grid.unit, LengthUnit::unknown);
    expect_one_warning(without, "states no voxel size");
  }
}

TEST_F(Mrc, OriginIsStatedInTwoWays) {
  const MrcOptions starts{.start = {10, -20, 30}, .cell = {2, 3, 4}};
  VolumeFile file = read(mrc(starts));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{5, -20, 60}));
  MrcOptions both = starts;
  both.origin = {1.5F, 0, -3};
  file = read(mrc(both));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1.5, 0, -3}));
  EXPECT_EQ(decision(file, "origin"), "ORIGIN");
  both.imod_stamp = 1146047817;
  file = read(mrc(both));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{-1.5, 0, 3}));
  EXPECT_EQ(decision(file, "origin"), "ORIGIN, reversed as in IMOD");
  both.imod_flags = 4;
  EXPECT_EQ(read(mrc(both)).volume.view.grid.origin, (Vec3{1.5, 0, -3}));
}

TEST_F(Mrc, AxesInAnyOrder) {
  // Columns along z, rows along x, sections along y: the samples stay in order, the axes of the
  // grid change.
  const VolumeFile file = read(
      mrc({.start = {1, 2, 3}, .intervals = {3, 2, 4}, .cell = {3, 4, 12}, .axes = {3, 1, 2}}));
  const Grid& grid = file.volume.view.grid;
  expect_size_and_spacing(file.volume, kSize, {3, 1, 2}, 0);  // along z, x and y
  EXPECT_EQ(grid.to_world({0, 0, 0}), (Vec3{2, 6, 3}));
  EXPECT_EQ(grid.to_world({1, 0, 0}), (Vec3{2, 6, 6}));
  EXPECT_EQ(grid.to_world({0, 1, 0}), (Vec3{3, 6, 3}));
  EXPECT_EQ(grid.to_world({0, 0, 1}), (Vec3{2, 8, 3}));
  EXPECT_FALSE(grid.mirrored());
  EXPECT_EQ(sample_as_double(file.volume, 5), 5);
  EXPECT_EQ(decision(file, "axes"), "columns, rows and sections along zxy");
  EXPECT_TRUE(read(mrc({.axes = {2, 1, 3}})).volume.view.grid.mirrored());
  EXPECT_EQ(read(mrc({.axes = {0, 0, 0}})).volume.view.grid.direction,
            Grid{}.direction);  // as old programs write it
  const std::string big = mrc({.mode = 0, .axes = {0, 0, 0}, .big_endian = true},
                              bytes_of(std::vector<std::int8_t>(kCount, 1), true));
  EXPECT_EQ(read(big).volume.view.grid.size, kSize);  // its header is valid in either byte order
}

TEST_F(Mrc, CellsNeedNotHaveRightAngles) {
  const VolumeFile file = read(mrc({.cell = {8, 9, 10}, .angles = {90, 120, 90}}));
  const Grid& grid = file.volume.view.grid;
  expect_near(grid.direction[0], {1, 0, 0}, 1e-12);
  expect_near(grid.direction[1], {0, 1, 0}, 1e-12);
  expect_near(grid.direction[2], {-0.5, 0, std::sqrt(0.75)}, 1e-12);
  expect_size_and_spacing(file.volume, kSize, {2, 3, 5}, 1e-12);
  const VolumeFile hexagonal = read(mrc({.angles = {90, 90, 120}}));
  expect_near(hexagonal.volume.view.grid.direction[1], {-0.5, std::sqrt(0.75), 0}, 1e-12);
  EXPECT_EQ(read(mrc({.angles = {0, 0, 0}})).volume.view.grid.direction, Grid{}.direction);
  refuse(mrc({.angles = {10, 90, 170}}), ErrorCode::bad_file,
         "direction");  // such a cell does not exist
}

TEST_F(Mrc, TheExtendedHeaderIsSkipped) {
  EXPECT_EQ(sample_as_double(read(mrc({.extended_bytes = 160})).volume, 9), 9);
  EXPECT_EQ(sample_as_double(read(gzipped(mrc({.extended_bytes = 160}))).volume, 9), 9);
  refuse(mrc({.extended_bytes = -1}), ErrorCode::bad_file, "its extended header has -1 bytes");
  std::string bytes = mrc({});
  put(bytes, 92, 0x7FFFFFFF, false);
  refuse(bytes, ErrorCode::bad_file, "states 24 bytes of samples, the file has 0");
}

TEST_F(Mrc, StacksOfVolumesAreAChoice) {
  const std::string bytes = mrc({.size = {4, 3, 6}, .intervals = {4, 3, 2}, .space_group = 401},
                                bytes_of(ramp<std::uint8_t>(3 * kCount)));
  const VolumeFile file = read(bytes, {.time = 1});
  EXPECT_EQ(file.volume.view.grid.size, kSize);
  EXPECT_EQ(sample_as_double(file.volume, 0), kCount);
  refuse(bytes, ErrorCode::unsupported, "has 3 time points");
  refuse(mrc({.size = {4, 3, 5}, .space_group = 401}), ErrorCode::bad_file,
         "a stack of volumes of 2 sections each, but has 5 sections");
  refuse(mrc({.intervals = {4, 3, 0}, .space_group = 401}), ErrorCode::bad_file,
         "a stack of volumes of 0 sections");
}

TEST_F(Mrc, StacksOfImagesGiveAWarning) {
  expect_one_warning(read(mrc({.intervals = {4, 3, 1}, .space_group = 0})),
                     "a stack of images, not a volume");
  EXPECT_TRUE(read(mrc({.space_group = 0})).source.warnings.empty());  // as in IMOD's volumes
}

TEST_F(Mrc, TheByteOrderIsTheOneWithAValidHeader) {
  const std::string samples = bytes_of(ramp<std::int16_t>(kCount), true);
  for (const char* stamp : {"\x44\x44", "\x11\x11", "xx"}) {
    const VolumeFile file = read(mrc({.mode = 1, .stamp = stamp, .big_endian = true}, samples));
    EXPECT_EQ(sample_as_double(file.volume, 9), 9);
  }
}

TEST_F(Mrc, OldFilesHaveNoMagic) {
  EXPECT_EQ(sample_as_double(read(mrc({.map = ""})).volume, 9), 9);
  EXPECT_EQ(read(mrc({}), {}, "v").source.format, "MRC");
  write_bytes(folder_ / "v.rec", "a recording of something else" + std::string(2000, 'x'));
  expect_error(ErrorCode::bad_file, "is not an MRC file", folder_ / "v.rec",
               [&] { read_volume(folder_ / "v.rec"); });
}

TEST_F(Mrc, DamagedFilesAreRefused) {
  const std::string bytes = mrc({});
  for (const std::size_t length : {1, 200, 1023, 1024, 1025, 1047})
    refuse(bytes.substr(0, length), ErrorCode::bad_file, "");
  refuse(mrc({.size = {4, 3, 0}}), ErrorCode::bad_file, "not valid");
  refuse(mrc({.axes = {1, 1, 2}}), ErrorCode::bad_file, "not valid");
  refuse(mrc({.axes = {1, 2, 4}}), ErrorCode::bad_file, "not valid");
  refuse(mrc({.axes = {std::numeric_limits<int>::min(), 2, 3}}), ErrorCode::bad_file,
         "not valid");  // fuzzing: no overflow
  refuse(mrc({.mode = -1}), ErrorCode::bad_file, "not valid");
  refuse(mrc({.size = {4, 3, 1}}), ErrorCode::unsupported, "4 x 3 x 1 samples");
  refuse(mrc({.size = {0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF}}), ErrorCode::bad_file,
         "more than any file can hold");
  refuse(mrc({.size = {2000, 2000, 2000}}), ErrorCode::bad_file,
         "states 8000000000 bytes of samples, the file has 24");
  refuse(gzipped(mrc({.size = {2000, 2000, 2000}})), ErrorCode::bad_file, "far more than");
  refuse(mrc({.cell = {std::numeric_limits<float>::infinity(), 1, 1}}), ErrorCode::bad_file,
         "spacing along x");
  refuse(mrc({.origin = {std::numeric_limits<float>::quiet_NaN(), 1, 1}}), ErrorCode::bad_file,
         "origin");
  expect_one_warning(read(bytes + "more"), "has 4 bytes after the samples");
}

}  // namespace
}  // namespace isoatlas::detail::test
