// SPDX-License-Identifier: Apache-2.0
// TIFF files as users' programs write them: the channels, times, lengths and values in their
// descriptions.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "isoatlas/volume_file.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"
#include "tiff_writer.h"

namespace isoatlas::detail::test {
namespace {

// SHA-256 of the samples as tifffile reads them.
constexpr const char* kFieldDigest =
    "a78a42af8528cf3edb01d11a1d936d0d1399c6755e7281beffae27d955831b1d";
constexpr std::array<std::size_t, 3> kFieldSize{24, 20, 16};

const std::vector<std::string> kNone;

// 4 x 3 samples that identify the page and the position.
std::string samples_of(std::size_t page, std::size_t bytes = 12) {
  std::string samples;
  for (std::size_t i = 0; i < bytes; ++i) samples += static_cast<char>(page * 16 + i);
  return samples;
}

std::string pages(std::size_t count, const std::string& description, TiffPage page = {}) {
  TiffWriter file;
  for (std::size_t i = 0; i < count; ++i) {
    page.samples = samples_of(i);
    page.description = i == 0 ? description : "";
    file.add(page);
  }
  return file.bytes();
}

// The page numbers in the first samples of the slices.
std::vector<int> pages_read(const VolumeFile& file) {
  const Grid& grid = file.volume.view.grid;
  std::vector<int> read;
  for (std::size_t z = 0; z < grid.size[2]; ++z) {
    read.push_back(
        static_cast<int>(sample_as_double(file.volume, z * grid.size[0] * grid.size[1])) / 16);
  }
  return read;
}

class Tiff : public testing::Test {
 protected:
  VolumeFile read(const std::string& bytes, const ReadOptions& options = {},
                  const std::string& name = "a.tif") {
    write_bytes(folder_ / name, bytes);
    return read_volume_file(folder_ / name, options);
  }
  void refuse(const std::string& bytes, ErrorCode code, const std::string& message,
              const ReadOptions& options = {}) {
    write_bytes(folder_ / "a.tif", bytes);
    expect_error(code, message, folder_ / "a.tif",
                 [&] { read_volume_file(folder_ / "a.tif", options); });
  }
  TempFolder folder_;
};

std::string decision(const VolumeFile& file, const std::string& key) {
  for (const ReadDecision& decision : file.source.decisions) {
    if (decision.key == key) return decision.value;
  }
  return "";
}

// ---------------------------------------------------------------- field files

TEST(TiffField, HyperstackNeedsAChannel) {
  const auto path = field_file("t_ij_2ch.tif");
  try {
    read_volume_file(path);
    FAIL() << "expected ChoiceNeeded";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_EQ(needed.choice().name, "channel");
    EXPECT_EQ(needed.choice().entries.size(), 2U);
  }
  const VolumeFile first = read_volume_file(path, {.channel = "0"}),
                   second = read_volume_file(path, {.channel = "1"});
  EXPECT_EQ(sample_digest(first.volume), kFieldDigest);
  EXPECT_EQ(sample_digest(second.volume),
            "15c272014bfb3fdbe8aaba98bf352dd36623653e759884322246d125e5d3aea8");
  for (const VolumeFile& file : {first, second}) {
    expect_size_and_spacing(file.volume, kFieldSize, {1, 1, 1.5});
    EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
    EXPECT_EQ(file.source.format, "ImageJ TIFF");
    EXPECT_EQ(file.source.warnings, kNone);
    ASSERT_EQ(file.source.choices.size(), 1U);
  }
  expect_error(ErrorCode::bad_argument, "has no channel '2', expected one of 0, 1", path,
               [&] { read_volume_file(path, {.channel = "2"}); });
  expect_error(ErrorCode::bad_argument, "time", path,
               [&] { read_volume_file(path, {.channel = "1", .time = 1}); });
}

TEST(TiffField, ImageJWritesNoSpacingOfOne) {
  const VolumeFile file = read_volume_file(field_file("t_ij_nosp.tif"));
  expect_size_and_spacing(file.volume, kFieldSize, {0.2, 0.2, 1}, 1e-15);
  EXPECT_EQ(sample_digest(file.volume), kFieldDigest);
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
  EXPECT_TRUE(file.source.has_spacing);
  EXPECT_EQ(file.source.warnings,
            std::vector<std::string>{"states no voxel size along z; 1 um is assumed there"});
}

TEST(TiffField, OmeLengths) {
  const VolumeFile file = read_volume_file(field_file("t_ome.ome.tif"));
  expect_size_and_spacing(file.volume, kFieldSize, {0.1, 0.1, 0.5}, 1e-15);
  EXPECT_EQ(sample_digest(file.volume),
            "8f02e37d1d7c3422c7cdd6bc09a11d3d100ce798faa9a364c0fd1a4907c7d8e8");
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
  EXPECT_EQ(file.source.format, "OME-TIFF");
  EXPECT_EQ(file.source.warnings, kNone);
}

TEST(TiffField, SignedSamplesOfImageJ) {
  const VolumeFile file = read_volume_file(field_file("t_ij_signed16.tif"));
  EXPECT_EQ(file.volume.view.type, SampleType::int16);
  const SampleSummary summary = summarize(file.volume);
  EXPECT_EQ(summary.minimum, -2779);
  EXPECT_EQ(summary.maximum, 1000);
  EXPECT_EQ(sample_digest(file.volume),
            "e88388b96afc1ed5aca8487f61006024bb97cd6f639d139dfffd59c9655595d0");
  expect_size_and_spacing(file.volume, kFieldSize, {1, 1, 2});
  EXPECT_EQ(decision(file, "rescale"), "slope 1, intercept -32768");
  EXPECT_EQ(file.source.warnings, kNone);
}

TEST(TiffField, OnePageForAllImages) {
  const VolumeFile file = read_volume_file(field_file("t_ij_trunc.tif"));
  expect_size_and_spacing(file.volume, kFieldSize, {1, 1, 1});
  EXPECT_EQ(sample_digest(file.volume), kFieldDigest);
  EXPECT_FALSE(file.source.has_spacing);
  EXPECT_NE(decision(file, "layout"), "");
}

TEST(TiffField, PaletteIndices) {
  const VolumeFile file = read_volume_file(field_file("t_pal.tif"));
  expect_size_and_spacing(file.volume, kFieldSize, {1, 1, 1});
  EXPECT_EQ(sample_digest(file.volume), kFieldDigest);
  EXPECT_NE(decision(file, "photometric").find("indices"), std::string::npos);
  EXPECT_FALSE(file.source.has_spacing);
}

// ---------------------------------------------------------------- ImageJ

struct Lengths {
  std::string description;                     // follows "ImageJ=1.53t\nimages=2\nslices=2\n"
  std::vector<std::uint32_t> resolution = {};  // numerator, denominator
  std::uint32_t resolution_unit = 1;
  Vec3 spacing = {1, 1, 1};
  LengthUnit unit = LengthUnit::unknown;
  bool has_spacing = true;
  std::string warning = {};
  Vec3 origin = {};
};

TEST_F(Tiff, ImageJLengths) {
  constexpr LengthUnit kMicro = LengthUnit::micrometre, kUnknown = LengthUnit::unknown;
  const std::string missing_z = "states no voxel size along z; 1 is assumed there";
  const std::vector<Lengths> cases{
      {"unit=um\nspacing=2\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"unit=\\u00B5m\nspacing=2\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"unit=\\u0075m\nspacing=2\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"unit=\\uD83Dm\nspacing=2\n",
       {4, 1},
       1,
       {0.25, 0.25, 2},
       kUnknown,
       true,
       "its unit of length '\xEF\xBF\xBDm' is not known"},
      {"unit=\\u00\nspacing=2\n",
       {4, 1},
       1,
       {0.25, 0.25, 2},
       kUnknown,
       true,
       "its unit of length '\\u00' is not known"},
      {"unit=\xB5m\nspacing=2\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"unit=micron\nspacing=-2\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"unit=um\nspacing=2\n",
       {40000, 1},
       3,
       {0.25, 0.25, 2},
       kMicro},  // the resolution is per centimetre
      {"unit=inch\nspacing=0.5\n", {100, 1}, 2, {0.01, 0.01, 0.5}, LengthUnit::inch},
      {"unit=cm\nspacing=0.5\n", {10, 1}, 3, {0.1, 0.1, 0.5}, LengthUnit::centimetre},
      {"unit=mm\nspacing=1.5\n", {}, 1, {1, 1, 1.5}, LengthUnit::millimetre},
      {"unit=\\u00C5\nspacing=1.5\n", {2, 1}, 1, {0.5, 0.5, 1.5}, LengthUnit::angstrom},
      {"unit=um\nzunit=nm\nspacing=500\n", {4, 1}, 1, {0.25, 0.25, 0.5}, kMicro},
      {"unit=um\nzunit=sec\nspacing=3\n",
       {4, 1},
       1,
       {0.25, 0.25, 3},
       kMicro,
       true,
       "its z axis is in 'sec' and its x axis in 'um'; the numbers are used without conversion"},
      {"unit=furlong\nspacing=3\n",
       {4, 1},
       1,
       {0.25, 0.25, 3},
       kUnknown,
       true,
       "its unit of length 'furlong' is not known"},
      {"spacing=3\n", {4, 1}, 1, {0.25, 0.25, 3}, kUnknown},
      {"spacing=3e-3\n", {}, 1, {1, 1, 3e-3}, kUnknown},
      {"unit=pixel\nspacing=3\n", {}, 1, {1, 1, 3}, kUnknown},
      {"unit=um\nspacing=0\n",
       {4, 1},
       1,
       {0.25, 0.25, 1},
       kMicro,
       true,
       "states no voxel size along z; 1 um is assumed there"},
      {"", {5, 1}, 1, {0.2, 0.2, 1}, kUnknown, true, missing_z},
      {"",
       {300, 1},
       2,
       {1, 1, 1},
       kUnknown,
       false,
       "states no voxel size; 1 x 1 x 1 is assumed"},  // dots per inch concern printing
      {"unit=pixel\nloop=false\n",
       {1, 1},
       1,
       {1, 1, 1},
       kUnknown,
       false,
       "states no voxel size; 1 x 1 x 1 is assumed"},
      {"unit=um\nspacing=2\nxorigin=10\nyorigin=-4\nzorigin=0.5\n",
       {4, 1},
       1,
       {0.25, 0.25, 2},
       kMicro,
       true,
       "",
       {-2.5, 1, -1}},
      {"unit=um\r\nspacing=2\r\n", {4, 1}, 1, {0.25, 0.25, 2}, kMicro},
      {"min=3\nmax=900\ninfo=spacing is not = 7\nunit=um\nspacing=2\n",
       {4, 1},
       1,
       {0.25, 0.25, 2},
       kMicro},
  };
  for (const Lengths& c : cases) {
    SCOPED_TRACE(c.description);
    TiffPage page;
    if (!c.resolution.empty())
      page.more = {{282, 5, c.resolution}, {283, 5, c.resolution}, {296, 3, {c.resolution_unit}}};
    const VolumeFile file =
        read(pages(2, "ImageJ=1.53t\nimages=2\nslices=2\n" + c.description, page));
    expect_size_and_spacing(file.volume, {4, 3, 2}, c.spacing, 1e-9);
    EXPECT_EQ(file.volume.view.grid.unit, c.unit);
    EXPECT_EQ(file.volume.view.grid.origin, c.origin);
    EXPECT_EQ(file.source.has_spacing, c.has_spacing);
    EXPECT_EQ(file.source.warnings, c.warning.empty() ? kNone : std::vector{c.warning});
  }
}

TEST_F(Tiff, ImageJOriginIsInSamplesForAnySpacing) {
  const std::string bytes = pages(2,
                                  "ImageJ=1.53t\nimages=2\nslices=2\nunit=um\nspacing=2\nxorigin="
                                  "10\nyorigin=-4\nzorigin=0.5\n");
  EXPECT_EQ(read(bytes, {.spacing = Vec3{1, 2, 4}}).volume.view.grid.origin, (Vec3{-10, 8, -2}));
  EXPECT_EQ(read(bytes, {.spacing = Vec3{1, 2, 4}, .spacing_unit = LengthUnit::millimetre})
                .volume.view.grid.origin,
            (Vec3{-10, 8, -2}));
}

TEST_F(Tiff, ImageJSpacingThatIsNotANumber) {
  for (const char* spacing : {"abc", "1,5", "nan", "1.5 mm"}) {
    refuse(pages(2, std::string("ImageJ=1.53t\nimages=2\nslices=2\nspacing=") + spacing + "\n"),
           ErrorCode::bad_file, "is not a number");
  }
}

TEST_F(Tiff, ResolutionWithoutImageJIsNotAVoxelSize) {
  TiffPage page;
  page.more = {{282, 5, {5, 1}}, {283, 5, {5, 1}}, {296, 3, {3}}};
  const VolumeFile file = read(pages(2, "", page));
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 1, 1}));
  EXPECT_FALSE(file.source.has_spacing);
  page.more[2] = {296, 3, {5}};  // tifffile's micrometre, which TIFF does not define
  EXPECT_EQ(read(pages(2, "", page)).volume.view.grid.spacing, (Vec3{1, 1, 1}));
}

