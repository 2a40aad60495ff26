// SPDX-License-Identifier: Apache-2.0
// MGH and MGZ: every type, orientation and frame that FreeSurfer writes, and files that are cut off
// or have impossible numbers.
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

namespace fs = std::filesystem;

constexpr std::size_t kCount = 24;  // 4 x 3 x 2
constexpr std::array<std::size_t, 3> kSize{4, 3, 2};
constexpr bool kBigEndian = true;

struct MghOptions {
  int version = 1;
  std::array<int, 4> size{4, 3, 2, 1};
  int type = 0;
  std::int16_t good_ras = 1;
  std::array<float, 3> spacing{1, 1, 1};
  std::array<float, 9> cosines{-1, 0, 0, 0, 0, -1, 0, 1, 0};  // x, then y, then z
  std::array<float, 3> middle{0, 0, 0};
};

std::string mgh(const MghOptions& options,
                const std::string& samples = bytes_of(ramp<std::uint8_t>(kCount))) {
  std::string bytes(284, '\0');
  put(bytes, 0, options.version, kBigEndian);
  for (std::size_t i = 0; i < 4; ++i) put(bytes, 4 + 4 * i, options.size[i], kBigEndian);
  put(bytes, 20, options.type, kBigEndian);
  put(bytes, 28, options.good_ras, kBigEndian);
  for (std::size_t i = 0; i < 3; ++i) put(bytes, 30 + 4 * i, options.spacing[i], kBigEndian);
  for (std::size_t i = 0; i < 9; ++i) put(bytes, 42 + 4 * i, options.cosines[i], kBigEndian);
  for (std::size_t i = 0; i < 3; ++i) put(bytes, 78 + 4 * i, options.middle[i], kBigEndian);
  return bytes + samples;
}

class Mgh : public testing::Test {
 protected:
  TempFolder folder_;

  VolumeFile read(const std::string& bytes, const ReadOptions& options = {},
                  const std::string& name = "v.mgh") {
    write_bytes(folder_ / name, bytes);
    return read_volume_file(folder_ / name, options);
  }
  void refuse(const std::string& bytes, ErrorCode code, const std::string& message,
              const ReadOptions& options = {}) {
    SCOPED_TRACE(message);
    write_bytes(folder_ / "v.mgz", bytes);
    expect_error(code, message, folder_ / "v.mgz",
                 [&] { read_volume(folder_ / "v.mgz", options); });
  }
  template <class T>
  void expect_type(int type, SampleType sample_type) {
    std::vector<T> values = ramp<T>(kCount);
    values[1] = std::numeric_limits<T>::max();
    values[2] = std::numeric_limits<T>::lowest();
    const std::string bytes = mgh({.type = type}, bytes_of(values, kBigEndian));
    for (const std::string& packed : {bytes, gzipped(bytes)}) {
      const VolumeFile file = read(packed);
      EXPECT_EQ(file.volume.view.type, sample_type);
      EXPECT_EQ(file.volume.view.grid.size, kSize);
      EXPECT_EQ(samples_as_double(file.volume), std::vector<double>(values.begin(), values.end()));
      EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::millimetre);
      EXPECT_TRUE(file.source.warnings.empty());
    }
  }
};

TEST_F(Mgh, EveryType) {
  expect_type<std::uint8_t>(0, SampleType::uint8);
  expect_type<std::int32_t>(1, SampleType::int32);
  expect_type<float>(3, SampleType::float32);
  expect_type<std::int16_t>(4, SampleType::int16);
  expect_type<std::uint16_t>(10, SampleType::uint16);
  for (const auto& [type, kind] :
       std::vector<std::pair<int, std::string>>{{2, "long"},
                                                {5, "bitmap"},
                                                {6, "tensor"},
                                                {7, "complex float"},
                                                {9, "RGB"},
                                                {11, "none that MGH knows"},
                                                {-1, "none"}}) {
    refuse(mgh({.type = type}, std::string(1000, '\0')), ErrorCode::unsupported, kind);
  }
}

TEST_F(Mgh, IsFoundByItsContent) {
  EXPECT_EQ(read(mgh({}), {}, "v").source.format, "MGH");
  EXPECT_EQ(read(gzipped(mgh({})), {}, "v.nii").source.format, "MGH");
}

TEST_F(Mgh, TheMiddleSampleIsAtTheCentre) {
  // From the description of the format: ras = centre + cosines * spacing * (index - size / 2).
  const MghOptions options{.spacing = {0.5F, 2, 3},
                           .cosines = {0, 1, 0, 0.6F, 0, 0.8F, -0.8F, 0, 0.6F},
                           .middle = {10, -20, 30}};
  const VolumeFile file = read(mgh(options));
  expect_size_and_spacing(file.volume, kSize, {0.5, 2, 3});
  const auto ras = [&](double i, double j, double k) {
    const double x = 0.5 * (i - 2), y = 2 * (j - 1.5), z = 3 * (k - 1);
    return Vec3{10 + 0.6 * y - 0.8 * z, -20 + x, 30 + 0.8 * y + 0.6 * z};
  };
  for (const Vec3& index :
       {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 1}, Vec3{2, 1.5, 1}}) {
    const Vec3 expected = ras(index.x, index.y, index.z);
    expect_near(file.volume.view.grid.to_world(index), {-expected.x, -expected.y, expected.z},
                1e-6);
  }
  EXPECT_TRUE(file.source.warnings.empty());
}

