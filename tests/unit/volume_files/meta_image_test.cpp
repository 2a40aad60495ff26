// SPDX-License-Identifier: Apache-2.0
// MetaImage: the features of the format, file by file.
// https://itk.org/Wiki/ITK/MetaIO/Documentation
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/one_file.h"

namespace isoatlas::detail::test {
namespace {

using MetaFile = OneFile;

constexpr ErrorCode kBad = ErrorCode::bad_file;
constexpr ErrorCode kUnsupported = ErrorCode::unsupported;

const std::string kSpacing = "ElementSpacing = 0.5 1 2\n";

// 2 x 3 x 4 samples of one byte.
std::string small(const std::string& more = kSpacing, const std::string& body = counted(24),
                  const std::string& data_file = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\n" + more +
         "DimSize = 2 3 4\nElementType = MET_UCHAR\nElementDataFile = " + data_file + "\n" + body;
}

std::string four_dimensional(const std::string& size, const std::string& body,
                             const std::string& more = "ElementSpacing = 1 2 3 4\n",
                             const std::string& data_file = "LOCAL") {
  return "ObjectType = Image\nNDims = 4\n" + more + "DimSize = " + size +
         "\nElementType = MET_UCHAR\nElementDataFile = " + data_file + "\n" + body;
}

// ---- field files

TEST(MetaImageField, CompressedSizeIsNotNeeded) {
  const VolumeFile with_size = read_volume_file(kField / "m_comp_size_u8.mha");
  const VolumeFile without = read_volume_file(kField / "m_comp_nosize_u8.mha");
  EXPECT_EQ(samples_of(without.volume), samples_of(with_size.volume));
  const std::string samples = samples_of(without.volume);
  EXPECT_EQ(samples.size(), 7680u);
  EXPECT_EQ(samples.find_first_not_of(std::string("\0\xC8", 2)), std::string::npos);  // 0 and 200
  EXPECT_EQ(std::count(samples.begin(), samples.end(), '\xC8'), 606);
  EXPECT_EQ(without.volume.view.grid.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(without.source.warnings, Strings{});
}

TEST(MetaImageField, CompressedSizeMayBeZero) {
  const VolumeFile file = read_volume_file(kField / "m_csize_zero.mha");
  const std::string samples = samples_of(file.volume);
  EXPECT_EQ(samples.size(), 7680u);
  EXPECT_EQ(sample_digest(file.volume),
            "33700db4cac6c91b28d42786b26463668b51164b21583db0260e2bc61a4e4246");  // decompressed by
                                                                                  // Python's zlib
}

TEST(MetaImageField, ListOfSlices) {
  const VolumeFile file = read_volume_file(kField / "m_det_list.mhd");
  EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{24, 20, 16}));
  EXPECT_EQ(file.volume.view.type, SampleType::float32);
  EXPECT_EQ(samples_of(file.volume), read_bytes(kField / "r_det.raw"));
  EXPECT_EQ(file.source.warnings, Strings{"states no voxel size; 1 x 1 x 1 is assumed"});
}

// ---- geometry

TEST(MetaImageGrid, NamesOfThePosition) {  // MetaIO lets the later of these overwrite the earlier
  const auto origin = [](const std::string& more) {
    return MetaFile(small(kSpacing + more)).file().volume.view.grid.origin;
  };
  EXPECT_EQ(origin("Offset = 1 2 3\n"), (Vec3{1, 2, 3}));
  EXPECT_EQ(origin("Position = 4 5 6\n"), (Vec3{4, 5, 6}));
  EXPECT_EQ(origin("Origin = 7 8 9\n"), (Vec3{7, 8, 9}));
  EXPECT_EQ(origin("ImagePosition = 1 0 0\n"), (Vec3{1, 0, 0}));
  EXPECT_EQ(origin("Origin = 7 8 9\nPosition = 4 5 6\nOffset = 1 2 3\n"), (Vec3{7, 8, 9}));
  EXPECT_EQ(origin("ImagePosition = 1 0 0\nOrigin = 7 8 9\n"), (Vec3{1, 0, 0}));
  EXPECT_EQ(origin("Offset = 1 2 3\nPosition = 4 5 6\n"), (Vec3{1, 2, 3}));
  EXPECT_EQ(origin(""), (Vec3{0, 0, 0}));
  MetaFile(small("Offset = 1 2\n")).expect_refused(kBad, "its Offset is '1 2', expected 3 numbers");
  MetaFile(small("Offset = 1 2 three\n")).expect_refused(kBad, "origin is not finite");
}

TEST(MetaImageGrid, NamesOfTheMatrix) {
  const std::string turned = " = 0 1 0 -1 0 0 0 0 1\n", mirrored = " = 1 0 0 0 -1 0 0 0 1\n";
  const auto direction = [](const std::string& more) {
    return MetaFile(small(kSpacing + more)).file().volume.view.grid.direction;
  };
  const std::array<Vec3, 3> expected{Vec3{0, 1, 0}, Vec3{-1, 0, 0},
                                     Vec3{0, 0, 1}};  // a row of the matrix is an axis of the image
  for (const std::string name : {"TransformMatrix", "Rotation", "Orientation"}) {
    EXPECT_EQ(direction(name + turned), expected) << name;
  }
  EXPECT_EQ(
      direction("TransformMatrix" + turned + "Rotation" + mirrored + "Orientation" + mirrored),
      expected);
  EXPECT_EQ(direction("Rotation" + turned + "Orientation" + mirrored), expected);
  EXPECT_EQ(direction("CenterOfRotation = 5 6 7\nTransformMatrix" + turned), expected);
  MetaFile(small("TransformMatrix = 1 0 0 1\n"))
      .expect_refused(kBad, "its TransformMatrix is '1 0 0 1', expected 9 numbers");
}

TEST(MetaImageGrid, CentreOfRotationIsIgnored) {  // as in ITK
  const Grid grid =
      MetaFile(
          small("CenterOfRotation = 5 6 7\nOffset = 1 2 3\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n"))
          .file()
          .volume.view.grid;
  EXPECT_EQ(grid.origin, (Vec3{1, 2, 3}));
}

TEST(MetaImageGrid, Spacing) {
  const auto file = [](const std::string& more) { return MetaFile(small(more)).file(); };
  EXPECT_EQ(file("ElementSpacing = 0.5 1 2\nElementSize = 3 4 5\n").volume.view.grid.spacing,
            (Vec3{0.5, 1, 2}));
  EXPECT_EQ(file("ElementSize = 3 4 5\n").volume.view.grid.spacing, (Vec3{3, 4, 5}));
  EXPECT_EQ(file("").source.warnings, Strings{"states no voxel size; 1 x 1 x 1 is assumed"});
  EXPECT_EQ(file("ElementSpacing = 1 -2 3\n").volume.view.grid.direction[1], (Vec3{0, -1, 0}));
  MetaFile(small("ElementSpacing = 1 nan 3\n")).expect_refused(kBad, "spacing along y");
}

TEST(MetaImageGrid, Unit) {
  const auto unit = [](const std::string& more) {
    return MetaFile(small(more)).file().volume.view.grid.unit;
  };
  EXPECT_EQ(unit(kSpacing), LengthUnit::unknown);
  EXPECT_EQ(unit(kSpacing + "AnatomicalOrientation = RAI\n"),
            LengthUnit::millimetre);  // every file of ITK has this field
  EXPECT_EQ(unit(kSpacing + "AnatomicalOrientation = ???\n"), LengthUnit::unknown);
  EXPECT_EQ(unit("AnatomicalOrientation = RAI\n"),
            LengthUnit::unknown);  // without a length there is no unit
  EXPECT_EQ(unit(kSpacing + "DistanceUnits = um\nAnatomicalOrientation = RAI\n"),
            LengthUnit::micrometre);
  EXPECT_EQ(unit(kSpacing + "DistanceUnits = mm\n"), LengthUnit::millimetre);
  EXPECT_EQ(unit(kSpacing + "DistanceUnits = cm\n"), LengthUnit::centimetre);
  EXPECT_EQ(unit(kSpacing + "DistanceUnits = ?\n"), LengthUnit::unknown);
}

// ---- channels and time

TEST(MetaImageAxes, Channels) {
  const MetaFile file(small(kSpacing + "ElementNumberOfChannels = 3\n", counted(72)));
  file.expect_refused(kUnsupported, "has 3 channels, expected a choice of one: 0, 1, 2");
  EXPECT_EQ(file.samples({.channel = "0"}), counted(24, 0, 3));
  EXPECT_EQ(file.samples({.channel = "2"}), counted(24, 2, 3));
  file.expect_refused(ErrorCode::bad_argument, "no channel '3'", {.channel = "3"});
  EXPECT_EQ(MetaFile(small(kSpacing + "ElementNumberOfChannels = 1\n")).samples(), counted(24));
  MetaFile(small(kSpacing + "ElementNumberOfChannels = 0\n"))
      .expect_refused(kBad, "ElementNumberOfChannels is '0'");
  MetaFile(small(kSpacing + "ElementNumberOfChannels = 9000000000000000000\n"))
      .expect_refused(kUnsupported, "has 9000000000000000000 entries to choose a channel from",
                      {.channel = "0"});
}

TEST(MetaImageAxes, Time) {
  const MetaFile file(four_dimensional("2 3 4 2", counted(48)));
  file.expect_refused(kUnsupported, "has 2 time points");
  EXPECT_EQ(file.samples({.time = 1}), counted(24, 24));
  EXPECT_EQ(file.file({.time = 1}).volume.view.grid.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(MetaFile(four_dimensional("2 3 4 1", counted(24))).samples(), counted(24));
  const MetaFile both(four_dimensional("2 3 4 2", counted(96), "ElementNumberOfChannels = 2\n"));
  EXPECT_EQ(both.samples({.channel = "1", .time = 1}), counted(24, 49, 2));
  const std::string matrix =
      "TransformMatrix = 0 1 0 0 -1 0 0 0 0 0 1 0 0 0 0 1\nOffset = 1 2 3 4\n";
  const Grid grid =
      MetaFile(four_dimensional("2 3 4 2", counted(48), matrix)).file({.time = 0}).volume.view.grid;
  EXPECT_EQ(grid.direction[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(grid.origin, (Vec3{1, 2, 3}));
  MetaFile(four_dimensional("2 3 4 2", counted(48),
                            "TransformMatrix = 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n"))
      .expect_refused(kUnsupported, "through both space and time", {.time = 0});
  MetaFile("NDims = 5\nDimSize = 2 3 4 1 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
           counted(48))
      .expect_refused(kUnsupported, "has 5 dimensions (2 x 3 x 4 x 1 x 2)");
  MetaFile("NDims = 2\nDimSize = 4 6\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
           counted(24))
      .expect_refused(kUnsupported, "4 x 6 x 1");
}

// ---- samples

TEST(MetaImageSamples, Types) {
  const std::vector<std::pair<std::string, SampleType>> types{
      {"MET_CHAR", SampleType::int8},           {"MET_ASCII_CHAR", SampleType::int8},
      {"MET_UCHAR", SampleType::uint8},         {"MET_SHORT", SampleType::int16},
      {"MET_USHORT", SampleType::uint16},       {"MET_INT", SampleType::int32},
      {"MET_UINT", SampleType::uint32},         {"MET_LONG", SampleType::int32},
      {"MET_ULONG", SampleType::uint32},        {"MET_LONG_LONG", SampleType::int64},
      {"MET_ULONG_LONG", SampleType::uint64},   {"MET_FLOAT", SampleType::float32},
      {"MET_DOUBLE", SampleType::float64},      {"MET_UCHAR_ARRAY", SampleType::uint8},
      {"MET_FLOAT_ARRAY", SampleType::float32}, {"MET_DOUBLE_ARRAY", SampleType::float64}};
  for (const auto& [name, type] : types) {
    const std::string body = counted(8 * bytes_per_sample(type));
    const MetaFile file(
        "NDims = 3\nDimSize = 2 2 2\nBinaryDataByteOrderMSB = False\nElementType = " + name +
        "\nElementDataFile = LOCAL\n" + body);
    EXPECT_EQ(file.file().volume.view.type, type) << name;
    EXPECT_EQ(file.samples(), body) << name;
  }
  for (const std::string name :
       {"MET_NONE", "MET_STRING", "MET_FLOAT_MATRIX", "MET_OTHER", "float"}) {
    MetaFile("NDims = 3\nDimSize = 2 2 2\nElementType = " + name + "\nElementDataFile = LOCAL\n" +
             counted(64))
        .expect_refused(kUnsupported, "samples of type '" + name + "'");
  }
  MetaFile("NDims = 3\nDimSize = 2 2 2\nElementDataFile = LOCAL\n" + counted(8))
      .expect_refused(kBad, "no ElementType");
}

TEST(MetaImageSamples, ByteOrder) {
  const auto samples = [](const std::string& more) {
    return MetaFile("NDims = 3\nDimSize = 2 2 2\n" + more +
                    "ElementType = MET_USHORT\nElementDataFile = LOCAL\n" + counted(16))
        .samples();
  };
  std::string swapped = counted(16);
  for (std::size_t i = 0; i < 16; i += 2) {
    std::swap(swapped[i], swapped[i + 1]);
  }
  EXPECT_EQ(samples(""), counted(16));
  EXPECT_EQ(samples("BinaryDataByteOrderMSB = True\n"), swapped);
  EXPECT_EQ(samples("ElementByteOrderMSB = true\n"), swapped);
  EXPECT_EQ(samples("ElementByteOrderMSB = True\nBinaryDataByteOrderMSB = False\n"), counted(16));
  EXPECT_EQ(samples("BinaryDataByteOrderMSB = 1\n"), swapped);
}

TEST(MetaImageSamples, Compressed) {
  const std::string zlib = gzipped(counted(24), false);
  const auto packed = [&](const std::string& more, const std::string& body) {
    return small(kSpacing + "CompressedData = True\n" + more, body);
  };
  for (const std::string size :
       {"", "CompressedDataSize = 0\n", "CompressedDataSize = 5\n",
        "CompressedDataSize = 99999999999\n", "CompressedDataSize = -1\n"}) {
    EXPECT_EQ(MetaFile(packed(size, zlib)).samples(), counted(24)) << size;
  }
  EXPECT_EQ(MetaFile(packed("", gzipped(counted(24)))).samples(), counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "CompressedData = False\n")).samples(), counted(24));
  MetaFile(packed("", gzipped(counted(23), false)))
      .expect_refused(kBad, "states 24 bytes of samples, the file has 23");
  MetaFile(packed("", zlib.substr(0, zlib.size() - 4))).expect_refused(kBad, "is cut off");
  MetaFile(packed("", counted(24))).expect_refused(kBad, "damaged");
  MetaFile(packed("HeaderSize = -1\n", zlib)).expect_refused(kUnsupported, "HeaderSize = -1");
  EXPECT_EQ(MetaFile(packed("", gzipped(counted(30), false))).file().source.warnings,
            Strings{"has 6 bytes after the last sample that the header states"});
}

TEST(MetaImageSamples, Text) {
  std::string text;
  for (int i = 0; i < 24; ++i) {
    text += std::to_string(i) + (i % 10 == 9 ? "\n" : " ");
  }
  EXPECT_EQ(MetaFile(small(kSpacing + "BinaryData = False\n", text)).samples(), counted(24));
  EXPECT_EQ(
      MetaFile(
          small(kSpacing +
                    "BinaryData = False\nBinaryDataByteOrderMSB = True\nCompressedData = True\n",
                text))
          .samples(),
      counted(24));
  MetaFile(small(kSpacing + "BinaryData = False\n", text.substr(0, text.size() - 4)))
      .expect_refused(kBad, "states 24 numbers");
}

TEST(MetaImageSamples, HeaderSize) {
  const std::string header = small(kSpacing + "HeaderSize = 5\n", "", "a.raw");
  EXPECT_EQ(MetaFile(header).with("a.raw", "12345" + counted(24)).samples(), counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "HeaderSize = -1\n", "", "a.raw"))
                .with("a.raw", "anything" + counted(24))
                .samples(),
            counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "HeaderSize = -1\n", "anything" + counted(24))).samples(),
            counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "HeaderSize = 5\nCompressedData = True\n", "", "a.zraw"))
                .with("a.zraw", "12345" + gzipped(counted(24), false))
                .samples(),
            counted(24));
  MetaFile(small(kSpacing + "HeaderSize = 6\n", "", "a.raw"))
      .with("a.raw", "12345" + counted(24))
      .expect_refused(kBad, "the file has 23");
  MetaFile(small(kSpacing + "HeaderSize = -1\n", "", "a.raw"))
      .with("a.raw", counted(23))
      .expect_refused(kBad, "the file has 23");
  MetaFile(small(kSpacing + "HeaderSize = -2\n", "", "a.raw"))
      .with("a.raw", counted(24))
      .expect_refused(kBad, "HeaderSize is '-2'");
  MetaFile(small(kSpacing + "HeaderSize = 9000000000000000000\n", "", "a.raw"))
      .with("a.raw", counted(24))
      .expect_refused(kBad, "the file has 0");
}