TEST_F(Tiff, ImageJOrderIsChannelSliceTime) {
  const std::string bytes = pages(
      12,
      "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nspacing=1.5\n");
  EXPECT_EQ(pages_read(read(bytes, {.channel = "0", .time = 0})), (std::vector{0, 2, 4}));
  EXPECT_EQ(pages_read(read(bytes, {.channel = "1", .time = 0})), (std::vector{1, 3, 5}));
  EXPECT_EQ(pages_read(read(bytes, {.channel = "1", .time = 1})), (std::vector{7, 9, 11}));
  refuse(bytes, ErrorCode::unsupported, "has 2 channels");
  refuse(bytes, ErrorCode::unsupported, "has 2 time points", {.channel = "1"});
  refuse(bytes, ErrorCode::bad_argument, "has no time '2'", {.channel = "1", .time = 2});
}

TEST_F(Tiff, ImageJPageCounts) {
  const std::string head = "ImageJ=1.53t\nunit=um\nspacing=1.5\n";
  // Older versions state only the number of images.
  EXPECT_EQ(read(pages(3, head + "images=3\n")).volume.view.grid.size[2], 3U);
  const VolumeFile more = read(pages(5, head + "images=3\nslices=3\n"));
  EXPECT_EQ(more.volume.view.grid.size[2], 5U);
  EXPECT_EQ(more.source.warnings,
            std::vector<std::string>{
                "ImageJ's description states 3 images, the file has 5 pages, which are all read"});
  refuse(pages(5, head + "images=16\nslices=16\n"), ErrorCode::bad_file,
         "states 1 channels x 16 slices x 1 time points, the file has 5 pages");
  refuse(pages(5, head + "images=4\nchannels=2\nslices=2\n"), ErrorCode::bad_file,
         "states 2 channels x 2 slices x 1 time points");
  refuse(pages(2, head + "channels=1000000\nslices=1000000\nframes=1000000\n"), ErrorCode::bad_file,
         "the file has 2 pages");
}

