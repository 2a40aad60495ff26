// SPDX-License-Identifier: Apache-2.0
// NIfTI-1, NIfTI-2 and Analyze 7.5: files of users' programs, and what the specification allows.
#include <bzlib.h>
#include <gtest/gtest.h>

#define DONT_INCLUDE_ANALYZE_STRUCT
#include <nifti/nifti1.h>
#include <nifti/nifti2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "isoatlas/version.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"
#include "support/volume_bytes.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::size_t, 3> kFieldSize{24, 20, 16};
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// ---- files written by hand: 4 x 3 x 2 samples

constexpr std::size_t kCount = 24;
constexpr std::array<std::size_t, 3> kSize{4, 3, 2};

nifti_1_header header1(short datatype = 2) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  const std::array<short, 8> dim{3, 4, 3, 2, 1, 1, 1, 1};
  std::copy(dim.begin(), dim.end(), header.dim);
  std::fill(header.pixdim, header.pixdim + 8, 1.0F);
  header.datatype = datatype;
  header.vox_offset = 352;
  header.qform_code = 1;
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

nifti_2_header header2(short datatype = 2) {
  nifti_2_header header{};
  header.sizeof_hdr = 540;
  const std::array<std::int64_t, 8> dim{3, 4, 3, 2, 1, 1, 1, 1};
  std::copy(dim.begin(), dim.end(), header.dim);
  std::fill(header.pixdim, header.pixdim + 8, 1.0);
  header.datatype = datatype;
  header.vox_offset = 544;
  header.qform_code = 1;
  std::memcpy(header.magic, "n+2\0\r\n\032\n", 8);
  return header;
}

nifti_1_header pair_header(short datatype = 2) {
  nifti_1_header header = header1(datatype);
  header.vox_offset = 0;
  std::memcpy(header.magic, "ni1", 4);
  return header;
}

nifti_1_header analyze_header(short datatype = 2) {
  nifti_1_header header = header1(datatype);
  header.vox_offset = 0;
  header.qform_code = 0;
  std::memcpy(header.magic, "\0\0\0", 4);
  return header;
}

void set_sform(nifti_1_header& header, const std::array<std::array<float, 4>, 3>& rows,
               short code = 1) {
  header.sform_code = code;
  std::copy(rows[0].begin(), rows[0].end(), header.srow_x);
  std::copy(rows[1].begin(), rows[1].end(), header.srow_y);
  std::copy(rows[2].begin(), rows[2].end(), header.srow_z);
}

template <class Header>
std::string header_bytes(const Header& header) {
  return {reinterpret_cast<const char*>(&header), sizeof header};
}

template <class Header>
std::string one_file(const Header& header,
                     const std::string& samples = bytes_of(ramp<std::uint8_t>(kCount))) {
  return header_bytes(header) + std::string(4, '\0') + samples;
}

class Nifti : public testing::Test {
 protected:
  TempFolder folder_;

  VolumeFile read(const std::string& bytes, const ReadOptions& options = {},
                  const std::string& name = "v.nii") {
    write_bytes(folder_ / name, bytes);
    return read_volume_file(folder_ / name, options);
  }

