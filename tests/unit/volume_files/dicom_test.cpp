// SPDX-License-Identifier: Apache-2.0
// Folders with DICOM slices, written by GDCM through ITK.
#include <gtest/gtest.h>
#include <itkGDCMImageIO.h>
#include <itkMetaDataObject.h>

#include <cmath>
#include <functional>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/volume_files.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

struct Slice {
  std::string file;
  Vec3 position;
  std::int16_t value;  // value of all its samples
  std::string series = "1.2.826.0.1.3680043.2.1125.1.1";
  std::string instance_number = "1";
  std::size_t width = 6;
};

// Slices with a normal along y, as in a coronal series: x axis to the left, y axis down.
const std::array<Vec3, 3> kCoronal{Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 1, 0}};

std::string numbered(std::string prefix, int i) { return prefix += std::to_string(i); }

void write_slice(const fs::path& folder, const Slice& slice) {
  const auto image_io = itk::GDCMImageIO::New();
  itk::MetaDataDictionary& tags = image_io->GetMetaDataDictionary();
  const auto set = [&](const char* tag, const std::string& value) {
    itk::EncapsulateMetaData<std::string>(tags, tag, value);
  };
  set("0008|0016", "1.2.840.10008.5.1.4.1.1.2");  // CT image
  set("0008|0060", "CT");
  set("0028|0004", "MONOCHROME2");
  set("0020|000d", "1.2.826.0.1.3680043.2.1125.1");
  set("0020|000e", slice.series);
  set("0020|0013", slice.instance_number);
  set("0008|0018",
      slice.series + "." + std::to_string(std::hash<std::string>{}(slice.file) % 1000000));
  image_io->KeepOriginalUIDOn();
  Grid grid;
  grid.size = {slice.width, 4, 1};
  grid.spacing = {0.5, 0.75, 1};
  grid.origin = slice.position;
  grid.direction = kCoronal;
  std::string bytes;
  for (std::size_t i = 0; i < grid.sample_count(); ++i) {
    const auto value = static_cast<std::int16_t>(
        slice.value + (i == 0 ? 1000 : 0));  // marks the first sample of a slice
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  write_with(*image_io, folder / slice.file, grid, SampleType::int16, bytes);
}

TEST(Dicom, SlicesAreSortedByPositionNotByName) {
  const TempFolder folder;
  // File names and instance numbers decrease along +y, the slices' normal.
  const double first = 40, step = 2.5;
  for (int i = 0; i < 5; ++i) {
    write_slice(folder.path(), {.file = numbered("s", 9 - i),
                                .position = {-12, first + step * i, 88},
                                .value = static_cast<std::int16_t>(-100 * i),
                                .instance_number = std::to_string(50 - i)});
  }
  write_bytes(folder / "notes.txt", "not an image");
  const Volume volume = read_volume(folder.path());
  ASSERT_EQ(volume.view.grid.size, (std::array<std::size_t, 3>{6, 4, 5}));
  ASSERT_EQ(volume.view.type, SampleType::int16);
  EXPECT_EQ(volume.view.grid.spacing, (Vec3{0.5, 0.75, 2.5}));
  EXPECT_EQ(volume.view.grid.direction, kCoronal);
  EXPECT_EQ(volume.view.grid.origin, (Vec3{-12, 40, 88}));
  const auto* samples = static_cast<const std::int16_t*>(volume.view.samples);
  for (std::size_t z = 0; z < 5; ++z) {
    EXPECT_EQ(samples[z * 24], 1000 - 100 * static_cast<int>(z));
    EXPECT_EQ(samples[z * 24 + 23], -100 * static_cast<int>(z));
  }
}

TEST(Dicom, TiltedGantryStaysTilted) {
  const TempFolder folder;
  for (int i = 0; i < 3; ++i) {  // each slice is offset by 1 along z and by 2 along its normal, y
    write_slice(folder.path(),
                {.file = numbered("s", i), .position = {0, 2.0 * i, 1.0 * i}, .value = 0});
  }
  const Grid grid = read_volume(folder.path()).view.grid;
  EXPECT_NEAR(grid.spacing.z, std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(grid.direction[2].y, 2 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(grid.direction[2].z, 1 / std::sqrt(5.0), 1e-12);
}

TEST(Dicom, MissingSliceIsAnError) {
  const TempFolder folder;
  for (const int i : {0, 1, 2, 4, 5, 6}) {
    write_slice(folder.path(), {.file = numbered("s", i), .position = {0, 2.0 * i, 0}, .value = 0});
  }
  expect_error(ErrorCode::bad_file, "not evenly spaced: 4 from s2 to s4", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(Dicom, TwoSlicesAtOnePositionAreAnError) {
  const TempFolder folder;
  write_slice(folder.path(), {.file = "a", .position = {0, 0, 0}, .value = 0});
  write_slice(folder.path(), {.file = "b", .position = {0, 2, 0}, .value = 0});
  write_slice(folder.path(), {.file = "c", .position = {0, 2, 0}, .value = 0});
  write_slice(folder.path(), {.file = "d", .position = {0, 4, 0}, .value = 0});
  expect_error(ErrorCode::unsupported, "several volumes", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(Dicom, SeveralSeriesAreListed) {
  const TempFolder folder;
  const std::string one = "1.2.826.0.1.3680043.2.1125.1.1", two = "1.2.826.0.1.3680043.2.1125.1.2";
  for (int i = 0; i < 3; ++i) {
    write_slice(folder.path(),
                {.file = numbered("a", i), .position = {0, 2.0 * i, 0}, .value = 0, .series = one});
  }
  write_slice(folder.path(), {.file = "b", .position = {0, 0, 0}, .value = 0, .series = two});
  for (const std::string& id : {one, two}) {
    expect_error(ErrorCode::unsupported, id, folder.path(), [&] { read_volume(folder.path()); });
  }
  expect_error(ErrorCode::unsupported, "CT, 3 slices of 6 x 4", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(Dicom, SlicesOfDifferentSizeAreNotOneVolume) {
  const TempFolder folder;
  write_slice(folder.path(), {.file = "a", .position = {0, 0, 0}, .value = 0});
  write_slice(folder.path(), {.file = "b", .position = {0, 2, 0}, .value = 0, .width = 8});
  EXPECT_THROW(read_volume(folder.path()), Error);
}

TEST(Dicom, OneSliceIsNotAVolume) {
  const TempFolder folder;
  write_slice(folder.path(), {.file = "a", .position = {0, 0, 0}, .value = 0});
  expect_error(ErrorCode::unsupported, "6 x 4 x 1", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(Dicom, CutOffSliceIsAnError) {
  const TempFolder folder;
  for (int i = 0; i < 3; ++i) {
    write_slice(folder.path(), {.file = numbered("s", i), .position = {0, 2.0 * i, 0}, .value = 7});
  }
  const std::string whole = read_bytes(folder / "s1");
  for (const std::size_t length :
       {whole.size() - 1, whole.size() - 20, whole.size() - 48, whole.size() / 2}) {
    write_bytes(folder / "s1", whole.substr(0, length));
    SCOPED_TRACE(length);
    expect_error(ErrorCode::bad_file, "", folder.path(), [&] { read_volume(folder.path()); });
  }
}

TEST(Dicom, FoldersWithoutImages) {
  const TempFolder folder;
  expect_error(ErrorCode::bad_file, "without DICOM images", folder.path(),
               [&] { read_volume(folder.path()); });
  write_bytes(folder / "a.txt", "hello");
  expect_error(ErrorCode::bad_file, "without DICOM images", folder.path(),
               [&] { read_volume(folder.path()); });
}

}  // namespace
}  // namespace isoatlas::detail::test