TEST_F(Tiff, ASingleAxisOfPagesIsTheAxisOfSlices) {
  const VolumeFile times = read(pages(5, "ImageJ=1.53t\nimages=5\nframes=5\nunit=um\nspacing=1\n"));
  EXPECT_EQ(pages_read(times), (std::vector{0, 1, 2, 3, 4}));
  EXPECT_EQ(
      times.source.warnings,
      std::vector<std::string>{
          "its 5 pages are labelled as time points of one slice each; they are read as slices"});
  const VolumeFile channels =
      read(pages(9, "ImageJ=1.53t\nimages=9\nchannels=9\nunit=um\nspacing=1\n"));
  EXPECT_EQ(pages_read(channels), (std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(channels.source.warnings.size(), 1U);
  refuse(pages(7, "ImageJ=1.53t\nimages=7\nchannels=7\n"), ErrorCode::unsupported,
         "7 channels x 1 time points of 2-D images");
  refuse(pages(18, "ImageJ=1.53t\nimages=18\nchannels=9\nframes=2\n"), ErrorCode::unsupported,
         "9 channels x 2 time points of 2-D images");
}

TEST_F(Tiff, ImageJCalibration) {
  const std::string head = "ImageJ=1.53t\nimages=2\nslices=2\nspacing=1.5\n";
  const auto values = [&](const std::string& description, TiffPage page = {}) {
    const VolumeFile file = read(pages(2, head + description, page));
    return std::pair{file.volume.view.type, sample_as_double(file.volume, 3)};
  };
  using Pair = std::pair<SampleType, double>;
  EXPECT_EQ(values("cf=0\nc0=-128\nc1=1\nvunit=Gray Value\n"), Pair(SampleType::int8, -125));
  EXPECT_EQ(values("cf=0\nc0=-1024\nc1=2\nvunit=HU\n"), Pair(SampleType::int16, -1018));
  EXPECT_EQ(values("cf=0\nc0=100000\nc1=-2.0\nvunit=x\n"), Pair(SampleType::int32, 99994));
  EXPECT_EQ(values("cf=0\nc0=0.5\nc1=2\nvunit=x\n"), Pair(SampleType::float32, 6.5));
  EXPECT_EQ(values("cf=0\nc0=0\nc1=1E-3\nvunit=x\n"), Pair(SampleType::float32, 0.003F));
  EXPECT_EQ(values("cf=20\nvunit=Gray Value\n"), Pair(SampleType::uint8, 3));
  EXPECT_EQ(values("cf=0\nc0=5\nc1=2\n"),
            Pair(SampleType::uint8, 3));  // without vunit ImageJ does not apply it
  for (const char* function : {"cf=1\nc0=1\nc1=2\nc2=3\nvunit=x\n", "cf=21\nvunit=U. OD\n",
                               "cf=0\nc0=-5\nc1=1\nvunit=x\nzeroclip=true\n"}) {
    refuse(pages(2, head + function), ErrorCode::unsupported, "calibration function");
  }
  refuse(pages(2, head + "cf=0\nvunit=x\n"), ErrorCode::bad_file, "without two coefficients");
  refuse(pages(2, head + "cf=0\nc0=1\nc1=0\nvunit=x\n"), ErrorCode::bad_file,
         "without two coefficients");
}

// ImageJ reads signed 16-bit samples as unsigned samples with a calibration for signed values;
// together they are the samples themselves.
TEST_F(Tiff, ImageJCalibrationOfSignedSamples) {
  TiffWriter file;
  TiffPage page{
      .samples = "",
      .description =
          "ImageJ=1.53t\nimages=2\nslices=2\nspacing=2\ncf=0\nc0=-32768\nc1=1\nvunit=Gray Value\n",
      .bits = 16,
      .format = 2};
  for (int i = 0; i < 12; ++i) page.samples += std::string("\xFE\xFF", 2);
  file.add(page).add(page);
  const VolumeFile read_file = read(file.bytes());
  EXPECT_EQ(read_file.volume.view.type, SampleType::int16);
  EXPECT_EQ(sample_as_double(read_file.volume, 0), -2);
}

TEST_F(Tiff, ImageJRedGreenBlue) {
  TiffPage page{.samples = samples_of(0, 36),
                .description = "ImageJ=1.53t\nimages=2\nslices=2\nspacing=2\n",
                .values = 3,
                .photometric = 2};
  TiffWriter file;
  file.add(page).add(page);
  refuse(file.bytes(), ErrorCode::unsupported,
         "has 3 channels, expected a choice of one: 0 (red), 1 (green), 2 (blue)");
  for (const std::size_t channel : {0U, 1U, 2U}) {
    const VolumeFile read_file = read(file.bytes(), {.channel = std::to_string(channel)});
    EXPECT_EQ(sample_as_double(read_file.volume, 5), 15 + static_cast<double>(channel));
  }
}

// ---------------------------------------------------------------- one page for all images

std::string big_stack(std::size_t pages_promised, std::size_t pages_there, bool is_big_endian) {
  TiffPage page{.samples = "",
                .description = "ImageJ=1.53t\nimages=" + std::to_string(pages_promised) +
                               "\nchannels=2\nslices=" + std::to_string(pages_promised / 2) +
                               "\nspacing=2\n",
                .bits = 16,
                .strip_bytes = 24};
  for (std::size_t i = 0; i < pages_there * 12; ++i) {
    page.samples += is_big_endian
                        ? std::string{static_cast<char>(i / 12), static_cast<char>(i % 12)}
                        : std::string{static_cast<char>(i % 12), static_cast<char>(i / 12)};
  }
  return TiffWriter(is_big_endian).add(page).bytes();
}

TEST_F(Tiff, ImagesAfterTheOnlyPage) {
  for (const bool is_big_endian : {false, true}) {
    const VolumeFile file = read(big_stack(6, 6, is_big_endian), {.channel = "1"});
    ASSERT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{4, 3, 3}));
    for (std::size_t i = 0; i < 36; ++i) {
      EXPECT_EQ(sample_as_double(file.volume, i),
                static_cast<double>((i / 12 * 2 + 1) * 256 + i % 12));
    }
  }
  refuse(big_stack(40, 6, false), ErrorCode::bad_file, "the header states 960 bytes of samples",
         {.channel = "1"});
  refuse(big_stack(1000000, 6, false), ErrorCode::bad_file, "the header states", {.channel = "1"});
  // Found by a fuzzer: a list of a million channels was allocated first.
  TiffPage page{.samples = samples_of(0),
                .description = "ImageJ=1.53t\nchannels=1000000\nslices=1000000\nframes=1000000\n"};
  refuse(TiffWriter().add(page).bytes(), ErrorCode::bad_file, "the header states");
}

TEST_F(Tiff, ImagesAfterTheOnlyPageMustBeUncompressed) {
  TiffPage page{.samples = samples_of(0),
                .description = "ImageJ=1.53t\nimages=16\nslices=16\n",
                .more = {{259, 3, {32773}}}};
  refuse(TiffWriter().add(page).bytes(), ErrorCode::bad_file,
         "states 1 channels x 16 slices x 1 time points, the file has 1 page");
  page.more = {{322, 4, {16}}, {323, 4, {16}}, {324, 4, {8}}, {325, 4, {256}}};
  refuse(TiffWriter().add(page).bytes(), ErrorCode::bad_file, "the file has 1 page");
}

TEST_F(Tiff, TifffilesTruncatedStack) {
  TiffPage page{.samples = samples_of(0) + samples_of(1),
                .description = R"({"truncated": true, "shape": [2, 3, 4]})",
                .strip_bytes = 12};
  EXPECT_EQ(pages_read(read(TiffWriter().add(page).bytes())), (std::vector{0, 1}));
  page.description = R"({"truncated": true, "shape": [999999, 3, 4]})";
  refuse(TiffWriter().add(page).bytes(), ErrorCode::bad_file, "the header states");
}