  void refuse(const std::string& bytes, ErrorCode code, const std::string& message,
              const ReadOptions& options = {}) {
    SCOPED_TRACE(message);
    write_bytes(folder_ / "v.nii", bytes);
    testing::internal::CaptureStderr();
    expect_error(code, message, folder_ / "v.nii",
                 [&] { read_volume(folder_ / "v.nii", options); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }

  // The world position of a sample in right-anterior-superior, by the formulas of the format.
  static void expect_ras(const Grid& grid, Vec3 index, Vec3 ras, double tolerance = 1e-5) {
    expect_near(grid.to_world(index), {-ras.x, -ras.y, ras.z}, tolerance);
  }
};

// ---- field files

struct FieldNifti {
  std::string name;
  Vec3 spacing, origin;
  std::array<Vec3, 3> direction;
  std::string warning;  // empty if no warning is expected
};

TEST(FieldNifti, HaveTheIntendedGeometry) {
  const std::array kLeftAnterior{Vec3{1, 0, 0}, Vec3{0, -1, 0},
                                 Vec3{0, 0, 1}};  // x runs to the left
  const std::array kRightAnterior{Vec3{-1, 0, 0}, Vec3{0, -1, 0},
                                  Vec3{0, 0, 1}};  // x runs to the right
  const Vec3 kOrigin{-50, 7, 3};
  const std::array kSheared{Vec3{-1, 0, 0}, Vec3{-0.0005, -1, 0}, Vec3{0, 0, 1}};
  const std::vector<FieldNifti> files{
      {"n_units_micron.nii", {0.001, 0.001, 0.002}, {-0.05, 0.007, 0.003}, kLeftAnterior, ""},
      {"n_q1_s2_disagree.nii",
       {1, 1, 2},
       kOrigin,
       kLeftAnterior,
       "voxels apart; the sform is used"},
      {"n_scale_vs_pixdim.nii",
       {1.05, 1.05, 2.1},
       {},
       kRightAnterior,
       "1 x 1 x 2 by pixdim and 1.05 x 1.05 x 2.1 by the sform"},
      {"n_shear_0.0005.nii", {1, 1, 1}, {}, kSheared, ""},
      {"n_nifti2.nii", {1, 1, 2}, {}, kRightAnterior, ""},
      {"n_gz_named.nii", {1, 1, 2}, kOrigin, kLeftAnterior, ""},
      {"N_Mixed.Nii.gz", {1, 1, 2}, kOrigin, kLeftAnterior, ""}};
  const std::vector<double> samples = field_samples();
  EXPECT_NEAR(*std::ranges::min_element(samples), -2.7794766, 1e-6);
  EXPECT_EQ(*std::ranges::max_element(samples), 1);
  for (const FieldNifti& expected : files) {
    SCOPED_TRACE(expected.name);
    testing::internal::CaptureStderr();
    const VolumeFile file = read_volume_file(field_file(expected.name));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(file.volume.view.type, SampleType::float32);
    expect_size_and_spacing(file.volume, kFieldSize, expected.spacing);
    expect_near(file.volume.view.grid.origin, expected.origin);
    for (std::size_t axis = 0; axis < 3; ++axis)
      expect_near(file.volume.view.grid.direction[axis], expected.direction[axis], 2e-7);
    EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::millimetre);
    EXPECT_EQ(samples_as_double(file.volume), samples);
    EXPECT_EQ(decision(file, "affine"), "sform");
    EXPECT_EQ(file.source.reader, "isoatlas " ISOATLAS_VERSION);
    if (expected.warning.empty()) {
      EXPECT_TRUE(file.source.warnings.empty());
    } else {
      expect_one_warning(file, expected.warning);
    }
  }
}

TEST(FieldNifti, SlopeZeroMeansNoScaling) {
  const VolumeFile file = read_volume_file(field_file("n_slope0_inter5.nii"));
  EXPECT_EQ(file.volume.view.type, SampleType::int16);
  const SampleSummary summary = summarize(file.volume);
  EXPECT_EQ(summary.minimum, -2779);
  EXPECT_EQ(summary.maximum, 1000);
  EXPECT_EQ(decision(file, "rescale"), "none: slope 0, its intercept 5 is ignored");
}

TEST(FieldNifti, TimePointsAreAChoice) {
  const fs::path path = field_file("n_4d2.nii");
  try {
    read_volume_file(path);
    FAIL() << "expected a choice";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_EQ(needed.choice().name, "time");
    EXPECT_EQ(needed.choice().entries, (std::vector<std::string>{"0", "1"}));
    EXPECT_EQ(needed.source().format, "NIfTI-1");
  }
  EXPECT_EQ(samples_as_double(read_volume(path, {.time = 1})), field_samples());
  expect_error(ErrorCode::bad_argument, "has no time '2'", path,
               [&] { read_volume(path, {.time = 2}); });
}

// ---- samples

TEST_F(Nifti, EveryTypeInBothByteOrdersAndVersions) {
  const auto check = [&](auto zero, short datatype, SampleType type) {
    using T = decltype(zero);
    std::vector<T> values = ramp<T>(kCount);
    values[1] = std::numeric_limits<T>::max();
    values[2] = std::numeric_limits<T>::lowest();
    std::vector<double> expected(values.begin(), values.end());
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(std::string(name(type)) + (big_endian ? ", big endian" : ""));
      const auto stored = [&](auto value) { return big_endian ? reversed(value) : value; };
      nifti_1_header first = header1();
      nifti_2_header second = header2();
      const auto fill = [&](auto& header) {
        header.sizeof_hdr = stored(header.sizeof_hdr);
        header.datatype = stored(datatype);
        for (auto& n : header.dim) n = stored(n);
        for (auto& d : header.pixdim) d = stored(d);
        header.vox_offset = stored(header.vox_offset);
        header.qform_code = stored(header.qform_code);
        header.qoffset_x = stored(static_cast<decltype(header.qoffset_x)>(5));
      };
      fill(first);
      // Fields of packed structures cannot be bound to references.
      second.sizeof_hdr = stored(540);
      second.datatype = stored(datatype);
      for (int i = 0; i < 8; ++i) {
        second.dim[i] = stored(std::int64_t{second.dim[i]});
        second.pixdim[i] = stored(double{second.pixdim[i]});
      }
      second.vox_offset = stored(std::int64_t{544});
      second.qform_code = stored(1);
      second.qoffset_x = stored(5.0);
      for (const std::string& bytes : {one_file(first, bytes_of(values, big_endian)),
                                       one_file(second, bytes_of(values, big_endian))}) {
        const VolumeFile file = read(bytes);
        EXPECT_EQ(file.volume.view.type, type);
        expect_size_and_spacing(file.volume, kSize, {1, 1, 1});
        EXPECT_EQ(file.volume.view.grid.origin, (Vec3{-5, 0, 0}));
        EXPECT_EQ(samples_as_double(file.volume), expected);
        EXPECT_EQ(std::memcmp(file.volume.view.samples, values.data(), kCount * sizeof(T)), 0);
        EXPECT_TRUE(file.source.warnings.empty());
      }
      EXPECT_EQ(read(one_file(second, bytes_of(values, big_endian))).source.format, "NIfTI-2");
    }
  };
  check(std::uint8_t{}, 2, SampleType::uint8);
  check(std::int16_t{}, 4, SampleType::int16);
  check(std::int32_t{}, 8, SampleType::int32);
  check(float{}, 16, SampleType::float32);
  check(double{}, 64, SampleType::float64);
  check(std::int8_t{}, 256, SampleType::int8);
  check(std::uint16_t{}, 512, SampleType::uint16);
  check(std::uint32_t{}, 768, SampleType::uint32);
  check(std::int64_t{}, 1024, SampleType::int64);
  check(std::uint64_t{}, 1280, SampleType::uint64);
}

