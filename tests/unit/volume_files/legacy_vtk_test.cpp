// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"
#include "unit/volume_files/volume_files.h"

namespace isoatlas::detail::test {
namespace {

// SHA-256 of the samples of the field volumes, by numpy and VTK's own reader.
constexpr const char* kFieldDigest =
    "a4fa5c761d0d079ac164ffc4193be0900ba5767e29e874e52f6d693c4b75c59d";
constexpr const char* kGeometry = "DIMENSIONS 4 3 2\nSPACING 0.5 0.25 2\nORIGIN 1 2 3\n";
constexpr int kPoints = 24, kCells = 6;

std::string start(const std::string& format = "BINARY",
                  const std::string& dataset = "STRUCTURED_POINTS") {
  return "# vtk DataFile Version 3.0\ntitle\n" + format + "\nDATASET " + dataset + "\n";
}

template <class T>
std::string big_endian(const std::vector<T>& values) {
  std::string bytes;
  for (T value : values) {
    std::string one(reinterpret_cast<const char*>(&value), sizeof value);
    if (std::endian::native == std::endian::little) std::ranges::reverse(one);
    bytes += one;
  }
  return bytes;
}

template <class T = float>
std::vector<T> ramp(int count, int first = 0) {
  std::vector<T> values;
  for (int i = 0; i < count; ++i) values.push_back(static_cast<T>(first + i));
  return values;
}

std::string text(const std::vector<double>& values) {
  std::string numbers;
  for (const double value : values) numbers += std::to_string(value) + " ";
  return numbers + "\n";
}

std::string integers(int count, int first = 0) {
  std::string numbers;
  for (int i = 0; i < count; ++i) numbers += std::to_string(first + i) + (i % 7 == 6 ? "\n" : " ");
  return numbers + "\n";
}

class LegacyVtk : public testing::Test {
 protected:
  VolumeFile read(const std::string& bytes, const ReadOptions& options = {}) {
    write_bytes(path(), bytes);
    return read_volume_file(path(), options);
  }
  void expect_refused(const std::string& bytes, ErrorCode code, const std::string& message,
                      const ReadOptions& options = {}) {
    write_bytes(path(), bytes);
    expect_error(code, message, path(), [&] { read_volume_file(path(), options); });
  }
  std::filesystem::path path() const { return folder_ / "a.vtk"; }
  TempFolder folder_;
};

void expect_ramp(const VolumeFile& file, int count = kPoints, double first = 0, double step = 1) {
  const std::vector<double> samples = samples_as_double(file.volume);
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) EXPECT_EQ(samples[static_cast<std::size_t>(i)], first + step * i);
}

std::string decision(const VolumeFile& file, const std::string& key) {
  for (const ReadDecision& decision : file.source.decisions)
    if (decision.key == key) return decision.value;
  return "";
}

TEST_F(LegacyVtk, FieldVolumesAreRead) {
  for (const auto& [name, origin] : {std::pair{"l_both_b.vtk", Vec3{1, 2, 3}},
                                     {"l_field.vtk", Vec3{}},
                                     {"l_title_ascii.vtk", Vec3{}}}) {
    SCOPED_TRACE(name);
    const VolumeFile file = read_volume_file(field_file(name));
    expect_size_and_spacing(file.volume, {24, 20, 16}, {0.5, 0.5, 2});
    EXPECT_EQ(file.volume.view.grid.origin, origin);
    EXPECT_EQ(file.volume.view.grid.direction, Grid{}.direction);
    EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::unknown);
    EXPECT_EQ(file.volume.view.type, SampleType::float32);
    EXPECT_EQ(sample_digest(file.volume), kFieldDigest);
    EXPECT_EQ(file.source.format, "legacy VTK");
    EXPECT_TRUE(file.source.warnings.empty());
  }
}