// Descriptions of other programs, geographic positions, colour profiles, ImageJ's regions of
// interest.
TEST_F(Tiff, TagsThatDoNotConcernSamplesAreIgnored) {
  for (const char* description :
       {"Aperio Image Library v11\n40x|MPP = 0.25",
        "<MetaData><prop id=\"spatial-calibration-x\" value=\"2\"/></MetaData>",
        "SI.hRoiManager.scanZoomFactor = 2", "any text"}) {
    SCOPED_TRACE(description);
    TiffPage page;
    page.more = {{33550, 4, {2, 2, 0}},
                 {33922, 4, {0, 0, 0, 9, 9, 0}},
                 {34675, 1, {1, 2, 3, 4}},
                 {50839, 1, {1, 2, 3, 4}}};
    const VolumeFile file = read(pages(3, description, page));
    EXPECT_EQ(pages_read(file), (std::vector{0, 1, 2}));
    EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 1, 1}));
    EXPECT_FALSE(file.source.has_spacing);
  }
}

// ---------------------------------------------------------------- OME

std::string ome(const std::string& pixels, const std::string& inside,
                const std::string& attributes = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><OME "
         "xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\" " +
         attributes +
         "><Image ID=\"Image:0\" Name=\"cell\"><Pixels ID=\"Pixels:0\" Type=\"uint8\" SizeX=\"4\" "
         "SizeY=\"3\" " +
         pixels + ">" + inside + "</Pixels></Image></OME>";
}

constexpr const char* kStack = R"(DimensionOrder="XYZCT" SizeZ="3" SizeC="1" SizeT="1")";
constexpr const char* kAll = "<TiffData/>";

TEST_F(Tiff, OmeDimensionOrders) {
  // Strides of channel (2), slice (3) and time (2) in each order.
  const std::vector<std::pair<std::string, std::array<int, 3>>> orders{
      {"XYZCT", {3, 1, 6}}, {"XYZTC", {6, 1, 3}}, {"XYCZT", {1, 2, 6}},
      {"XYCTZ", {1, 4, 2}}, {"XYTCZ", {2, 4, 1}}, {"XYTZC", {6, 2, 1}}};
  for (const auto& [order, stride] : orders) {
    SCOPED_TRACE(order);
    const std::string bytes =
        pages(12, ome("DimensionOrder=\"" + order + R"(" SizeZ="3" SizeC="2" SizeT="2")",
                      R"(<Channel ID="c:0" Name="DAPI"/><Channel ID="c:1" Name="GFP"/><TiffData)"
                      R"( IFD="0" PlaneCount="12"/>)"));
    for (const int c : {0, 1}) {
      for (const int t : {0, 1}) {
        const int first = c * stride[0] + t * stride[2];
        const ReadOptions options{.channel = std::to_string(c),
                                  .time = static_cast<std::size_t>(t)};
        EXPECT_EQ(pages_read(read(bytes, options)),
                  (std::vector{first, first + stride[1], first + 2 * stride[1]}));
      }
    }
    refuse(bytes, ErrorCode::unsupported,
           "has 2 channels, expected a choice of one: 0 (DAPI), 1 (GFP)");
  }
}

TEST_F(Tiff, OmeStagePositionsAreIgnored) {
  const std::string planes =
      R"(<TiffData/><Plane TheZ="0" TheC="0" TheT="0" PositionX="500" PositionY="20")"
      R"( PositionZ="3"/>)";
  const VolumeFile file = read(pages(
      3, ome(std::string(kStack) + R"( PhysicalSizeX="1" PhysicalSizeY="1" PhysicalSizeZ="2")",
             planes)));
  EXPECT_EQ(pages_read(file), (std::vector{0, 1, 2}));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{}));
  EXPECT_EQ(file.source.warnings, kNone);
}

TEST_F(Tiff, OmePagesWithoutAPlaneGiveAWarning) {
  const VolumeFile file =
      read(pages(3, ome(R"(DimensionOrder="XYZCT" SizeZ="2" SizeC="1" SizeT="1")",
                        R"(<TiffData IFD="0" PlaneCount="2"/>)")));
  EXPECT_EQ(pages_read(file), (std::vector{0, 1}));
  ASSERT_FALSE(file.source.warnings.empty());
  EXPECT_EQ(file.source.warnings.front(),
            "has 3 pages, of which its OME-XML names 2; the others are not read");
}

TEST_F(Tiff, OmeLengthsAndUnits) {
  const auto lengths = [&](const std::string& attributes) {
    return read(pages(3, ome(kStack + (" " + attributes), kAll)));
  };
  const VolumeFile mixed =
      lengths(R"(PhysicalSizeX="200" PhysicalSizeXUnit="nm" PhysicalSizeY="0.3")"
              R"( PhysicalSizeZ="0.0005" PhysicalSizeZUnit="mm")");
  expect_size_and_spacing(mixed.volume, {4, 3, 3}, {200, 300, 500}, 1e-9);
  EXPECT_EQ(mixed.volume.view.grid.unit, LengthUnit::nanometre);
  const VolumeFile flat = lengths(R"(PhysicalSizeX="0.2" PhysicalSizeY="0.3")");
  EXPECT_EQ(flat.volume.view.grid.spacing, (Vec3{0.2, 0.3, 1}));
  EXPECT_EQ(flat.source.warnings,
            std::vector<std::string>{"states no voxel size along z; 1 um is assumed there"});
  const VolumeFile angstrom = lengths(
      "PhysicalSizeX=\"2\" PhysicalSizeXUnit=\"\u00C5\" PhysicalSizeY=\"0.2\" "
      "PhysicalSizeYUnit=\"nm\" "
      "PhysicalSizeZ=\"2\" PhysicalSizeZUnit=\"\u00C5\"");
  EXPECT_EQ(angstrom.volume.view.grid.unit, LengthUnit::angstrom);
  EXPECT_NEAR(angstrom.volume.view.grid.spacing.y, 2, 1e-12);
  const VolumeFile pixels = lengths(
      R"(PhysicalSizeX="2" PhysicalSizeXUnit="pixel" PhysicalSizeY="2" PhysicalSizeYUnit="pixel" )"
      R"(PhysicalSizeZ="3" PhysicalSizeZUnit="pixel")");
  EXPECT_EQ(pixels.volume.view.grid.unit, LengthUnit::unknown);
  EXPECT_EQ(pixels.source.warnings, kNone);
  const VolumeFile none = lengths(R"(PhysicalSizeX="0" PhysicalSizeY="-1" PhysicalSizeZ="NaN")");
  EXPECT_FALSE(none.source.has_spacing);
  refuse(pages(3, ome(std::string(kStack) +
                          R"( PhysicalSizeX="1" PhysicalSizeXUnit="ly" PhysicalSizeY="1")"
                          R"( PhysicalSizeZ="1")",
                      kAll)),
         ErrorCode::unsupported, "some have a known unit and some do not");
}