TEST_F(Mgh, WithoutOrientationItIsCoronal) {
  const VolumeFile file = read(mgh({.good_ras = 0, .spacing = {7, 7, 7}, .middle = {1, 2, 3}}));
  expect_size_and_spacing(file.volume, kSize, {1, 1, 1}, 0);
  const auto expect_ras = [&](Vec3 index, Vec3 ras) {
    EXPECT_EQ(file.volume.view.grid.to_world(index), (Vec3{-ras.x, -ras.y, ras.z}));
  };
  expect_ras({0, 0, 0}, {2, -1, 1.5});
  expect_ras({1, 0, 0}, {1, -1, 1.5});
  expect_ras({0, 1, 0}, {2, -1, 0.5});
  expect_ras({0, 0, 1}, {2, 0, 1.5});
  expect_one_warning(file, "states no orientation (goodRASFlag is 0)");
}

TEST_F(Mgh, FramesAreAChoice) {
  const std::string bytes = mgh({.size = {4, 3, 2, 3}}, bytes_of(ramp<std::uint8_t>(3 * kCount)));
  for (const std::string& packed : {bytes, gzipped(bytes)}) {
    EXPECT_EQ(sample_as_double(read(packed, {.time = 2}).volume, 1), 2 * kCount + 1);
    refuse(packed, ErrorCode::unsupported, "has 3 time points, expected a choice of one: 0, 1, 2");
    refuse(packed, ErrorCode::bad_argument, "has no time '3'", {.time = 3});
  }
  const std::string cut = bytes.substr(0, bytes.size() - 1);  // cut in a frame that is not read
  refuse(cut, ErrorCode::bad_file, "states 72 bytes of samples, the file has 71", {.time = 0});
  refuse(gzipped(cut), ErrorCode::bad_file, "states 72 bytes of samples, the file has 71",
         {.time = 0});
}

TEST_F(Mgh, DataAfterTheSamplesGivesNoWarning) {
  for (const std::string& bytes :
       {mgh({}) + "scan parameters", gzipped(mgh({}) + "scan parameters")}) {
    EXPECT_TRUE(read(bytes).source.warnings.empty());
  }
  EXPECT_EQ(read(mgh({.version = 0x0101})).source.format, "MGH");  // with an intent
}

TEST_F(Mgh, DamagedFilesAreRefused) {
  refuse(mgh({.version = 2}), ErrorCode::bad_file, "its version is 2, expected 1");
  refuse(mgh({.size = {4, 0, 2, 1}}), ErrorCode::bad_file, "0 samples along axis 2");
  refuse(mgh({.size = {4, 3, 2, -1}}), ErrorCode::bad_file, "-1 samples along axis 4");
  refuse(mgh({.size = {4, 3, 1, 1}}), ErrorCode::unsupported, "4 x 3 x 1 samples");
  refuse(mgh({.size = {0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF, 1}}), ErrorCode::bad_file,
         "more than any file can hold");
  refuse(mgh({.size = {4, 3, 2, 1000000}}), ErrorCode::bad_file,
         "states 24000000 bytes of samples, the file has 24");
  refuse(mgh({.size = {4, 3, 2, 0x7FFFFFFF}}), ErrorCode::unsupported,
         "2147483647 volumes, expected at most 1000000");
  refuse(gzipped(mgh({.size = {30000, 30000, 30000, 1}})), ErrorCode::bad_file,
         "far more than a file of");
  refuse(mgh({.spacing = {1, 0, 1}}), ErrorCode::bad_file, "spacing along y");
  refuse(mgh({.cosines = {1, 0, 0, 1, 0, 0, 0, 0, 1}}), ErrorCode::bad_file, "singular");
  refuse(mgh({.middle = {std::numeric_limits<float>::infinity(), 0, 0}}), ErrorCode::bad_file,
         "origin");
  const std::string bytes = mgh({});
  for (const std::size_t length : {1, 40, 89, 100, 283, 284, 300, 307})
    refuse(bytes.substr(0, length), ErrorCode::bad_file, "");
  const std::string packed = gzipped(bytes);
  for (std::size_t length = 20; length < packed.size(); length += 7)
    refuse(packed.substr(0, length), ErrorCode::bad_file, "");
}

}  // namespace
}  // namespace isoatlas::detail::test