// As vtkStructuredPointsWriter writes it with WriteExtent.
TEST_F(LegacyVtk, ExtentsLocateTheFirstPoint) {
  const std::string geometry = "EXTENT -2 1 3 5 1 2\nSPACING 0.5 1 2\nORIGIN 10 20 30\n";
  const std::string values =
      "POINT_DATA 24\nSCALARS v float\nLOOKUP_TABLE default\n" + integers(kPoints);
  const VolumeFile file = read(start("ASCII") + geometry + values);
  expect_size_and_spacing(file.volume, {4, 3, 2}, {0.5, 1, 2});
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{9, 23, 32}));
  expect_ramp(file);
  expect_refused(start("ASCII") + "EXTENT 0 3 2 0 0 1\n" + values, ErrorCode::bad_file,
                 "goes from 2 to 0 along y");
  expect_refused(start("ASCII") + "EXTENT 0 9999999999 0 2 0 1\n" + values, ErrorCode::bad_file,
                 "expected 32-bit indices");
}

TEST_F(LegacyVtk, CellDataIsAtTheCentresOfCells) {
  const VolumeFile file = read_volume_file(field_file("l_both_b.vtk"), {.array = "cell:c"});
  expect_size_and_spacing(file.volume, {23, 19, 15}, {0.5, 0.5, 2});
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1.25, 2.25, 4}));
  EXPECT_EQ(file.volume.view.type, SampleType::float64);
  EXPECT_EQ(decision(file, "samples"), "cell data, at the centres of the cells");
  EXPECT_EQ(file.source.choices[0].entries,
            (std::vector<std::string>{"v: float32", "cell:c: float64"}));
  EXPECT_EQ(read_volume_file(field_file("l_both_b.vtk"), {.array = "c"}).volume.view.type,
            SampleType::float64);
}

TEST_F(LegacyVtk, CellDataAloneIsRead) {
  const std::string geometry =
      "DIMENSIONS 4 3 3\nCELL_DATA 12\nSCALARS c short\nLOOKUP_TABLE default\n";
  const VolumeFile file = read(start() + geometry + big_endian(ramp<std::int16_t>(12)));
  expect_size_and_spacing(file.volume, {3, 2, 2}, {1, 1, 1});
  expect_ramp(file, 12);
}

TEST_F(LegacyVtk, EveryTypeIsRead) {
  const auto check = [&](const std::string& name, SampleType type, const std::string& bytes) {
    SCOPED_TRACE(name);
    const std::string section =
        kGeometry + std::string("POINT_DATA 24\nSCALARS s ") + name + " 1\nLOOKUP_TABLE default\n";
    for (const VolumeFile& file :
         {read(start() + section + bytes), read(start("ASCII") + section + integers(kPoints))}) {
      EXPECT_EQ(file.volume.view.type, type);
      expect_ramp(file);
    }
  };
  check("char", SampleType::int8, big_endian(ramp<std::int8_t>(kPoints)));
  check("signed_char", SampleType::int8, big_endian(ramp<std::int8_t>(kPoints)));
  check("unsigned_char", SampleType::uint8, big_endian(ramp<std::uint8_t>(kPoints)));
  check("short", SampleType::int16, big_endian(ramp<std::int16_t>(kPoints)));
  check("Unsigned_Short", SampleType::uint16, big_endian(ramp<std::uint16_t>(kPoints)));
  check("int", SampleType::int32, big_endian(ramp<std::int32_t>(kPoints)));
  check("unsigned_int", SampleType::uint32, big_endian(ramp<std::uint32_t>(kPoints)));
  check("vtkIdType", SampleType::int32, big_endian(ramp<std::int32_t>(kPoints)));
  check("long", SampleType::int64, big_endian(ramp<std::int64_t>(kPoints)));
  check("unsigned_long", SampleType::uint64, big_endian(ramp<std::uint64_t>(kPoints)));
  check("vtktypeint64", SampleType::int64, big_endian(ramp<std::int64_t>(kPoints)));
  check("vtktypeuint64", SampleType::uint64, big_endian(ramp<std::uint64_t>(kPoints)));
  check("float", SampleType::float32, big_endian(ramp<float>(kPoints)));
  check("double", SampleType::float64, big_endian(ramp<double>(kPoints)));
}