TEST_F(Tiff, OmePlanesByPage) {
  // Slices in reverse order, one block each.
  const std::string reverse =
      R"(<TiffData FirstZ="2" IFD="0"/><TiffData FirstZ="1" IFD="1"/><TiffData FirstZ="0")"
      R"( IFD="2"/>)";
  EXPECT_EQ(pages_read(read(pages(3, ome(kStack, reverse)))), (std::vector{2, 1, 0}));
  // The first page belongs to something else.
  EXPECT_EQ(pages_read(read(pages(4, ome(kStack, R"(<TiffData IFD="1" PlaneCount="3"/>)")))),
            (std::vector{1, 2, 3}));
  EXPECT_EQ(pages_read(read(pages(5, ome(kStack, kAll)))), (std::vector{0, 1, 2}));
  refuse(pages(3, ome(kStack, R"(<TiffData IFD="0"/><TiffData IFD="1" FirstZ="1"/>)")),
         ErrorCode::bad_file, "names no page for channel 0, slice 2");
  refuse(pages(2, ome(kStack, R"(<TiffData IFD="0" PlaneCount="3"/>)")), ErrorCode::bad_file,
         "states a page 3, the file has 2");
  refuse(pages(2, ome(kStack, kAll)), ErrorCode::bad_file, "names no page for channel 0, slice 2");
  refuse(pages(3, ome(kStack, R"(<TiffData IFD="0" FirstZ="3"/>)")), ErrorCode::bad_file,
         "beyond its own sizes");
  refuse(pages(3, ome(kStack, R"(<TiffData IFD="18446744073709551615" PlaneCount="3"/>)")),
         ErrorCode::unsupported, "has no planes of its OME image");
  refuse(pages(3, ome(kStack, "")), ErrorCode::unsupported, "has no TiffData");
}

TEST_F(Tiff, OmeOverSeveralFiles) {
  const auto block = [](int z, const std::string& uuid, const std::string& file) {
    return "<TiffData IFD=\"0\" FirstZ=\"" + std::to_string(z) + "\"><UUID FileName=\"" + file +
           "\">" + uuid + "</UUID></TiffData>";
  };
  const std::string two = R"(DimensionOrder="XYZCT" SizeZ="2" SizeC="1" SizeT="1")";
  const std::string own = R"(UUID="urn:uuid:1")";
  refuse(pages(2, ome(two, block(0, "urn:uuid:1", "a.tif") + block(1, "urn:uuid:2", "b.tif"), own)),
         ErrorCode::unsupported,
         "is one of several files of an OME-TIFF: channel 0, slice 1, time 0 is in 'b.tif'");
  refuse(pages(2, ome(two, block(0, "urn:uuid:3", "c.tif") + block(1, "urn:uuid:2", "b.tif"), own)),
         ErrorCode::unsupported, "which are in 'c.tif'");
  // A file is identified by its UUID, so it may be renamed; a file without a UUID by its name.
  const auto whole = [](const std::string& file) {
    return "<TiffData IFD=\"0\" PlaneCount=\"2\"><UUID FileName=\"" + file +
           "\">urn:uuid:1</UUID></TiffData>";
  };
  EXPECT_EQ(pages_read(read(pages(2, ome(two, whole("old name.tif"), own)))), (std::vector{0, 1}));
  EXPECT_EQ(pages_read(read(pages(2, ome(two, whole("./a.tif"))))), (std::vector{0, 1}));
  refuse(pages(2, ome(two, whole("old name.tif"))), ErrorCode::unsupported, "'old name.tif'");
  // A channel in this file can be read.
  const std::string channels =
      R"(<TiffData IFD="0" FirstC="1" PlaneCount="2"/>)"
      R"(<TiffData IFD="0" PlaneCount="2"><UUID FileName="b.tif">urn:uuid:2</UUID></TiffData>)";
  const std::string bytes =
      pages(2, ome(R"(DimensionOrder="XYZCT" SizeZ="2" SizeC="2" SizeT="1")", channels, own));
  EXPECT_EQ(pages_read(read(bytes, {.channel = "1"})), (std::vector{0, 1}));
  refuse(bytes, ErrorCode::unsupported, "channel 0, slice 0, time 0 is in 'b.tif'",
         {.channel = "0"});
  refuse(pages(2, R"(<?xml version="1.0"?><OME xmlns="x"><BinaryOnly)"
                  R"( MetadataFile="set.companion.ome" UUID="urn:uuid:9"/></OME>)"),
         ErrorCode::unsupported, "its OME-XML is in another file, 'set.companion.ome'");
}

TEST_F(Tiff, OmeSeries) {
  const auto image = [](const std::string& name, int first, int slices) {
    return "<Image ID=\"i" + std::to_string(first) + "\" Name=\"" + name +
           "\"><Pixels DimensionOrder=\"XYCZT\" Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"" +
           std::to_string(slices) + "\" SizeC=\"1\" SizeT=\"1\"><TiffData IFD=\"" +
           std::to_string(first) + "\" PlaneCount=\"" + std::to_string(slices) +
           "\"/></Pixels></Image>";
  };
  const std::string bytes =
      pages(5, "<OME>" + image("left", 0, 2) + image("right", 2, 3) + "</OME>");
  refuse(bytes, ErrorCode::unsupported,
         "has 2 series, expected a choice of one: 0 (left), 1 (right)");
  EXPECT_EQ(pages_read(read(bytes, {.series = "0"})), (std::vector{0, 1}));
  const VolumeFile right = read(bytes, {.series = "right"});
  EXPECT_EQ(pages_read(right), (std::vector{2, 3, 4}));
  ASSERT_EQ(right.source.choices.size(), 1U);
  EXPECT_EQ(right.source.choices[0].selected, 1U);
}

TEST_F(Tiff, OmeThatIsInvalid) {
  refuse(pages(3, "<OME><Image><Pixels"), ErrorCode::bad_file, "OME-XML is damaged after");
  refuse(pages(3, "<OME></OME>"), ErrorCode::bad_file, "describes no image");
  refuse(pages(3, "<OME><Image/></OME>"), ErrorCode::bad_file, "has no Pixels");
  for (const char* sizes :
       {R"(SizeZ="0" SizeC="1" SizeT="1")", R"(SizeZ="-3" SizeC="1" SizeT="1")",
        R"(SizeZ="3" SizeC="1")", R"(SizeZ="3" SizeC="99999999999999999999" SizeT="1")",
        R"(SizeZ="3" SizeC="1e9" SizeT="1")"}) {
    refuse(pages(3, ome(std::string(R"(DimensionOrder="XYZCT" )") + sizes, kAll)),
           ErrorCode::bad_file, "expected a number from 1 to 1000000");
  }
  for (const char* order : {"", "XYZZT", "ZYXCT", "XYZCTS"}) {
    refuse(pages(3, ome(std::string("DimensionOrder=\"") + order +
                            R"(" SizeZ="3" SizeC="1" SizeT="1")",
                        kAll)),
           ErrorCode::bad_file, "DimensionOrder");
  }
  // Many planes in other files, named repeatedly, must not take minutes.
  std::string blocks;
  for (int i = 0; i < 30; ++i)
    blocks +=
        R"(<TiffData PlaneCount="999999"><UUID FileName="b.tif">urn:uuid:2</UUID></TiffData>)";
  refuse(pages(3, ome(R"(DimensionOrder="XYZCT" SizeZ="1000000" SizeC="1" SizeT="1")",
                      "<TiffData IFD=\"0\"/>" + blocks, R"(UUID="urn:uuid:1")")),
         ErrorCode::bad_file, "places more than");
}

TEST_F(Tiff, OmeSizesThatDiffer) {
  const std::string description =
      R"(<OME><Image><Pixels DimensionOrder="XYZCT" SizeX="8" SizeY="6" SizeZ="2" SizeC="1")"
      R"( SizeT="1"><TiffData/></Pixels></Image></OME>)";
  const VolumeFile file = read(pages(2, description));
  EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{4, 3, 2}));
  EXPECT_EQ(file.source.warnings[0],
            "OME-XML states 8 x 6 samples, its pages have 4 x 3; the sizes of the pages are used");
}