TEST(MetaImageSamples, IntensityFunctionIsNotApplied) {
  const VolumeFile file =
      MetaFile(
          small(kSpacing +
                "ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -1024\n"))
          .file();
  EXPECT_EQ(samples_of(file.volume), counted(24));
  EXPECT_EQ(file.source.warnings, Strings{"states an ElementToIntensityFunction (slope 2, offset "
                                          "-1024), which is not applied, as in ITK"});
  EXPECT_EQ(
      MetaFile(small(kSpacing +
                     "ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0\n"))
          .file()
          .source.warnings,
      Strings{});
}

TEST(MetaImageSamples, MoreBytesThanStated) {
  EXPECT_EQ(MetaFile(small(kSpacing, counted(25))).file().source.warnings,
            Strings{"has 1 bytes after the last sample that the header states"});
  EXPECT_EQ(
      MetaFile(small(kSpacing, "", "a.raw")).with("a.raw", counted(25)).file().source.warnings,
      Strings{"its data file a.raw has 1 bytes after the last sample that the header states"});
}

// ---- data files

TEST(MetaImageDataFiles, LocalInAnyCase) {
  for (const std::string local : {"LOCAL", "Local", "local"}) {
    EXPECT_EQ(MetaFile(small(kSpacing, counted(24), local)).samples(), counted(24)) << local;
  }
}