TEST_F(LegacyVtk, BitsAreRead) {
  const std::string section =
      kGeometry + std::string("POINT_DATA 24\nSCALARS s bit 1\nLOOKUP_TABLE default\n");
  const VolumeFile binary = read(start() + section + "\x80\x01\xF0");
  const VolumeFile ascii =
      read(start("ASCII") + section + "1 0 0 0 0 0 0 0  0 0 0 0 0 0 0 1  1 1 1 1 0 0 0 0\n");
  EXPECT_EQ(sample_digest(binary.volume), sample_digest(ascii.volume));
  EXPECT_EQ(sample_as_double(binary.volume, 15), 1);
  EXPECT_EQ(sample_as_double(binary.volume, 14), 0);
}

TEST_F(LegacyVtk, LongOfWindowsHasFourBytes) {
  const std::string section =
      kGeometry + std::string("POINT_DATA 24\nSCALARS s long 1\nLOOKUP_TABLE default\n");
  const VolumeFile alone = read(start() + section + big_endian(ramp<std::int32_t>(kPoints)));
  EXPECT_EQ(alone.volume.view.type, SampleType::int32);
  expect_ramp(alone);
  const std::string more = "\nVECTORS v float\n" + big_endian(ramp<float>(3 * kPoints));
  expect_ramp(read(start() + section + big_endian(ramp<std::int32_t>(kPoints)) + more));
  expect_ramp(read(start() + section + big_endian(ramp<std::int64_t>(kPoints)) + more));
  const std::string field = kGeometry +
                            std::string("POINT_DATA 24\nFIELD f 2\na 1 24 unsigned_long\n") +
                            big_endian(ramp<std::uint32_t>(kPoints)) + "\nb 1 24 float\n" +
                            big_endian(ramp<float>(kPoints, 7)) + "\n";
  expect_ramp(read(start() + field, {.array = "a"}));
  expect_ramp(read(start() + field, {.array = "b"}), kPoints, 7);
}

TEST_F(LegacyVtk, VtkWritesUnsignedCharAsColours) {
  const std::string section = kGeometry + std::string("POINT_DATA 24\nCOLOR_SCALARS s 1\n");
  const VolumeFile binary = read(start() + section + big_endian(ramp<std::uint8_t>(kPoints, 200)));
  EXPECT_EQ(binary.volume.view.type, SampleType::uint8);
  expect_ramp(binary, kPoints, 200);
  std::vector<double> fractions;
  for (int i = 0; i < kPoints; ++i) fractions.push_back((200 + i) / 255.0);
  expect_ramp(read(start("ASCII") + section + text(fractions)), kPoints, 200);
  expect_refused(start("ASCII") + section + integers(kPoints), ErrorCode::bad_file,
                 "'2', expected a value of type colour, from 0 to 1");
}