TEST_F(Tiff, OmeSlicesThatAreAngles) {
  std::string description = ome(kStack, kAll);
  description.insert(description.find("</OME>"),
                     "<StructuredAnnotations><M:ModuloAlongZ xmlns:M=\"m\" "
                     "Type=\"angle\"/></StructuredAnnotations>");
  EXPECT_EQ(read(pages(3, description)).source.warnings[0],
            "its slices are those of several angles, phases or the like (ModuloAlongZ)");
}

TEST_F(Tiff, OmeChannelsWithinPages) {
  TiffPage page{.samples = samples_of(0, 36), .values = 3, .photometric = 2};
  page.description = ome(R"(DimensionOrder="XYCZT" SizeZ="2" SizeC="3" SizeT="1")",
                         R"(<Channel SamplesPerPixel="3" Name="photo"/><TiffData/>)");
  TiffWriter file;
  file.add(page).add(page);
  refuse(file.bytes(), ErrorCode::unsupported, "0 (photo 0), 1 (photo 1), 2 (photo 2)");
  EXPECT_EQ(sample_as_double(read(file.bytes(), {.channel = "2"}).volume, 5), 17);
  page.description = ome(R"(DimensionOrder="XYCZT" SizeZ="2" SizeC="2" SizeT="1")", kAll);
  refuse(TiffWriter().add(page).add(page).bytes(), ErrorCode::bad_file,
         "states 2 channels (SizeC), but its pages hold 3 each");
}

// ---------------------------------------------------------------- tifffile, SCIFIO, LSM, MetaMorph

TEST_F(Tiff, TifffilesShapes) {
  EXPECT_EQ(pages_read(read(pages(3, R"({"shape": [3, 3, 4]})"))), (std::vector{0, 1, 2}));
  EXPECT_EQ(pages_read(read(pages(3, R"({"shape": [1, 3, 1, 3, 4], "axes": "TZCYX"})"))),
            (std::vector{0, 1, 2}));
  const std::string channels = pages(6, R"({"axes": "CZYX", "shape": [2, 3, 3, 4]})");
  EXPECT_EQ(pages_read(read(channels, {.channel = "1"})), (std::vector{3, 4, 5}));
  refuse(channels, ErrorCode::unsupported, "has 2 channels");
  EXPECT_EQ(pages_read(read(pages(6, R"({"axes": "ZTYX", "shape": [3, 2, 3, 4]})"), {.time = 1})),
            (std::vector{1, 3, 5}));
  refuse(pages(6, R"({"shape": [2, 3, 3, 4]})"), ErrorCode::unsupported,
         "an array of 2 x 3 without names of its axes");
  refuse(pages(6, R"({"axes": "RZYX", "shape": [2, 3, 3, 4]})"), ErrorCode::unsupported,
         "with axes 'RZ'");
  for (const std::string axes : {"XYZ", "ZXY", "YXZ"})
    refuse(pages(3, R"({"axes": ")" + axes + R"(", "shape": [3, 3, 4]})"), ErrorCode::unsupported,
           "its axes are '" + axes + "', slowest first");
  // A description that was not updated when pages were added.
  const VolumeFile stale = read(pages(4, R"({"shape": [3, 3, 4]})"));
  EXPECT_EQ(stale.volume.view.grid.size[2], 4U);
  EXPECT_EQ(stale.source.warnings[0],
            "its description states an array of 3 x 3 x 4, which does not match its 4 pages; they "
            "are read "
            "as slices");
  for (const char* odd : {R"({"shape": [})", R"({"shape": [99999999999999999999999, 3, 4]})",
                          R"({"shape": "x"})", R"({"shape": [0, 3, 4]})"}) {
    EXPECT_EQ(read(pages(3, odd)).volume.view.grid.size[2], 3U) << odd;
  }
}

TEST_F(Tiff, TifffilesSeries) {
  TiffWriter series;
  for (int i = 0; i < 5; ++i) {
    series.add({.samples = samples_of(static_cast<std::size_t>(i)),
                .description = i == 0   ? R"({"shape": [2, 3, 4]})"
                               : i == 2 ? R"({"shape": [3, 3, 4]})"
                                        : ""});
  }
  refuse(series.bytes(), ErrorCode::unsupported,
         "has 2 series, expected a choice of one: 0 (2 x 3 x 4), 1 (3 x 3 x 4)");
  EXPECT_EQ(pages_read(read(series.bytes(), {.series = "1"})), (std::vector{2, 3, 4}));
  TiffWriter one_by_one;
  for (std::size_t i = 0; i < 4; ++i)
    one_by_one.add({.samples = samples_of(i), .description = R"({"shape": [3, 4]})"});
  EXPECT_EQ(pages_read(read(one_by_one.bytes())), (std::vector{0, 1, 2, 3}));
}

TEST_F(Tiff, ScifiosAxes) {
  const VolumeFile file = read(pages(6,
                                     "SCIFIO=0.45\naxes=X,Y,Channel,Z\nlengths=4,3,2,3\nscales=0.5,"
                                     "0.5,1.0,2.0\nunits=\\u00B5m,\\u00B5m,null,\\u00B5m\n"),
                               {.channel = "1"});
  EXPECT_EQ(pages_read(file), (std::vector{1, 3, 5}));
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
  EXPECT_EQ(file.source.warnings, kNone);
  EXPECT_FALSE(
      read(
          pages(
              3,
              "SCIFIO=0.45\naxes=X,Y,Z\nlengths=4,3,3\nscales=1.0,1.0,1.0\nunits=null,null,null\n"))
          .source.has_spacing);
  refuse(pages(3, "SCIFIO=0.45\naxes=X,Y,Z\nlengths=4,3,5\nscales=1,1,1\nunits=um,um,um\n"),
         ErrorCode::bad_file, "states 5 pages, the file has 3");
  refuse(pages(3, "SCIFIO=0.45\naxes=X,Y,Lifetime\nlengths=4,3,3\nscales=1,1,1\nunits=um,um,um\n"),
         ErrorCode::unsupported, "an axis 'Lifetime'");
  refuse(pages(3, "SCIFIO=0.45\naxes=X\nlengths=4\n"), ErrorCode::bad_file, "X and Y first");
}

std::string lsm_info(std::int32_t slices, std::int32_t times, std::uint16_t scan_type) {
  std::string info(500, '\0');
  const auto put = [&](std::size_t place, auto value) {
    std::memcpy(info.data() + place, &value, sizeof value);
  };
  put(16, slices);
  put(24, times);
  put(40, 2.5e-7);
  put(48, 3e-7);
  put(56, 1e-6);
  put(88, scan_type);
  return info;
}

TEST_F(Tiff, ZeissLsm) {
  const auto file = [](const std::string& info) {
    TiffWriter writer;
    for (std::size_t i = 0; i < 4; ++i) {
      writer.add(
          {.samples = samples_of(i),
           .more = i == 0 ? std::vector<TiffTag>{{34412, 1, {}, info}} : std::vector<TiffTag>{}});
      writer.add({.width = 2,
                  .height = 2,
                  .samples = "abcd",
                  .more = {{254, 4, {1}}}});  // a preview after each page
    }
    return writer.bytes();
  };
  const VolumeFile stack = read(file(lsm_info(4, 1, 0)));
  EXPECT_EQ(pages_read(stack), (std::vector{0, 1, 2, 3}));
  expect_size_and_spacing(stack.volume, {4, 3, 4}, {0.25, 0.3, 1}, 1e-12);
  EXPECT_EQ(stack.volume.view.grid.unit, LengthUnit::micrometre);
  EXPECT_EQ(decision(stack, "previews"), "4 reduced pages or masks ignored");
  EXPECT_EQ(pages_read(read(file(lsm_info(2, 2, 0)), {.time = 1})), (std::vector{2, 3}));
  refuse(file(lsm_info(4, 1, 6)), ErrorCode::unsupported, "is a Zeiss LSM file of scan type 6");
  refuse(file(lsm_info(3, 1, 0)), ErrorCode::unsupported, "4 pages for 3 slices");
}