TEST(MetaImageDataFiles, Paths) {
  MetaFile file(small(kSpacing, "", "sub\\a  b.raw"));
  file.expect_refused(kBad, "no such file");
  std::filesystem::create_directory(file.path.parent_path() / "sub");
  file.with("sub/a  b.raw", counted(24));
  EXPECT_EQ(file.samples(), counted(24));
  EXPECT_EQ(
      MetaFile(small(kSpacing, "", (file.path.parent_path() / "sub/a  b.raw").string())).samples(),
      counted(24));
  MetaFile gz(small(kSpacing, "", "c.raw"));
  EXPECT_EQ(gz.with("c.raw.gz", gzipped(counted(24))).samples(),
            counted(24));  // MetaIO finds it, too
  MetaFile(small(kSpacing, "", "..")).expect_refused(kBad, "is a folder");
}

MetaFile& with_slices(MetaFile& file) {
  for (std::size_t z = 0; z < 4; ++z) {
    file.with("s0" + std::to_string(z + 1) + ".raw", counted(6, 6 * z));
  }
  return file;
}

TEST(MetaImageDataFiles, List) {
  const std::string names =
      "s01.raw\ns02.raw\r\n\ns03.raw\ns04.raw";  // MetaIO forgets a last line without an end
  for (const std::string list : {"LIST", "LIST 2", "LIST 0", "LIST 9"}) {
    MetaFile file(small(kSpacing, names, list));
    EXPECT_EQ(with_slices(file).samples(), counted(24)) << list;
  }
  MetaFile whole(small(kSpacing, "a.raw\n", "LIST 3"));
  EXPECT_EQ(whole.with("a.raw", counted(24)).samples(), counted(24));
  MetaFile times(four_dimensional("2 3 4 2", "a.raw\nb.raw\n", "", "LIST"));
  EXPECT_EQ(times.with("a.raw", counted(24)).with("b.raw", counted(24, 24)).samples({.time = 1}),
            counted(24, 24));
  MetaFile slices_of_times(
      four_dimensional("2 3 2 2", "s01.raw\ns02.raw\ns03.raw\ns04.raw\n", "", "LIST 2"));
  EXPECT_EQ(with_slices(slices_of_times).samples({.time = 1}), counted(12, 12));
  MetaFile few(small(kSpacing, "s01.raw\ns02.raw\n", "LIST"));
  with_slices(few).expect_refused(kBad, "names 2 data files, expected 4, each of dimension 2");
  MetaFile many(small(kSpacing, names + "\ns01.raw\n", "LIST"));
  with_slices(many).expect_refused(kBad, "names 5 data files, expected 4");
  MetaFile cut(small(kSpacing, names, "LIST"));
  with_slices(cut)
      .with("s03.raw", counted(5))
      .expect_refused(
          kBad,
          "s03.raw: is cut off or damaged: the header states 6 bytes of samples, the file has 5");
  MetaFile(small(kSpacing, names, "LIST two"))
      .expect_refused(kBad, "expected LIST and a dimension");
}

