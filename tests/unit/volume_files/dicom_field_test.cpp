// SPDX-License-Identifier: Apache-2.0
// DICOM files as scanners and programs write them. Digests are of the samples that pydicom reads,
// sorted by position and rescaled frame by frame.
#include <gtest/gtest.h>

#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

const fs::path kDicom = fs::path(ISOATLAS_FIELD_DATA) / "dcm";
const std::string kSamples =
    "c4441704f70bb1f64baacb553e61e1eb2d3b121e5f0959613f7cec322026fae2";  // -834 .. 300, int32

void expect_field_grid(const Grid& grid, const Vec3& spacing = {0.5, 0.5, 2}) {
  EXPECT_EQ(grid.size, (std::array<std::size_t, 3>{24, 20, 16}));
  EXPECT_EQ(grid.spacing, spacing);
  EXPECT_EQ(grid.origin, (Vec3{-10, -20, 30}));
  EXPECT_EQ(grid.direction, (std::array<Vec3, 3>{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}));
  EXPECT_EQ(grid.unit, LengthUnit::millimetre);
}

void expect_field_volume(const VolumeFile& file, SampleType type, const std::string& digest) {
  expect_field_grid(file.volume.view.grid);
  EXPECT_EQ(file.volume.view.type, type);
  EXPECT_EQ(sample_digest(file.volume), digest);
  EXPECT_TRUE(file.source.warnings.empty()) << file.source.warnings.front();
}

std::string decision(const VolumeSource& source, const std::string& key) {
  for (const ReadDecision& one : source.decisions) {
    if (one.key == key) return one.value;
  }
  return "";
}

TEST(DicomField, FramesAreSortedByPosition) {
  const VolumeFile file = read_volume_file(kDicom / "enh_shuffled");
  expect_field_volume(file, SampleType::int32, kSamples);
  EXPECT_EQ(file.source.format, "multi-frame DICOM");
}

TEST(DicomField, FramesHaveTheirOwnRescale) {
  const VolumeFile file = read_volume_file(kDicom / "enh_slopes");
  expect_field_volume(file, SampleType::int32,
                      "b695dd18494047e6b27470174aacc84bbaafdbe942c9ed4ccea72a92d5ba1ea8");
  EXPECT_EQ(decision(file.source, "rescale"), "slope 1 to 2, intercept -1024 (HU)");
}

TEST(DicomField, TwoVolumesInOneFileAreAChoice) {
  try {
    read_volume_file(kDicom / "enh_two_vols");
    FAIL() << "expected ChoiceNeeded";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_EQ(needed.choice().name, "time");
    EXPECT_EQ(needed.choice().entries,
              (std::vector<std::string>{"frames 1 to 16", "frames 17 to 32"}));
  }
  for (const std::size_t time : {0U, 1U}) {
    expect_field_volume(read_volume_file(kDicom / "enh_two_vols" / "enh.dcm", {.time = time}),
                        SampleType::int32, kSamples);
  }
  expect_error(ErrorCode::bad_argument, "has no time '2'", kDicom / "enh_two_vols",
               [] { read_volume(kDicom / "enh_two_vols", {.time = 2}); });
}

TEST(DicomField, InvertedDisplayDoesNotChangeValues) {
  const VolumeFile file = read_volume_file(kDicom / "mono1_base");
  expect_field_volume(file, SampleType::int16,
                      "0ae31ed8756aed7b777036418229cd03a54844f39e123cdda584e545346cf180");
  EXPECT_EQ(decision(file.source, "photometric interpretation"),
            "MONOCHROME1; values are as stored");
}

TEST(DicomField, DoseIsScaled) {
  const VolumeFile file = read_volume_file(kDicom / "rtdose");
  expect_field_volume(
      file, SampleType::float64,
      "1df3192a3797107275d3ca9bfedf3e53ad17e94dbc6a02ac6689db21af95539c");  // 0 .. 3
  EXPECT_EQ(decision(file.source, "dose"), "DoseGridScaling 0.001, GY");
}

TEST(DicomField, AnEmptySliceIsAnErrorThatNamesIt) {
  expect_error(ErrorCode::bad_file, "IM009: is empty", kDicom / "endtrunc0",
               [] { read_volume(kDicom / "endtrunc0"); });
}

TEST(DicomField, MissingPixelSpacingIsWarnedAbout) {
  const VolumeFile file = read_volume_file(kDicom / "ipp_only_nosp");
  expect_field_grid(file.volume.view.grid, {1, 1, 2});
  EXPECT_EQ(sample_digest(file.volume), kSamples);
  EXPECT_EQ(
      file.source.warnings,
      (std::vector<std::string>{"states no PixelSpacing; 1 x 1 mm is assumed within a slice"}));
}

TEST(DicomField, TwoSlicesAtOnePositionAreNamed) {
  expect_error(ErrorCode::unsupported, "two slices at one position: IM003, zz",
               kDicom / "dup_newuid", [] { read_volume(kDicom / "dup_newuid"); });
}

TEST(DicomField, ThicknessesAreComparedAsNumbers) {
  expect_field_volume(read_volume_file(kDicom / "thk_strings"), SampleType::int32, kSamples);
}

TEST(DicomField, SlopesOfSlicesMayDiffer) {
  expect_field_volume(
      read_volume_file(kDicom / "pet_mixed"), SampleType::float64,
      "305c0e65c517352bd8fd18ce61654e7109d43042e106dcf40d8b60d09386422f");  // -834 .. 300
}

TEST(DicomField, SlicesWithoutPositionAreRefused) {
  expect_error(ErrorCode::unsupported, "no position (ImagePositionPatient)",
               kDicom / "nogeom" / "IM000", [] { read_volume(kDicom / "nogeom"); });
}

TEST(DicomField, SubfoldersAreSearched) {
  expect_field_volume(read_volume_file(kDicom / "nested"), SampleType::int32, kSamples);
}

TEST(DicomField, AFileMeansTheSeriesInItsFolder) {
  expect_field_volume(read_volume_file(kDicom / "thk_strings" / "IM007"), SampleType::int32,
                      kSamples);
  expect_field_volume(read_volume_file(kDicom / "enh_shuffled" / "enh.dcm"), SampleType::int32,
                      kSamples);
}

TEST(DicomField, ASingleSliceIsRefused) {
  const fs::path file = fs::path(ISOATLAS_FIELD_DATA) / "one.dcm";
  expect_error(ErrorCode::unsupported, "a single slice", file, [&] { read_volume(file); });
}

}  // namespace
}  // namespace isoatlas::detail::test