TEST_F(LegacyVtk, ComponentsAreChannels) {
  const std::string colours = kGeometry + std::string("POINT_DATA 24\nCOLOR_SCALARS s 3\n") +
                              big_endian(ramp<std::uint8_t>(3 * kPoints));
  expect_refused(start() + colours, ErrorCode::unsupported,
                 "has 3 channels, expected a choice of one: 0, 1, 2");
  expect_ramp(read(start() + colours, {.channel = "2"}), kPoints, 2, 3);
  const std::string scalars =
      kGeometry + std::string("POINT_DATA 24\nSCALARS s short 4\nLOOKUP_TABLE default\n");
  expect_ramp(
      read(start() + scalars + big_endian(ramp<std::int16_t>(4 * kPoints)), {.channel = "1"}),
      kPoints, 1, 4);
  expect_ramp(read(start("ASCII") + scalars + integers(4 * kPoints), {.channel = "3"}), kPoints, 3,
              4);
  for (const auto& [keyword, components] :
       {std::pair{"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}}) {
    const std::string section = std::string(kGeometry) + "POINT_DATA 24\n" + keyword + " v float\n";
    const std::string values = big_endian(ramp<float>(components * kPoints));
    expect_ramp(read(start() + section + values, {.channel = "1"}), kPoints, 1, components);
    expect_refused(start() + section + values, ErrorCode::bad_argument, "has no channel '9'",
                   {.channel = "9"});
  }
}

TEST_F(LegacyVtk, MetadataNamesComponentsAndEndsWithAnEmptyLine) {
  const std::string metadata =
      "METADATA\nCOMPONENT_NAMES\nu%20x\n\nw\nINFORMATION 1\n"
      "NAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n";
  const std::string file = start("ASCII") + kGeometry + "POINT_DATA 24\nVECTORS v float\n" +
                           integers(3 * kPoints) + metadata +
                           "FIELD FieldData 2\nv%202 3 24 float\n" + integers(3 * kPoints, 5) +
                           metadata + "last 1 24 int\n" + integers(kPoints, 9) + "\n";
  const VolumeFile vectors = read(file, {.channel = "2", .array = "v"});
  EXPECT_EQ(vectors.source.choices[1].entries, (std::vector<std::string>{"u x", "1", "w"}));
  expect_ramp(vectors, kPoints, 2, 3);
  expect_ramp(read(file, {.channel = "0", .array = "v 2"}), kPoints, 5, 3);
  expect_ramp(read(file, {.array = "last"}), kPoints, 9);
}

TEST_F(LegacyVtk, SeveralArraysAreListed) {
  const std::string field = start("ASCII") + kGeometry +
                            "POINT_DATA 24\nFIELD f 2\na 1 24 float\n" + integers(kPoints) +
                            "b 3 24 int\n" + integers(3 * kPoints);
  expect_refused(
      field, ErrorCode::unsupported,
      "has 2 arrays, expected a choice of one: 0 (a: float32), 1 (b: int32, 3 components)");
  expect_ramp(read(field, {.array = "0"}));
  const std::string marked = field + "SCALARS s float\nLOOKUP_TABLE t\n" + integers(kPoints, 4) +
                             "LOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\n";
  expect_ramp(read(marked), kPoints, 4);
  const std::string twice =
      marked + "SCALARS s2 float\nLOOKUP_TABLE default\n" + integers(kPoints, 8);
  expect_refused(twice, ErrorCode::unsupported, "has 4 arrays");
  expect_ramp(read(twice, {.array = "s2"}), kPoints, 8);
}

TEST_F(LegacyVtk, ArraysThatAreNotVolumesAreNotListed) {
  const std::string file =
      start("ASCII") +
      "FIELD FieldData 2\nTIME 1 1 double\n0.5\nnames 1 2 string\none%20two\nthree\n" + kGeometry +
      "POINT_DATA 24\nGLOBAL_IDS ids vtkIdType\n" + integers(kPoints) +
      "TEXTURE_COORDINATES t 2 float\n" + integers(2 * kPoints) +
      "FIELD f 3\nvtkGhostType 1 24 unsigned_char\n" + integers(kPoints) + "v 1 24 float\n" +
      integers(kPoints, 3) + "NULL_ARRAY\n";
  const VolumeFile volume = read(file);
  EXPECT_EQ(volume.source.choices[0].entries, (std::vector<std::string>{"v: float32"}));
  expect_ramp(volume, kPoints, 3);
}

TEST_F(LegacyVtk, BinaryStringsAreSkipped) {
  const std::string lengths = std::string(
                                  "\xC3"
                                  "abc") +
                              "\x80\x03"
                              "abc" +
                              std::string("\x40\0\0\3abc", 7) +
                              std::string("\0\0\0\0\0\0\0\3abc", 11);
  const std::string file = start() + "FIELD FieldData 1\nnames 2 2 string\n" + lengths + "\n" +
                           kGeometry + "POINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE default\n" +
                           big_endian(ramp(kPoints));
  expect_ramp(read(file));
}

TEST_F(LegacyVtk, KeywordsLineEndsAndOrderAreFree) {
  const std::string values = big_endian(ramp(kPoints));
  const std::string aspect =
      "# vtk DataFile Version 2.0\r\nASCII \r\nbinary\r\ndataset structured_points\r\norigin 1 2 "
      "3\r\n"
      "aspect_ratio 0.5 0.25 2\r\ndimensions 4 3 2\r\npoint_data 24\r\nscalars s "
      "Float\r\nlookup_table default\r\n";
  const VolumeFile file = read(aspect + values);
  expect_size_and_spacing(file.volume, {4, 3, 2}, {0.5, 0.25, 2});
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1, 2, 3}));
  expect_ramp(file);
  expect_ramp(read(start() + kGeometry + "POINT_DATA 24\nSCALARS s float 1\n" +
                   values));  // no LOOKUP_TABLE
  expect_ramp(
      read(start("ASCII") + kGeometry + "POINT_DATA 24\nSCALARS s float 1\n" + integers(kPoints)));
}