TEST(MetaImageDataFiles, ListOfPackedSlices) {
  MetaFile file(small(kSpacing + "CompressedData = True\n", "a\nb\nc\nd\n", "LIST"));
  for (std::size_t z = 0; z < 4; ++z) {
    file.with(std::string(1, static_cast<char>('a' + z)), gzipped(counted(6, 6 * z), false));
  }
  EXPECT_EQ(file.samples(), counted(24));
}

TEST(MetaImageDataFiles, ListsMayBeLong) {
  const TempFolder folder;
  std::string list;
  for (int i = 0; i < 3000; ++i) list += std::string(40, 'x') + ".raw\n";
  write_bytes(folder / (std::string(40, 'x') + ".raw"), "abcd");
  write_bytes(folder / "a.mhd",
              "ObjectType = Image\nNDims = 3\nDimSize = 2 2 3000\nElementType = "
              "MET_UCHAR\nElementDataFile = LIST\n" +
                  list);
  EXPECT_EQ(read_volume(folder / "a.mhd").view.grid.size[2], 3000U);
}

TEST(MetaImageDataFiles, Pattern) {
  for (const std::string pattern :
       {"s%02d.raw 1 4 1", "s%02d.raw", "s%02d.raw 1", "s%02d.raw 1 4", "s%02d.raw 1 9 1"}) {
    MetaFile file(small(kSpacing, "", pattern));
    EXPECT_EQ(with_slices(file).samples(), counted(24)) << pattern;
  }
  MetaFile blanks(small(kSpacing, "", "a  slice %d.raw 10 16 2"));
  for (std::size_t z = 0; z < 4; ++z) {
    blanks.with("a  slice " + std::to_string(10 + 2 * z) + ".raw", counted(6, 6 * z));
  }
  EXPECT_EQ(blanks.samples(), counted(24));
  MetaFile(small(kSpacing, "", "s%02d.raw 1 3 1"))
      .expect_refused(kBad, "expected numbers for the 4 samples of the last axis");
  MetaFile(small(kSpacing, "", "s%02d.raw 1 2"))
      .expect_refused(kBad, "expected numbers for the 4 samples of the last axis");
  MetaFile(small(kSpacing, "", "s%02d.raw 1 4 0"))
      .expect_refused(kBad, "expected numbers for the 4 samples of the last axis");
  MetaFile(small(kSpacing, "", "s%s%n.raw")).expect_refused(kBad, "no such file");
  MetaFile missing(small(kSpacing, "", "s%02d.raw 2 5 1"));
  with_slices(missing).expect_refused(kBad, "s05.raw: no such file");
}