TEST_F(Tiff, MetaMorphStackIsRefusedByName) {
  TiffPage page{.samples = samples_of(0), .more = {{33629, 5, std::vector<std::uint32_t>(12, 1)}}};
  refuse(TiffWriter().add(page).bytes(), ErrorCode::unsupported, "is a MetaMorph stack (STK)");
}

// ---------------------------------------------------------------- samples

TEST_F(Tiff, PackedBits) {
  for (unsigned bits = 1; bits < 16; ++bits) {
    SCOPED_TRACE(bits);
    TiffWriter file;
    std::vector<unsigned> values;
    for (unsigned page = 0; page < 2; ++page) {
      std::string packed;
      for (unsigned row = 0; row < 3; ++row) {  // each row begins in a new byte
        std::string row_bits;
        for (unsigned i = 0; i < 5; ++i) {
          const unsigned value = (page * 40503 + row * 9973 + i * 30011 + 1) & ((1U << bits) - 1);
          values.push_back(value);
          for (unsigned bit = bits; bit-- > 0;) row_bits += (value >> bit & 1U) != 0 ? '1' : '0';
        }
        row_bits.resize((row_bits.size() + 7) / 8 * 8, '0');
        for (std::size_t i = 0; i < row_bits.size(); i += 8)
          packed += static_cast<char>(std::stoi(row_bits.substr(i, 8), nullptr, 2));
      }
      file.add({.width = 5, .samples = packed, .bits = bits});
    }
    const VolumeFile read_file = read(file.bytes());
    EXPECT_EQ(read_file.volume.view.type, bits <= 8 ? SampleType::uint8 : SampleType::uint16);
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(sample_as_double(read_file.volume, i), values[i]) << i;
  }
}

TEST_F(Tiff, HalfPrecision) {
  const std::vector<std::pair<std::uint16_t, float>> halves{
      {0x0000, 0.0F},     {0x8000, -0.0F},    {0x0001, 0x1p-24F},  {0x83FF, -1023 * 0x1p-24F},
      {0x0400, 0x1p-14F}, {0x3C00, 1.0F},     {0xC000, -2.0F},     {0x3555, 1365 * 0x1p-12F},
      {0x7BFF, 65504.0F}, {0x7C00, INFINITY}, {0xFC00, -INFINITY}, {0x7E00, NAN}};
  TiffPage page{.bits = 16, .format = 3};
  for (const auto& half : halves)
    page.samples +=
        std::string{static_cast<char>(half.first & 0xFF), static_cast<char>(half.first >> 8)};
  const VolumeFile file = read(TiffWriter().add(page).add(page).bytes());
  ASSERT_EQ(file.volume.view.type, SampleType::float32);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const auto value = static_cast<float>(sample_as_double(file.volume, i));
    if (std::isnan(halves[i].second)) {
      EXPECT_TRUE(std::isnan(value));
    } else {
      EXPECT_EQ(value, halves[i].second);
      EXPECT_EQ(std::signbit(value), std::signbit(halves[i].second));
    }
  }
}

TEST_F(Tiff, PhotometricAndOrientation) {
  const VolumeFile white = read(pages(2, "", {.photometric = 0}));
  EXPECT_EQ(pages_read(white), (std::vector{0, 1}));
  EXPECT_EQ(decision(white, "photometric"), "white is zero; samples are kept as stored");
  const VolumeFile turned = read(pages(2, "", {.more = {{274, 3, {4}}}}));
  EXPECT_EQ(pages_read(turned), (std::vector{0, 1}));
  EXPECT_EQ(turned.source.warnings[0],
            "states an orientation (4) other than top left; rows and columns are kept as stored");
  refuse(pages(2, "", {.photometric = 5}), ErrorCode::unsupported, "has colour pages (CMYK)");
  TiffPage video{.samples = samples_of(0, 36), .values = 3, .photometric = 6};
  refuse(TiffWriter().add(video).add(video).bytes(), ErrorCode::unsupported,
         "has colour pages (YCbCr)");
  refuse(pages(2, "", {.photometric = 32803}), ErrorCode::unsupported, "colour filter array");
}

TEST_F(Tiff, AlphaIsAChannelOfItsOwn) {
  TiffPage page{.samples = samples_of(0, 24), .values = 2, .more = {{338, 3, {2}}}};
  refuse(TiffWriter().add(page).add(page).bytes(), ErrorCode::unsupported, "0, 1 (alpha)");
  EXPECT_EQ(
      sample_as_double(read(TiffWriter().add(page).add(page).bytes(), {.channel = "0"}).volume, 4),
      8);
}

TEST_F(Tiff, SampleTypesThatAreRefused) {
  const auto of = [](std::uint32_t bits, std::uint32_t format) {
    TiffPage page{.samples = std::string(96 * 2, 'a'), .bits = bits, .format = format};
    return TiffWriter().add(page).add(page).bytes();
  };
  refuse(of(64, 6), ErrorCode::unsupported, "complex samples of 64 bits");
  refuse(of(24, 3), ErrorCode::unsupported, "floating point samples of 24 bits");
  refuse(of(12, 2), ErrorCode::unsupported, "signed integer samples of 12 bits");
  refuse(of(128, 1), ErrorCode::unsupported, "unsigned integer samples of 128 bits");
}

TEST_F(Tiff, PagesOfSeveralLayers) {
  refuse(pages(2, "", {.more = {{32997, 4, {2}}}}), ErrorCode::unsupported,
         "has pages of 2 layers each (ImageDepth)");
}

TEST_F(Tiff, CompressionThatLibtiffLacks) {
  refuse(pages(2, "", {.more = {{259, 3, {34712}}}}), ErrorCode::unsupported,
         "is compressed with scheme 34712");
}

TEST_F(Tiff, PreviewsAndMasks) {
  TiffWriter file;
  file.add({.width = 2, .height = 2, .samples = "abcd", .more = {{254, 4, {1}}}});
  for (std::size_t i = 0; i < 3; ++i)
    file.add(
        {.samples = samples_of(i), .more = {{254, 4, {2}}}});  // marked as one of several pages
  file.add({.samples = samples_of(9), .more = {{254, 4, {4}}}});
  EXPECT_EQ(pages_read(read(file.bytes())), (std::vector{0, 1, 2}));
  refuse(pages(2, "", {.more = {{254, 4, {1}}}}), ErrorCode::unsupported,
         "previews and masks of other pages only");
}