TEST_F(LegacyVtk, WarnsOfMissingSpacing) {
  const std::string rest =
      "POINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE default\n" + big_endian(ramp(kPoints));
  EXPECT_FALSE(read(start() + "DIMENSIONS 4 3 2\n" + rest).source.has_spacing);
  EXPECT_TRUE(read(start() + kGeometry + rest).source.has_spacing);
}

TEST_F(LegacyVtk, NumbersAreReadExactly) {
  const std::string section = std::string("DIMENSIONS 2 2 2\nPOINT_DATA 8\nSCALARS s ");
  const VolumeFile doubles =
      read(start("ASCII") + section +
           "double\nLOOKUP_TABLE default\n0.1 -1e-400 nan inf 1e3 +2 -inf 4.9e-324\n");
  EXPECT_EQ(sample_as_double(doubles.volume, 0), 0.1);
  EXPECT_EQ(sample_as_double(doubles.volume, 1), 0);
  EXPECT_TRUE(std::isnan(sample_as_double(doubles.volume, 2)));
  EXPECT_TRUE(std::isinf(sample_as_double(doubles.volume, 3)));
  EXPECT_TRUE(std::isinf(sample_as_double(doubles.volume, 6)));
  EXPECT_EQ(sample_as_double(doubles.volume, 7), 4.9e-324);
  expect_refused(start("ASCII") + section + "float\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 1e40\n",
                 ErrorCode::bad_file, "after 7 numbers it has '1e40'");
  expect_refused(start("ASCII") + section + "double\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 1e400\n",
                 ErrorCode::bad_file, "after 7 numbers it has '1e400'");
  const std::string bytes = "unsigned_char\nLOOKUP_TABLE default\n0 1.0 2e1 255 4 5 6 ";
  EXPECT_EQ(sample_as_double(read(start("ASCII") + section + bytes + "7\n").volume, 2), 20);
  for (const std::string wrong : {"256", "-1", "1.5", "nan", "1x"}) {
    expect_refused(start("ASCII") + section + bytes + wrong + "\n", ErrorCode::bad_file,
                   "after 7 numbers it has '" + wrong + "'");
  }
}

TEST_F(LegacyVtk, RectilinearGridsNeedEqualSteps) {
  const auto grid = [](const std::string& x) {
    return start("ASCII", "RECTILINEAR_GRID") + "DIMENSIONS 4 3 2\nX_COORDINATES 4 float\n" + x +
           "\nY_COORDINATES 3 int\n9 7 5\nZ_COORDINATES 2 double\n0 0.5\n" +
           "POINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE d\n" + integers(kPoints);
  };
  const VolumeFile file = read(grid("0.1 0.4333333 0.7666667 1.1"));
  expect_size_and_spacing(file.volume, {4, 3, 2}, {1.0 / 3, 2, 0.5});
  EXPECT_EQ(file.volume.view.grid.direction[1], (Vec3{0, -1, 0}));
  EXPECT_NEAR(file.volume.view.grid.origin.x, 0.1, 1e-8);
  EXPECT_EQ(file.volume.view.grid.origin.y, 9);
  EXPECT_TRUE(file.source.has_spacing);
  expect_ramp(file);
  expect_refused(grid("0 1 2.5 3"), ErrorCode::unsupported,
                 "its x coordinates are uneven: steps of 0.5 and of 1.5");
  expect_refused(grid("0 1 nan 3"), ErrorCode::bad_file, "its x coordinates are not finite");
  expect_refused(grid("5 5 5 5"), ErrorCode::bad_file, "the spacing along x is 0");
  expect_refused(
      start("ASCII", "RECTILINEAR_GRID") + "DIMENSIONS 4 3 2\nX_COORDINATES 3 float\n1 2 3\n",
      ErrorCode::bad_file, "has 3 x coordinates, expected 4");
  expect_refused(start("ASCII", "RECTILINEAR_GRID") +
                     "DIMENSIONS 4 3 2\nPOINT_DATA 24\nSCALARS s float\n" + integers(kPoints),
                 ErrorCode::bad_file, "has no x coordinates");
}