// ---- the header itself

TEST(MetaImageHeader, ContentDecidesTheFormat) {
  for (const std::string name : {"scan.nii", "scan", "scan.nrrd"}) {
    EXPECT_EQ(MetaFile(small(), name).file().source.format, "MetaImage") << name;
  }
}

TEST(MetaImageHeader, Spelling) {
  EXPECT_EQ(MetaFile("NDims=3\r\nDimSize:2 3  4\r\n  ElementType  =  MET_UCHAR  "
                     "\r\nNote\r\nElementDataFile = LOCAL\r\n" +
                     counted(24))
                .samples(),
            counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "Comment = a = b : c\nModality = MET_MOD_CT\nMyField = "
                                      "x\nElementMin = 0\nElementNBits = 8\n"))
                .samples(),
            counted(24));
  EXPECT_EQ(MetaFile(small(kSpacing + "ElementSpacing = 3 4 5\n")).file().volume.view.grid.spacing,
            (Vec3{3, 4, 5}));  // the last spacing counts
}

TEST(MetaImageHeader, GzippedAsAWhole) {
  EXPECT_EQ(MetaFile(gzipped(small()), "a.mha.gz").samples(), counted(24));
  MetaFile(gzipped(small(kSpacing, counted(23)))).expect_refused(kBad, "the file has 23");
  MetaFile(gzipped(small(kSpacing + "CompressedData = True\n", gzipped(counted(24), false))))
      .expect_refused(kUnsupported, "expected one compression");
}