TEST_F(Nifti, OtherTypesAreRefused) {
  for (const auto& [datatype, type_name] :
       std::vector<std::pair<short, std::string>>{{0, "unknown"},
                                                  {1, "BINARY"},
                                                  {32, "COMPLEX64"},
                                                  {128, "RGB24"},
                                                  {1536, "FLOAT128"},
                                                  {2304, "RGBA32"},
                                                  {77, "type 77"}}) {
    refuse(one_file(header1(datatype), std::string(1000, '\0')), ErrorCode::unsupported, type_name);
  }
}

TEST_F(Nifti, ScaledSamplesAreFloatOrDouble) {
  nifti_1_header header = header1(4);
  header.scl_slope = 0.1F;
  header.scl_inter = -7;
  const VolumeFile file = read(one_file(header, bytes_of(ramp<std::int16_t>(kCount, -5))));
  EXPECT_EQ(file.volume.view.type, SampleType::float32);
  EXPECT_EQ(decision(file, "rescale"), "slope 0.100000001, intercept -7");
  for (std::size_t i = 0; i < kCount; ++i) {
    const double stored = static_cast<double>(i) - 5;
    EXPECT_EQ(sample_as_double(file.volume, i),
              static_cast<float>(stored * static_cast<double>(0.1F) - 7));
  }
  header.datatype = 64;
  const VolumeFile doubles = read(one_file(header, bytes_of(ramp<double>(kCount))));
  EXPECT_EQ(doubles.volume.view.type, SampleType::float64);
  EXPECT_EQ(sample_as_double(doubles.volume, 3), 3 * static_cast<double>(0.1F) - 7);
  // 2^24 + 1 is not a float: it is scaled exactly, not rounded first.
  header.datatype = 8;
  header.scl_slope = 1;
  header.scl_inter = -16777216;
  std::vector<std::int32_t> large = ramp<std::int32_t>(kCount);
  large[7] = 16777217;
  EXPECT_EQ(sample_as_double(read(one_file(header, bytes_of(large))).volume, 7), 1);
}