TEST_F(LegacyVtk, BinaryRectilinearGridIsRead) {
  const std::string file =
      start("BINARY", "RECTILINEAR_GRID") + "DIMENSIONS 4 3 2\nX_COORDINATES 4 float\n" +
      big_endian(std::vector<float>{0.1F, 0.2F, 0.3F, 0.4F}) + "\nY_COORDINATES 3 double\n" +
      big_endian(std::vector<double>{0, 1, 2}) + "\nZ_COORDINATES 2 float\n" +
      big_endian(std::vector<float>{5, 6}) +
      "\nPOINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE default\n" + big_endian(ramp(kPoints));
  const VolumeFile volume = read(file);
  expect_size_and_spacing(volume.volume, {4, 3, 2}, {0.1, 1, 1});
  expect_ramp(volume);
}

TEST_F(LegacyVtk, OtherDataSetsAreNamed) {
  const std::string rest = "POINTS 1 float\n0 0 0\n";
  expect_refused(start("ASCII", "POLYDATA") + rest, ErrorCode::unsupported,
                 "is a mesh file (POLYDATA)");
  expect_refused(start("ASCII", "UNSTRUCTURED_GRID") + rest, ErrorCode::unsupported,
                 "holds an unstructured grid");
  expect_refused(start("ASCII", "STRUCTURED_GRID") + rest, ErrorCode::unsupported,
                 "holds a curvilinear grid");
  expect_refused(start("ASCII", "TABLE") + rest, ErrorCode::unsupported, "holds a DATASET 'table'");
  expect_refused("# vtk DataFile Version 3.0\nt\nASCII\nFIELD f 0\n", ErrorCode::unsupported,
                 "holds no DATASET");
  expect_refused("# vtk DataFile Version 3.0\nt\nTEXT\n", ErrorCode::bad_file,
                 "expected ASCII or BINARY");
}

TEST_F(LegacyVtk, ContradictionsAreNamed) {
  const std::string values = big_endian(ramp(kPoints));
  const std::string scalars = "SCALARS s float\nLOOKUP_TABLE default\n" + values;
  expect_refused(start() + kGeometry + "POINT_DATA 23\n" + scalars, ErrorCode::bad_file,
                 "its POINT_DATA states 23 values, but its dimensions 4 x 3 x 2 require 24");
  expect_refused(start() + kGeometry + scalars, ErrorCode::bad_file, "precede POINT_DATA");
  expect_refused(start() + kGeometry + "POINT_DATA 24\nSCALARS s complex\n" + values,
                 ErrorCode::bad_file, "unknown type 'complex'");
  expect_refused(
      start() + kGeometry + "POINT_DATA 24\nFIELD f 1\ns 1 20 float\n" + values.substr(0, 80),
      ErrorCode::bad_file, "its array 's' has 20 values, expected one for each of 24 samples");
  expect_refused(start() + kGeometry + "POINT_DATA 24\n", ErrorCode::unsupported,
                 "has no array of numbers");
  expect_refused(start() + kGeometry + "PINT_DATA 24\n" + scalars, ErrorCode::bad_file,
                 "has 'pint_data' where a section should begin");
  expect_refused(start() + kGeometry + "POINT_DATA 24\nSCALARS s float 2000\nLOOKUP_TABLE d\n" +
                     std::string(8000 * kPoints, 'x'),
                 ErrorCode::unsupported, "2000 values per sample");
  expect_refused(start() + "DIMENSIONS 4 6 1\nPOINT_DATA 24\n" + scalars, ErrorCode::unsupported,
                 "4 x 6 x 1");
}