TEST(MetaImageHeader, OtherObjects) {
  MetaFile("ObjectType = Mesh\nNDims = 3\nElementDataFile = LOCAL\n")
      .expect_refused(kUnsupported, "a MetaIO file of a Mesh");
}

TEST(MetaImageHeader, Wrong) {
  MetaFile(
      "NDims = 3\nDimSize = 2 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + counted(24),
      "a.mha")
      .expect_refused(kBad, "DimSize is '2 3', expected 3 numbers");
  MetaFile("NDims = 3\nDimSize = 2 0 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
           "a.mha")
      .expect_refused(kBad, "DimSize is '2 0 4'");
  MetaFile("NDims = 11\nDimSize = 2 3 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
           "a.mha")
      .expect_refused(kBad, "at most 10");
  MetaFile("NDims = x\nDimSize = 2 3 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
           "a.mha")
      .expect_refused(kBad, "NDims is 'x'");
  MetaFile(
      "ObjectType = Image\nDimSize = 2 3 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
      "a.mha")
      .expect_refused(kBad, "NDims");
  MetaFile("ObjectType = Image\nNDims = 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
           "a.mha")
      .expect_refused(kBad, "DimSize is ''");
  MetaFile(small(kSpacing + "ElementDataFile =\n"), "a.mha")
      .expect_refused(kBad, "no ElementDataFile");
  // Cut at any place, a file gives an error at most.
  const std::string whole = small();
  for (std::size_t length = 1; length < whole.size(); ++length) {
    EXPECT_THROW(MetaFile(whole.substr(0, length), "a.mha").file(), Error) << length;
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