TEST_F(Nifti, ScaledNaNStaysNaN) {
  nifti_1_header header = header1(16);
  header.scl_slope = 2;
  std::vector<float> values = ramp<float>(kCount);
  values[3] = kNaN;
  values[4] = -std::numeric_limits<float>::infinity();
  const VolumeFile file = read(one_file(header, bytes_of(values)));
  EXPECT_TRUE(std::isnan(sample_as_double(file.volume, 3)));
  EXPECT_EQ(sample_as_double(file.volume, 4), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(sample_as_double(file.volume, 5), 10);
}

TEST_F(Nifti, UnusableScalesAreIgnored) {
  const auto values = ramp<std::int16_t>(kCount);
  for (const float slope : {0.0F, kNaN, std::numeric_limits<float>::infinity()}) {
    nifti_1_header header = header1(4);
    header.scl_slope = slope;
    header.scl_inter = slope == 0 ? 5 : kNaN;
    const VolumeFile file = read(one_file(header, bytes_of(values)));
    EXPECT_EQ(file.volume.view.type, SampleType::int16);
    EXPECT_EQ(sample_as_double(file.volume, 9), 9);
    EXPECT_TRUE(file.source.warnings.empty());
  }
  nifti_1_header header = header1(4);
  header.scl_slope = 2;
  header.scl_inter = kNaN;
  const VolumeFile file = read(one_file(header, bytes_of(values)));
  EXPECT_EQ(sample_as_double(file.volume, 9), 18);
  expect_one_warning(file, "scl_inter is nan; 0 is used");
  header.scl_slope = 1e-20F;  // small is not 0
  header.scl_inter = 0;
  EXPECT_FLOAT_EQ(
      static_cast<float>(sample_as_double(read(one_file(header, bytes_of(values))).volume, 9)),
      9e-20F);
}

TEST_F(Nifti, SamplesBeginAtTheStatedOffset) {
  const std::string samples = bytes_of(ramp<std::uint8_t>(kCount));
  nifti_1_header header = header1();
  header.vox_offset = 368;  // after an extension of 16 bytes
  EXPECT_EQ(sample_as_double(read(one_file(header, std::string(16, 'x') + samples)).volume, 9), 9);
  header.vox_offset = 0;
  EXPECT_EQ(sample_as_double(read(one_file(header, samples)).volume, 9), 9);
  header.vox_offset = 348;  // without the four bytes about extensions
  EXPECT_EQ(sample_as_double(read(header_bytes(header) + samples).volume, 9), 9);
  for (const float offset : {-16.0F, 100.0F, kNaN, 1e20F}) {
    header.vox_offset = offset;
    refuse(one_file(header, samples), ErrorCode::bad_file,
           "by vox_offset, expected an offset after the header");
  }
  header.vox_offset = 1e9F;
  refuse(one_file(header, samples), ErrorCode::bad_file,
         "states 24 bytes of samples, the file has 0");
}

TEST_F(Nifti, StatedBitsOfAnotherTypeGiveAWarning) {
  nifti_1_header header = header1();
  header.bitpix = 16;
  expect_one_warning(read(one_file(header)), "states 16 bits per sample, but the type uint8");
  header.bitpix = 8;
  EXPECT_TRUE(read(one_file(header)).source.warnings.empty());
}

// ---- shapes

TEST_F(Nifti, TimeAndChannelAreChosen) {
  nifti_1_header header = header1();
  header.dim[0] = 5;
  header.dim[4] = 2;
  header.dim[5] = 3;
  const std::string bytes = one_file(header, bytes_of(ramp<std::uint8_t>(6 * kCount)));
  for (const std::string& file : {bytes, gzipped(bytes)}) {
    const VolumeFile chosen = read(file, {.channel = "2", .time = 1});
    EXPECT_EQ(sample_as_double(chosen.volume, 0), 5 * kCount);  // time is the faster axis
    EXPECT_EQ(sample_as_double(chosen.volume, 23), 6 * kCount - 1);
    ASSERT_EQ(chosen.source.choices.size(), 2u);
    EXPECT_EQ(chosen.source.choices[0].name, "time");
    EXPECT_EQ(chosen.source.choices[0].selected, 1u);
    EXPECT_EQ(chosen.source.choices[1].name, "channel");
    EXPECT_EQ(chosen.source.choices[1].selected, 2u);
    EXPECT_EQ(sample_as_double(read(file, {.channel = "0", .time = 0}).volume, 1), 1);
    refuse(file, ErrorCode::unsupported, "has 2 time points, expected a choice of one: 0, 1");
    refuse(file, ErrorCode::unsupported, "has 3 channels", {.time = 0});
    refuse(file, ErrorCode::bad_argument, "has no channel '3'", {.channel = "3", .time = 0});
  }
  // All volumes must be in the file, whichever is read.
  refuse(bytes.substr(0, bytes.size() - 1), ErrorCode::bad_file,
         "states 144 bytes of samples, the file has 143", {.channel = "0", .time = 0});
  refuse(gzipped(bytes.substr(0, bytes.size() - 1)), ErrorCode::bad_file,
         "states 144 bytes of samples, the file has 143", {.channel = "0", .time = 0});
}

TEST_F(Nifti, DimensionsOfOneAreDropped) {
  nifti_1_header header = header1();
  header.dim[0] = 7;
  EXPECT_TRUE(read(one_file(header)).source.choices.empty());
  header.dim[0] = 3;
  header.dim[4] = 9;  // beyond the number of dimensions, so it has no meaning
  EXPECT_TRUE(read(one_file(header)).source.choices.empty());
  EXPECT_THROW(read(one_file(header), {.time = 1}), Error);
  header.dim[0] = 6;
  header.dim[4] = 1;
  header.dim[6] = 2;
  refuse(one_file(header), ErrorCode::unsupported, "has 6 dimensions (4 x 3 x 2 x 1 x 1 x 2)");
}

TEST_F(Nifti, ImpossibleShapesAreRefused) {
  nifti_1_header header = header1();
  for (const short dimensions : std::array<short, 4>{-1, 0, 8, 768}) {
    header.dim[0] = dimensions;
    refuse(one_file(header), ErrorCode::bad_file,
           "has " + std::to_string(dimensions) + " dimensions");
  }
  header.dim[0] = 2;
  refuse(one_file(header), ErrorCode::unsupported, "4 x 3 x 1 samples");
  header.dim[0] = 4;
  header.dim[4] = 0;
  refuse(one_file(header), ErrorCode::bad_file, "0 samples along axis 4");
  nifti_2_header large = header2();
  large.dim[1] = std::int64_t{1} << 40;
  large.dim[2] = std::int64_t{1} << 40;
  refuse(one_file(large), ErrorCode::bad_file, "more than any file can hold");
  large.dim[1] = 1 << 20;
  large.dim[2] = 1 << 20;
  refuse(one_file(large), ErrorCode::bad_file, "states 2199023255552 bytes of samples");
  refuse(gzipped(one_file(large)), ErrorCode::bad_file, "far more than a file of");
  large.dim[1] = -5;
  refuse(one_file(large), ErrorCode::bad_file, "-5 samples along axis 1");
  large = header2();
  large.dim[0] = 4;
  large.dim[4] = std::int64_t{1} << 62;
  refuse(one_file(large), ErrorCode::unsupported, "4 dimensions");
}

TEST_F(Nifti, CiftiIsRefused) {
  nifti_2_header header = header2(16);
  header.intent_code = 3006;
  refuse(one_file(header, std::string(96, '\0')), ErrorCode::unsupported, "is a CIFTI file");
}

TEST_F(Nifti, IntentsOfScalarsAreRead) {
  for (const short intent : std::array<short, 4>{
           3, 1002, 1005, 1007}) {  // t statistic, labels, symmetric matrix and vector of one value
    nifti_1_header header = header1();
    header.intent_code = intent;
    EXPECT_EQ(sample_as_double(read(one_file(header)).volume, 9), 9);
  }
}

// ---- damaged files

TEST_F(Nifti, CutOffAnywhereIsRefused) {
  const std::string bytes = one_file(header1());
  for (const std::size_t length : {4, 40, 347, 348, 351, 352, 353, 375}) {
    SCOPED_TRACE(length);
    refuse(bytes.substr(0, length), ErrorCode::bad_file, "");
  }
  const std::string second = one_file(header2());
  for (const std::size_t length : {348, 539, 540, 543, 544, 567})
    refuse(second.substr(0, length), ErrorCode::bad_file, "");
  const std::string packed = gzipped(bytes);
  for (std::size_t length = 20; length < packed.size(); length += 7)
    refuse(packed.substr(0, length), ErrorCode::bad_file, "");
}

TEST_F(Nifti, DamagedMagicIsRefused) {
  nifti_2_header header = header2();
  std::memcpy(header.magic, "n+2\0\n\032\n\n", 8);
  refuse(one_file(header), ErrorCode::bad_file, "was damaged by a transfer as text");
  refuse(std::string(400, 'x'), ErrorCode::bad_file, "is not a NIfTI file");
}

TEST_F(Nifti, MoreBytesThanStatedGiveAWarning) {
  const std::string bytes = one_file(header1()) + "and more";
  expect_one_warning(read(bytes), "has 8 bytes after the samples");
  expect_one_warning(read(gzipped(bytes)), "has 8 bytes after the samples");
  EXPECT_EQ(read(gzipped(one_file(header1()))).source.warnings.size(), 0u);
}

TEST_F(Nifti, PackedByBzip2) {
  std::string bytes = one_file(header1());
  std::string packed(2 * bytes.size() + 1000, '\0');
  auto packed_bytes = static_cast<unsigned>(packed.size());
  ASSERT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &packed_bytes, bytes.data(),
                                     static_cast<unsigned>(bytes.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(packed_bytes);
  EXPECT_EQ(sample_as_double(read(packed, {}, "v.nii.bz2").volume, 9), 9);
  EXPECT_EQ(sample_as_double(read(packed).volume, 9), 9);  // the name does not matter
  refuse(packed.substr(0, packed.size() - 1), ErrorCode::bad_file, "is cut off");
}

// ---- geometry

TEST_F(Nifti, QformIsARotationAndAVoxelSize) {
  nifti_1_header header = header1();
  header.pixdim[0] = -1;
  header.pixdim[1] = 2;
  header.pixdim[2] = 3;
  header.pixdim[3] = 4;
  header.quatern_d = 0.5F;  // a rotation by 60 degrees about z
  header.qoffset_x = 10;
  header.qoffset_y = 20;
  header.qoffset_z = 30;
  const VolumeFile file = read(one_file(header));
  EXPECT_EQ(decision(file, "affine"), "qform");
  EXPECT_TRUE(file.source.warnings.empty());
  expect_size_and_spacing(file.volume, kSize, {2, 3, 4}, 0);
  const double c = 0.5, s = std::sqrt(0.75);
  expect_ras(file.volume.view.grid, {0, 0, 0}, {10, 20, 30});
  expect_ras(file.volume.view.grid, {1, 0, 0}, {10 + 2 * c, 20 + 2 * s, 30});
  expect_ras(file.volume.view.grid, {0, 1, 0}, {10 - 3 * s, 20 + 3 * c, 30});
  expect_ras(file.volume.view.grid, {0, 0, 1}, {10, 20, 30 - 4});  // pixdim[0] reverses z
  EXPECT_TRUE(file.volume.view.grid.mirrored());
  header.pixdim[0] = 0;  // means 1
  EXPECT_FALSE(read(one_file(header)).volume.view.grid.mirrored());
}

TEST_F(Nifti, QuaternionsOfHalfATurn) {
  nifti_1_header header = header1();
  header.quatern_b = 0.6F;
  header.quatern_c = 0.8F;  // b^2 + c^2 is a little more than 1 in single precision
  const VolumeFile file = read(one_file(header));
  expect_ras(file.volume.view.grid, {1, 0, 0}, {0.36 - 0.64, 0.96, 0});
  expect_ras(file.volume.view.grid, {0, 0, 1}, {0, 0, -1});
  EXPECT_TRUE(file.source.warnings.empty());
  header.quatern_b = 3;
  header.quatern_c = 4;
  const VolumeFile longer = read(one_file(header));
  expect_ras(longer.volume.view.grid, {1, 0, 0}, {0.36 - 0.64, 0.96, 0});
  expect_one_warning(longer, "has length 5, expected at most 1");
  header.quatern_b = kNaN;
  refuse(one_file(header), ErrorCode::bad_file, "its qform is not finite");
}

TEST_F(Nifti, SformIsUsedWhereTheTwoDiffer) {
  nifti_1_header header = header1();
  set_sform(header, {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 4);
  VolumeFile file = read(one_file(header));
  EXPECT_EQ(decision(file, "affine"), "qform, which equals the sform");
  EXPECT_TRUE(file.source.warnings.empty());
  set_sform(header, {{{1, 0, 0, 0.05F}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
            4);  // a small difference gives no warning, but changes the grid
  file = read(one_file(header));
  EXPECT_EQ(decision(file, "affine"), "sform");
  EXPECT_FLOAT_EQ(static_cast<float>(file.volume.view.grid.origin.x), -0.05F);
  EXPECT_TRUE(file.source.warnings.empty());
  set_sform(header, {{{1, 0, 0, 0.2F}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 4);
  file = read(one_file(header));
  EXPECT_FLOAT_EQ(static_cast<float>(file.volume.view.grid.origin.x), -0.2F);
  expect_one_warning(
      file, "its sform and its qform place samples up to 0.2 voxels apart; the sform is used");
}

TEST_F(Nifti, SformKeepsTheWrittenVoxelSize) {
  nifti_1_header header = header1();
  header.qform_code = 0;
  header.pixdim[1] = 0.8125F;
  header.pixdim[2] = 0.8125F;
  const float c = 0.8125F * 0.8F, s = 0.8125F * 0.6F;  // rounded
  set_sform(header, {{{c, -s, 0, 1}, {s, c, 0, 2}, {0, 0, 1, 3}}});
  const VolumeFile file = read(one_file(header));
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.8125, 0.8125, 1}));
  expect_ras(file.volume.view.grid, {1, 1, 1}, {1 + c - s, 2 + s + c, 4});
  EXPECT_TRUE(file.source.warnings.empty());
}

TEST_F(Nifti, TheQformReplacesAnUnusableSform) {
  for (const float bad : {0.0F, kNaN}) {
    nifti_1_header header = header1();
    header.qoffset_x = 4;
    set_sform(header, {{{bad, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}});
    const VolumeFile file = read(one_file(header));
    EXPECT_EQ(file.volume.view.grid.origin.x, -4);
    expect_one_warning(file, "its sform is singular or not finite; the qform is used");
    header.qform_code = 0;
    refuse(one_file(header), ErrorCode::bad_file, "its sform is singular or not finite");
  }
}

TEST_F(Nifti, AStrongShearIsReadAsItIs) {
  nifti_1_header header = header1();
  header.qform_code = 0;
  set_sform(header, {{{1, 0.5F, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}});
  const VolumeFile file = read(one_file(header));
  expect_ras(file.volume.view.grid, {2, 2, 1}, {3, 2, 1});
}

TEST_F(Nifti, WithoutAffineTheAxesStayAsTheyAre) {
  nifti_1_header header = header1();
  header.qform_code = 0;
  header.pixdim[1] = 2;
  header.qoffset_x = 7;  // ignored: there is no qform
  VolumeFile file = read(one_file(header));
  EXPECT_EQ(file.volume.view.grid.direction, Grid{}.direction);
  EXPECT_EQ(file.volume.view.grid.origin, Vec3{});
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{2, 1, 1}));
  EXPECT_EQ(decision(file, "affine"), "voxel size only");
  expect_one_warning(file, "states no orientation");
  header.pixdim[2] = -3;
  file = read(one_file(header));
  EXPECT_EQ(file.volume.view.grid.spacing.y, 3);
  EXPECT_EQ(file.volume.view.grid.direction, Grid{}.direction);
  ASSERT_EQ(file.source.warnings.size(), 2u);
  EXPECT_EQ(file.source.warnings[0], "its spacing along axis 2 is -3; 3 is used");
  for (const float bad : {0.0F, kNaN}) {
    header.pixdim[2] = bad;
    refuse(one_file(header), ErrorCode::bad_file, "the spacing along axis 2 is");
  }
}

TEST_F(Nifti, LengthsAreInMillimetres) {
  struct Unit {
    char code;
    double millimetres;
    std::string decision;
  };
  for (const Unit& unit :
       {Unit{0, 1, "millimetre, not stated"}, Unit{1, 1000, "metre, converted to millimetre"},
        Unit{2 | 8, 1, "millimetre"}, Unit{3 | 16, 0.001, "micrometre, converted to millimetre"}}) {
    nifti_1_header header = header1();
    header.xyzt_units = unit.code;
    header.pixdim[3] = 2.5F;
    header.qoffset_y = 8;
    const VolumeFile file = read(one_file(header));
    EXPECT_DOUBLE_EQ(file.volume.view.grid.spacing.z, 2.5 * unit.millimetres);
    EXPECT_DOUBLE_EQ(file.volume.view.grid.origin.y, -8 * unit.millimetres);
    EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::millimetre);
    EXPECT_EQ(decision(file, "unit"), unit.decision);
    EXPECT_TRUE(file.source.warnings.empty());
  }
  nifti_1_header header = header1();
  header.xyzt_units = 5;
  expect_one_warning(read(one_file(header)), "unknown unit of length (code 5)");
}

// ---- pairs and Analyze

TEST_F(Nifti, PairsInEachPackingAndCase) {
  const std::string header = header_bytes(pair_header()),
                    samples = bytes_of(ramp<std::uint8_t>(kCount));
  const std::vector<std::array<std::string, 2>> pairs{
      {"a.hdr", "a.img"}, {"b.hdr.gz", "b.img.gz"}, {"c.hdr", "c.img.gz"},
      {"D.HDR", "D.IMG"}, {"e.Hdr", "e.IMG.GZ"},    {"f.v2.hdr", "f.v2.img"}};
  for (const auto& [header_name, image_name] : pairs) {
    SCOPED_TRACE(header_name + " " + image_name);
    const auto packed = [](const std::string& file, const std::string& bytes) {
      return file.ends_with("z") || file.ends_with("Z") ? gzipped(bytes) : bytes;
    };
    write_bytes(folder_ / header_name, packed(header_name, header));
    write_bytes(folder_ / image_name, packed(image_name, samples));
    for (const std::string& given : {header_name, image_name}) {
      const VolumeFile file = read_volume_file(folder_ / given);
      EXPECT_EQ(sample_as_double(file.volume, 9), 9);
      EXPECT_EQ(file.source.format, "NIfTI-1");
      EXPECT_TRUE(file.source.warnings.empty());
    }
  }
  expect_error(ErrorCode::bad_file, "has no .img file next to it", folder_ / "g.hdr", [&] {
    write_bytes(folder_ / "g.hdr", header);
    read_volume(folder_ / "g.hdr");
  });
  nifti_1_header single = header1();
  write_bytes(folder_ / "single.img", one_file(single));
  EXPECT_EQ(read_volume(folder_ / "single.img").view.grid.sample_count(), kCount);
  expect_error(ErrorCode::bad_file, "has no .hdr file next to it", folder_ / "h.img", [&] {
    write_bytes(folder_ / "h.img", samples);
    read_volume(folder_ / "h.img");
  });
}

TEST_F(Nifti, APairMayStateThatItIsOneFile) {
  nifti_1_header header = header1();
  header.vox_offset = 0;
  write_bytes(folder_ / "a.hdr", header_bytes(header));
  write_bytes(folder_ / "a.img", bytes_of(ramp<std::uint8_t>(kCount)));
  EXPECT_EQ(sample_as_double(read_volume(folder_ / "a.hdr"), 9), 9);
  EXPECT_EQ(sample_as_double(read(one_file(header1()), {}, "b.hdr").volume, 9),
            9);  // and a single file may have the extension .hdr
}

TEST_F(Nifti, AnalyzeHasNoOrientation) {
  nifti_1_header header = analyze_header(4);
  header.pixdim[3] = 2;
  header.qform_code = 3;  // another field in Analyze
  header.sform_code = 77;
  write_bytes(folder_ / "a.hdr", header_bytes(header));
  write_bytes(folder_ / "a.img", bytes_of(ramp<std::int16_t>(kCount)));
  VolumeFile file = read_volume_file(folder_ / "a.hdr");
  EXPECT_EQ(file.source.format, "Analyze 7.5");
  EXPECT_EQ(sample_as_double(file.volume, 9), 9);
  EXPECT_EQ(file.volume.view.type, SampleType::int16);
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 1, 2}));
  EXPECT_EQ(file.volume.view.grid.direction, Grid{}.direction);
  expect_one_warning(file, "states no orientation");
  header.scl_slope = 0.5F;  // SPM's factor; the next field is not an intercept
  header.scl_inter = 100;
  write_bytes(folder_ / "a.hdr", header_bytes(header));
  file = read_volume_file(folder_ / "a.img");
  EXPECT_EQ(sample_as_double(file.volume, 9), 4.5);
  ASSERT_EQ(file.source.warnings.size(), 2u);
  EXPECT_NE(file.source.warnings[1].find("multiplied by 0.5"), std::string::npos)
      << file.source.warnings[1];
}

TEST_F(Nifti, NeverAllocatesMoreThanAllowed) {
  write_bytes(folder_ / "v.nii", one_file(header1()));
  expect_error(ErrorCode::out_of_memory, "more than the limit of 23", folder_ / "v.nii",
               [&] { read_volume(folder_ / "v.nii", {.max_memory = 23}); });
  EXPECT_NO_THROW(read_volume(folder_ / "v.nii", {.max_memory = 24}));
}

}  // namespace
}  // namespace isoatlas::detail::test