TEST_F(LegacyVtk, BytesAfterTheLastSectionGiveAWarning) {
  const std::string whole = start() + kGeometry +
                            "POINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE default\n" +
                            big_endian(ramp(kPoints));
  EXPECT_TRUE(read(whole + "\n\n").source.warnings.empty());
  const VolumeFile longer = read(whole + "\nabcd");
  ASSERT_EQ(longer.source.warnings.size(), 1U);
  EXPECT_EQ(longer.source.warnings[0],
            "has 5 bytes more than its header states; they are not read");
  expect_ramp(longer);
}

// A file that is cut gives either all samples or an error.
TEST_F(LegacyVtk, CutFilesAreRefused) {
  const std::string cells = "CELL_DATA 6\nSCALARS c double\nLOOKUP_TABLE default\n";
  const std::string points = "\nPOINT_DATA 24\nFIELD f 2\na 1 24 float\n";
  const std::string binary = start() +
                             "FIELD n 1\ns 1 1 string\n\xC2"
                             "ab\n" +
                             kGeometry + cells + big_endian(ramp<double>(kCells)) + points +
                             big_endian(ramp(kPoints)) + "\nb 1 24 short\n" +
                             big_endian(ramp<std::int16_t>(kPoints)) + "\n";
  const std::string ascii = start("ASCII") + kGeometry + cells + integers(kCells) + points +
                            integers(kPoints) + "b 1 24 short\n" + integers(kPoints, 100) + "\n";
  for (const std::string& whole : {binary, ascii}) {
    const std::string digest = sample_digest(read(whole, {.array = "a"}).volume);
    const std::size_t end = whole.find_last_not_of(" \n") + 1;
    const std::size_t first_whole =
        whole == ascii ? end - 2 : end;  // "123" without its last digits is still a number
    for (std::size_t size = 1; size < end; ++size) {
      write_bytes(path(), whole.substr(0, size));
      if (size < first_whole) {
        EXPECT_THROW(read_volume_file(path(), {.array = "a"}), Error) << size;
      } else {
        EXPECT_EQ(sample_digest(read_volume(path(), {.array = "a"})), digest);
      }
    }
  }
}

TEST_F(LegacyVtk, CompressedFilesAreRefused) {
  const std::string whole =
      start("ASCII") + kGeometry + "POINT_DATA 24\nSCALARS s float\n" + integers(kPoints);
  gzFile file = gzopen(path().c_str(), "wb");
  gzwrite(file, whole.data(), static_cast<unsigned>(whole.size()));
  gzclose(file);
  expect_error(ErrorCode::unsupported, "is a compressed legacy VTK file", path(),
               [&] { read_volume(path()); });
}

TEST_F(LegacyVtk, StatedSizesAreCheckedBeforeMemoryIsAllocated) {
  const std::string huge = "DIMENSIONS 2000000 1000000 1000000\nPOINT_DATA 2000000000000000000\n";
  expect_refused(start() + huge + "SCALARS s float\nLOOKUP_TABLE default\nabc", ErrorCode::bad_file,
                 "more than any file can hold");
  expect_refused(start("ASCII") +
                     "DIMENSIONS 2000 1000 1000\nPOINT_DATA 2000000000\nSCALARS s "
                     "float\nLOOKUP_TABLE default\n1 2",
                 ErrorCode::bad_file, "states 2000000000 numbers, the file has 2");
  expect_refused(start() + "DIMENSIONS 4294967296 4294967296 4294967296\nPOINT_DATA 0\n",
                 ErrorCode::bad_file, "more than any file can hold");
  expect_refused(start() + kGeometry + "POINT_DATA 24\nFIELD f 99999999999\na 0 0 float\n",
                 ErrorCode::bad_file, "a FIELD has 1 arrays");
  expect_refused(start() + kGeometry + "FIELD f 1\na 1 18446744073709551615 string\nabc",
                 ErrorCode::bad_file, "");
  expect_refused(start() + kGeometry + "POINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE default\n" +
                     big_endian(ramp(kPoints)),
                 ErrorCode::out_of_memory, "96 bytes", {.max_memory = 95});
}

}  // namespace
}  // namespace isoatlas::detail::test