void write_with_libtiff(const std::filesystem::path& path, std::uint16_t compression,
                        std::uint16_t bits, bool is_separate, bool is_tiled,
                        std::uint16_t predictor = PREDICTOR_NONE) {
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  ASSERT_NE(tiff, nullptr);
  const std::uint16_t values = is_separate ? 2 : 1;
  for (int page = 0; page < 3; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 48);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 40);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, values);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
    if (predictor != PREDICTOR_NONE) TIFFSetField(tiff, TIFFTAG_PREDICTOR, predictor);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG,
                 is_separate ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    if (is_tiled) {
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 32);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
    }
    const tmsize_t piece = is_tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
    const std::uint32_t count = is_tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    for (std::uint32_t i = 0; i < count; ++i) {
      std::string bytes(static_cast<std::size_t>(piece),
                        static_cast<char>(page * 50 + 1 + static_cast<int>(i)));
      const bool is_last = !is_tiled && i % 3 == 2;  // 40 rows: the third strip has 8
      const tmsize_t length = is_last ? piece / 2 : piece;
      ASSERT_EQ(is_tiled ? TIFFWriteEncodedTile(tiff, i, bytes.data(), length)
                         : TIFFWriteEncodedStrip(tiff, i, bytes.data(), length),
                length);
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

TEST_F(Tiff, CompressionsAndLayouts) {
  int tried = 0;
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                COMPRESSION_PACKBITS, COMPRESSION_ZSTD, COMPRESSION_LZMA}) {
    if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression)) == 0) continue;
    for (const bool is_separate : {false, true}) {
      for (const bool is_tiled : {false, true}) {
        SCOPED_TRACE(std::to_string(compression) + (is_separate ? " separate" : "") +
                     (is_tiled ? " tiled" : ""));
        const bool has_predictor = compression != COMPRESSION_NONE &&
                                   compression != COMPRESSION_PACKBITS && is_separate != is_tiled;
        write_with_libtiff(folder_ / "c.tif", static_cast<std::uint16_t>(compression), 8,
                           is_separate, is_tiled,
                           has_predictor ? PREDICTOR_HORIZONTAL : PREDICTOR_NONE);
        ReadOptions options;
        if (is_separate) options.channel = "1";
        const VolumeFile file = read_volume_file(folder_ / "c.tif", options);
        ASSERT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{48, 40, 3}));
        for (std::size_t i = 0; i < file.volume.view.grid.sample_count(); ++i) {
          const std::size_t x = i % 48, y = i / 48 % 40, page = i / 48 / 40;
          const std::size_t piece = is_tiled ? y / 16 * 2 + x / 32 : y / 16;
          const std::size_t of_plane = is_separate ? (is_tiled ? 6 : 3) : 0;
          ASSERT_EQ(sample_as_double(file.volume, i),
                    static_cast<double>(page * 50 + 1 + of_plane + piece))
              << i;
        }
        ++tried;
      }
    }
  }
  EXPECT_GE(tried, 16);
}

TEST_F(Tiff, PredictorThatLibtiffDoesNotUndoIsRefused) {
  for (const bool is_big_tiff : {false, true}) {
    for (const std::uint32_t compression : {COMPRESSION_NONE, COMPRESSION_PACKBITS}) {
      TiffPage page;
      page.samples = samples_of(0);
      page.more = {{317, 3, {2}}, {259, 3, {compression}}};
      const std::string bytes = TiffWriter(false, is_big_tiff).add(page).add(page).bytes();
      refuse(bytes, ErrorCode::unsupported, "has predictor 2 with compression");
    }
    TiffPage page;
    page.samples = samples_of(0);
    page.more = {{317, 3, {1}}};
    EXPECT_EQ(
        read(TiffWriter(true, is_big_tiff).add(page).add(page).bytes()).volume.view.grid.size[2],
        2U);
  }
}

// Fax and photograph decoders continue after the end of their data and invent the rest.
TEST_F(Tiff, DamagedStreamsAreNeverFilledUp) {
  for (const auto& [compression, bits] : {std::pair{COMPRESSION_CCITTFAX4, 1},
                                          {COMPRESSION_CCITTFAX3, 1},
                                          {COMPRESSION_JPEG, 8},
                                          {COMPRESSION_LZW, 8},
                                          {COMPRESSION_ADOBE_DEFLATE, 8},
                                          {COMPRESSION_PACKBITS, 8}}) {
    if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression)) == 0) continue;
    SCOPED_TRACE(compression);
    write_with_libtiff(folder_ / "d.tif", static_cast<std::uint16_t>(compression),
                       static_cast<std::uint16_t>(bits), false, false);
    EXPECT_EQ(read_volume_file(folder_ / "d.tif").volume.view.grid.size[2], 3U);
    TIFF* tiff = TIFFOpen((folder_ / "d.tif").c_str(), "r");
    const std::uint64_t start = TIFFGetStrileOffset(tiff, 1),
                        length = TIFFGetStrileByteCount(tiff, 1);
    TIFFClose(tiff);
    std::string bytes = read_bytes(folder_ / "d.tif");
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(start), length, '\0');
    write_bytes(folder_ / "d.tif", bytes);
    expect_error(ErrorCode::bad_file, "is cut off or damaged in page 1", folder_ / "d.tif",
                 [&] { read_volume_file(folder_ / "d.tif"); });
  }
}

// ---------------------------------------------------------------- structure

TEST_F(Tiff, LoopOfPages) {
  for (const bool is_big_tiff : {false, true}) {
    TiffWriter file(false, is_big_tiff);
    file.add({.samples = samples_of(0)}).add({.samples = samples_of(1)});
    EXPECT_EQ(pages_read(read(file.bytes())), (std::vector{0, 1}));
    refuse(file.ring(), ErrorCode::bad_file, "its pages form a loop");
  }
}

TEST_F(Tiff, CutAnywhere) {
  for (const bool is_big_tiff : {false, true}) {
    TiffWriter file(is_big_tiff, is_big_tiff);
    file.add({.samples = samples_of(0)})
        .add({.samples = samples_of(1),
              .description = "a description that does not fit in its tag"});
    for (std::size_t bytes = 1; bytes < file.bytes().size(); ++bytes) {
      write_bytes(folder_ / "cut.tif", file.bytes().substr(0, bytes));
      expect_error(ErrorCode::bad_file, "", folder_ / "cut.tif",
                   [&] { read_volume_file(folder_ / "cut.tif"); });
    }
  }
}

TEST_F(Tiff, HostileSizes) {
  const std::string huge = "far more than a file of";
  const auto page = [](std::uint32_t width, std::uint32_t height, std::uint32_t values = 1,
                       std::uint16_t compression = 1) {
    TiffPage result{.width = width,
                    .height = height,
                    .samples = "abc",
                    .values = values,
                    .more = {{259, 3, {compression}}}};
    return TiffWriter().add(result).add(result).bytes();
  };
  refuse(page(100000, 100000), ErrorCode::bad_file, huge);
  refuse(page(400000, 300000, 3), ErrorCode::bad_file, huge, {.channel = "2"});
  refuse(page(4, 3, 65535), ErrorCode::bad_file, "is cut off or damaged in page 1",
         {.channel = "7"});
  refuse(page(0xFFFFFFFF, 0xFFFFFFFF), ErrorCode::bad_file, "");
  refuse(page(0, 3), ErrorCode::bad_file, "");
  // A fax or zstandard page of one colour may have any size, so the memory limit must apply.
  refuse(page(100000, 100000, 1, COMPRESSION_LZMA), ErrorCode::out_of_memory, "more than the limit",
         {.max_memory = 1000000});
  TiffPage tile{.samples = "abc",
                .more = {{322, 4, {1U << 20}}, {323, 4, {1U << 20}}, {324, 4, {8}}, {325, 4, {3}}}};
  refuse(TiffWriter().add(tile).add(tile).bytes(), ErrorCode::bad_file, "");
  refuse(pages(2, "", {.more = {{322, 4, {16}}, {323, 4, {16}}, {324, 4, {0}}, {325, 4, {0}}}}),
         ErrorCode::bad_file, "page 1 has only a part of its samples (a sparse or damaged TIFF)");
}

TEST_F(Tiff, ManyPages) {
  const std::string bytes = pages(10000, "");
  const VolumeFile file = read(bytes);
  EXPECT_EQ(file.volume.view.grid.size[2], 10000U);
  for (std::size_t i = 0; i < 10000; ++i)
    ASSERT_EQ(sample_as_double(file.volume, i * 12), static_cast<double>(i * 16 % 256));
}

TEST_F(Tiff, OneImageIsTwoDimensional) {
  refuse(pages(1, ""), ErrorCode::unsupported,
         "has 4 x 3 x 1 samples, a 2-D image; expected a volume: a stack of slices, or the folder");
}

}  // namespace
}  // namespace isoatlas::detail::test
