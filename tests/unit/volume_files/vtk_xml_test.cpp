// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

// SHA-256 of the samples of the field volumes, by numpy and VTK's own reader.
constexpr const char* kFieldDigest =
    "a4fa5c761d0d079ac164ffc4193be0900ba5767e29e874e52f6d693c4b75c59d";
constexpr int kPoints = 24;  // in the extent 0 3 0 2 0 1

std::string integers(int count, int first = 0, int step = 1) {
  std::string numbers;
  for (int i = 0; i < count; ++i) numbers += std::to_string(first + step * i) + " ";
  return numbers;
}

std::string array(const std::string& attributes, const std::string& values) {
  return "<DataArray " + attributes + " format='ascii'>\n" + values + "\n</DataArray>\n";
}

std::string floats(const std::string& name, const std::string& values) {
  return array("type='Float32' Name='" + name + "'", values);
}

std::string vtk_file(const std::string& type, const std::string& grid_attributes,
                     const std::string& content, const std::string& file_attributes = "") {
  return "<?xml version='1.0'?>\n<VTKFile type='" + type +
         "' version='1.0' byte_order='LittleEndian' " + file_attributes + ">\n<" + type + " " +
         grid_attributes + ">\n" + content + "</" + type + ">\n</VTKFile>\n";
}

std::string piece(const std::string& extent, const std::string& content) {
  return "<Piece Extent='" + extent + "'>\n" + content + "</Piece>\n";
}

std::string point_data(const std::string& arrays, const std::string& attributes = "") {
  return "<PointData " + attributes + ">\n" + arrays + "</PointData>\n";
}

std::string cell_data(const std::string& arrays) {
  return "<CellData>\n" + arrays + "</CellData>\n";
}

constexpr const char* kImage = "WholeExtent='0 3 0 2 0 1' Origin='1 2 3' Spacing='0.5 0.25 2'";

std::string image(const std::string& content) {
  return vtk_file("ImageData", kImage, piece("0 3 0 2 0 1", content));
}

// A raw appended array with any header and bytes.
std::string appended(const std::string& data,
                     const std::string& file_attributes = "header_type='UInt32'") {
  std::string file = vtk_file(
      "ImageData", kImage,
      piece("0 3 0 2 0 1",
            point_data("<DataArray type='Float32' Name='v' format='appended' offset='0'/>\n")),
      file_attributes);
  file.insert(file.find("</VTKFile>"),
              "<AppendedData encoding='raw'>\n_" + data + "\n</AppendedData>\n");
  return file;
}

std::string number(std::uint64_t value, std::size_t bytes = 4) {
  return {reinterpret_cast<const char*>(&value), bytes};
}

std::string ramp_bytes(int count = kPoints) {
  std::string bytes;
  for (int i = 0; i < count; ++i) {
    const auto value = static_cast<float>(i);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  packed.resize(size);
  return packed;
}

class VtkXml : public testing::Test {
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
  fs::path path() const { return folder_ / "a.vti"; }
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

TEST_F(VtkXml, FieldVolumesAreRead) {
  struct Row {
    const char* name;
    const char* format;
    Vec3 spacing, origin;
    std::string array = {};
  };
  const std::vector<Row> rows{
      {"v_cell.vti", "VTK XML image data", {0.5, 0.5, 2}, {1.25, 2.25, 4}},
      {"v_two_none.vti", "VTK XML image data", {0.5, 0.5, 2}, {1, 2, 3}, "a"},
      {"v_rect.vtr", "VTK XML rectilinear grid", {0.5, 0.5, 2}, {0, 0, 0}},
      {"v_par.pvti", "VTK XML parallel image data", {0.5, 0.5, 2}, {1, 2, 3}},
      {"v_far.vti", "VTK XML image data", {1, 1, 1}, {500000, 4649776, 100}}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const VolumeFile file = read_volume_file(field_file(row.name), {.array = row.array});
    expect_size_and_spacing(file.volume, {24, 20, 16}, row.spacing, 0);
    EXPECT_EQ(file.volume.view.grid.origin, row.origin);
    EXPECT_EQ(file.volume.view.grid.direction, Grid{}.direction);
    EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::unknown);
    EXPECT_EQ(file.volume.view.type, SampleType::float32);
    EXPECT_EQ(sample_digest(file.volume), kFieldDigest);
    EXPECT_EQ(file.source.format, row.format);
    EXPECT_TRUE(file.source.warnings.empty());
    EXPECT_TRUE(file.source.has_spacing);
  }
  EXPECT_EQ(decision(read_volume_file(field_file("v_cell.vti")), "samples"),
            "cell data, at the centres of the cells");
}

TEST_F(VtkXml, SeveralArraysAreListed) {
  try {
    read_volume_file(field_file("v_two_none.vti"));
    FAIL() << "expected ChoiceNeeded";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_EQ(needed.choice().name, "array");
    EXPECT_EQ(needed.choice().entries, (std::vector<std::string>{"a: float32", "b: float32"}));
  }
  const VolumeFile a = read_volume_file(field_file("v_two_none.vti"), {.array = "a"});
  const VolumeFile b = read_volume_file(field_file("v_two_none.vti"), {.array = "b"});  // -a
  for (std::size_t i = 0; i < 7680; ++i)
    ASSERT_EQ(sample_as_double(b.volume, i), -sample_as_double(a.volume, i));
  EXPECT_EQ(sample_digest(read_volume(field_file("v_two_none.vti"), {.array = "1"})),
            sample_digest(b.volume));
  EXPECT_THROW(read_volume(field_file("v_two_none.vti"), {.array = "c"}), Error);
}

TEST_F(VtkXml, TheMarkedArrayIsRead) {
  const std::string arrays = floats("a", integers(kPoints)) + floats("b", integers(kPoints, 5));
  expect_ramp(read(image(point_data(arrays, "Scalars='b'"))), kPoints, 5);
  expect_ramp(read(image(point_data(arrays, "Scalars='b'")), {.array = "a"}));
  const std::string ids =
      "<DataArray type='Int64' Name='ids' format='ascii'>" + integers(kPoints) + "</DataArray>";
  expect_ramp(read(image(point_data(floats("a", integers(kPoints)) + ids, "GlobalIds='ids'"))));
  const std::string strings = "<Array type='String' Name='s' format='ascii'>97 0</Array>";
  expect_ramp(read(image(point_data(strings + floats("a", integers(kPoints))))));
}

TEST_F(VtkXml, PointDataComesBeforeCellData) {
  const std::string both =
      image(point_data(floats("v", integers(kPoints))) + cell_data(floats("v", integers(6, 50))));
  const VolumeFile points = read(both);
  expect_ramp(points);
  EXPECT_EQ(points.source.choices[0].entries,
            (std::vector<std::string>{"v: float32", "cell:v: float32"}));
  expect_refused(both, ErrorCode::unsupported, "3 x 2 x 1",
                 {.array = "cell:v"});  // one layer of cells is not a volume
}

TEST_F(VtkXml, ComponentsAreChannels) {
  const std::string vectors = image(point_data(
      array("type='Int16' Name='v' NumberOfComponents='3' ComponentName0='x' ComponentName2='z'",
            integers(3 * kPoints))));
  expect_refused(vectors, ErrorCode::unsupported,
                 "has 3 channels, expected a choice of one: 0 (x), 1, 2 (z)");
  for (const int channel : {0, 1, 2}) {
    expect_ramp(read(vectors, {.channel = std::to_string(channel)}), kPoints, channel, 3);
  }
  expect_ramp(read(vectors, {.channel = "z"}), kPoints, 2, 3);
  expect_refused(image(point_data(array("type='Int16' Name='v' NumberOfComponents='0'", ""))),
                 ErrorCode::unsupported, "has 0 values per sample");
  expect_refused(image(point_data(array("type='Int16' Name='v' NumberOfComponents='5000'", ""))),
                 ErrorCode::unsupported, "has 5000 values per sample");
}

TEST_F(VtkXml, TimesAreChosen) {
  const std::string arrays = array("type='Float32' Name='v' TimeStep='0'", integers(kPoints)) +
                             array("type='Float32' Name='v' TimeStep='1 2'", integers(kPoints, 7)) +
                             floats("w", integers(kPoints, 9));
  const std::string file = vtk_file("ImageData", std::string(kImage) + " TimeValues='0 0.5 1'",
                                    piece("0 3 0 2 0 1", point_data(arrays)));
  expect_refused(file, ErrorCode::unsupported, "has 3 time points", {.array = "v"});
  expect_ramp(read(file, {.time = 0, .array = "v"}));
  expect_ramp(read(file, {.time = 2, .array = "v"}), kPoints, 7);
  expect_ramp(read(file, {.time = 2, .array = "w"}), kPoints, 9);
}

TEST_F(VtkXml, GeometryIsThatOfTheFile) {
  const std::string content = piece("-2 1 5 7 10 11", point_data(floats("v", integers(kPoints))));
  const VolumeFile turned = read(vtk_file("ImageData",
                                          "WholeExtent='-2 1 5 7 10 11' Origin='1 2 3' "
                                          "Spacing='0.5 0.25 2' Direction='0 -1 0 1 0 0 0 0 1'",
                                          content));
  EXPECT_EQ(turned.volume.view.grid.direction[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(turned.volume.view.grid.direction[1], (Vec3{-1, 0, 0}));
  EXPECT_EQ(turned.volume.view.grid.origin, (Vec3{1 - 5 * 0.25, 2 - 2 * 0.5, 23}));
  const VolumeFile plain = read(vtk_file("ImageData", "WholeExtent='-2 1 5 7 10 11'", content));
  EXPECT_FALSE(plain.source.has_spacing);
  EXPECT_EQ(plain.volume.view.grid.origin, (Vec3{-2, 5, 10}));
  for (const std::string wrong :
       {"0 3 0 2", "0 3 0 2 0 x", "0 3 0 2 0 1.5", "0 3 0 2 0 99999999999", ""}) {
    expect_refused(vtk_file("ImageData", "WholeExtent='" + wrong + "'", content),
                   ErrorCode::bad_file, "WholeExtent is '" + wrong + "'");
  }
  expect_refused(vtk_file("ImageData", "", content), ErrorCode::bad_file, "has no WholeExtent");
  expect_refused(vtk_file("ImageData", "WholeExtent='-2 1 5 7 10 11' Spacing='1 0 1'", content),
                 ErrorCode::bad_file, "spacing along y");
}

TEST_F(VtkXml, PiecesInOneFileAreAssembled) {
  const std::string left =
      piece("0 1 0 2 0 1", point_data(floats("v", "0 1 4 5 8 9 12 13 16 17 20 21")));
  const std::string right = piece(
      "1 3 0 2 0 1", point_data(floats("v", "1 2 3 5 6 7 9 10 11 13 14 15 17 18 19 21 22 23")));
  const VolumeFile file =
      read(vtk_file("ImageData", kImage, left + piece("0 -1 0 -1 0 -1", "") + right));
  expect_ramp(file);
  EXPECT_EQ(decision(file, "pieces"), "2");
  EXPECT_TRUE(file.source.warnings.empty());
  expect_refused(vtk_file("ImageData", kImage, left), ErrorCode::bad_file,
                 "has no piece with sample (2, 0, 0)");
  expect_refused(vtk_file("ImageData", kImage, ""), ErrorCode::bad_file, "has no pieces");
  const std::string beyond = piece("1 4 0 2 0 1", point_data(floats("v", integers(24))));
  expect_refused(vtk_file("ImageData", kImage, left + beyond), ErrorCode::bad_file,
                 "has a piece with extent 1 4 0 2 0 1");
  const std::string other = piece(
      "1 3 0 2 0 1", point_data(floats("v", "1 2 3 5.5 6 7 9 10 11 13 14 15 17 18 19 21 22 23")));
  expect_refused(vtk_file("ImageData", kImage, left + other), ErrorCode::bad_file, "differ by 0.5");
  const std::string rounded =
      piece("1 3 0 2 0 1",
            point_data(floats("v", "1 2 3 5.00001 6 7 9 10 11 13 14 15 17 18 19 21 22 23")));
  const VolumeFile warned = read(vtk_file("ImageData", kImage, left + rounded));
  ASSERT_EQ(warned.source.warnings.size(), 1U);
  EXPECT_NE(warned.source.warnings[0].find("differ by rounding"), std::string::npos);
  expect_ramp(warned);
  const std::string no_array = piece("1 3 0 2 0 1", point_data(floats("w", integers(18))));
  expect_refused(vtk_file("ImageData", kImage, left + no_array), ErrorCode::bad_file,
                 "has no array 'v' in one of its pieces");
  const std::string other_type =
      piece("1 3 0 2 0 1", point_data(array("type='Int8' Name='v'", integers(18))));
  expect_refused(vtk_file("ImageData", kImage, left + other_type), ErrorCode::bad_file,
                 "other values in one piece");
}

TEST_F(VtkXml, CellDataOfPiecesIsAssembled) {
  const std::string grid = "WholeExtent='0 4 0 2 0 2' Origin='0 0 0' Spacing='1 1 1'";
  const VolumeFile file = read(
      vtk_file("ImageData", grid,
               piece("0 1 0 2 0 2", cell_data(floats("c", "0 4 8 12"))) +
                   piece("1 4 0 2 0 2", cell_data(floats("c", "1 2 3 5 6 7 9 10 11 13 14 15")))));
  expect_size_and_spacing(file.volume, {4, 2, 2}, {1, 1, 1});
  expect_ramp(file, 16);
}

// One layer of points belongs to the other piece, but has other values than there.
TEST_F(VtkXml, GhostSamplesComeFromTheOtherPiece) {
  const std::string left = piece(
      "0 2 0 2 0 1",
      point_data(floats("v", "0 1 -9 4 5 -9 8 9 -9 12 13 -9 16 17 -9 20 21 -9") +
                 array("type='UInt8' Name='vtkGhostType'", "0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1")));
  const std::string right = piece(
      "2 3 0 2 0 1", point_data(floats("v", "2 3 6 7 10 11 14 15 18 19 22 23") +
                                array("type='UInt8' Name='vtkGhostType'", integers(12, 0, 0))));
  for (const std::string& pieces : {left + right, right + left}) {
    const VolumeFile file = read(vtk_file("ImageData", kImage, pieces));
    expect_ramp(file);
    EXPECT_TRUE(file.source.warnings.empty());
    EXPECT_EQ(file.source.choices[0].entries.size(), 1U);
  }
  const std::string hidden = floats("v", integers(kPoints)) +
                             array("type='UInt8' Name='vtkGhostType'", "2 " + integers(23, 0, 0));
  const VolumeFile file = read(image(point_data(hidden)));
  expect_ramp(file);
  ASSERT_EQ(file.source.warnings.size(), 1U);
  EXPECT_NE(file.source.warnings[0].find("hidden"), std::string::npos);
}

class VtkXmlParallel : public VtkXml {
 protected:
  fs::path header() const { return folder_ / "p.pvti"; }
  void write_piece(const std::string& name, const std::string& extent, const std::string& values,
                   const std::string& grid =
                       "Origin='1 2 3' Spacing='0.5 0.25 2' Direction='0 1 0 1 0 0 0 0 1'") {
    fs::create_directories((folder_ / name).parent_path());
    write_bytes(folder_ / name, vtk_file("ImageData", "WholeExtent='0 3 0 2 0 1' " + grid,
                                         piece(extent, point_data(floats("v", values)))));
  }
  void write_pieces() {
    write_piece("d/0.vti", "0 1 0 2 0 1", "0 1 4 5 8 9 12 13 16 17 20 21");
    write_piece("d/1.vti", "1 3 0 2 0 1", "1 2 3 5 6 7 9 10 11 13 14 15 17 18 19 21 22 23");
  }
  void write_header(const std::string& pieces,
                    const std::string& grid = "Origin='1 2 3' Spacing='0.5 0.25 2'") {
    write_bytes(
        header(),
        vtk_file(
            "PImageData", "WholeExtent='0 3 0 2 0 1' GhostLevel='0' " + grid,
            "<PPointData Scalars='v'>\n<PDataArray type='Float32' Name='v'/>\n</PPointData>\n" +
                pieces));
  }
  void expect_header_refused(ErrorCode code, const std::string& message) {
    expect_error(code, message, header(), [&] { read_volume_file(header()); });
  }
  const std::string pieces_ =
      "<Piece Extent='0 1 0 2 0 1' Source='d/0.vti'/><Piece Extent='1 3 0 2 0 1' "
      "Source='d\\1.vti'/>"
      "<Piece Extent='0 -1 0 -1 0 -1' Source='d/none.vti'/>";
};

TEST_F(VtkXmlParallel, PiecesInOtherFilesAreAssembled) {
  write_pieces();
  write_header(pieces_);
  const VolumeFile file = read_volume_file(header());
  expect_size_and_spacing(file.volume, {4, 3, 2}, {0.5, 0.25, 2}, 0);
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(file.volume.view.grid.direction[0],
            (Vec3{0, 1, 0}));  // VTK 9.1 writes the direction into the pieces only
  EXPECT_EQ(file.source.format, "VTK XML parallel image data");
  expect_ramp(file);
}

TEST_F(VtkXmlParallel, ErrorsNameThePiece) {
  write_pieces();
  write_header(pieces_);
  fs::remove(folder_ / "d/0.vti");
  expect_header_refused(ErrorCode::bad_file, "d/0.vti: no such file");
  write_piece("d/0.vti", "0 0 0 2 0 1", "0 4 8 12 16 20");
  EXPECT_NO_THROW(read_volume(header()));  // the other piece has the rest
  write_piece("d/1.vti", "2 3 0 2 0 1", integers(12));
  expect_header_refused(ErrorCode::bad_file, "has no piece with sample (1, 0, 0)");
  write_piece("d/1.vti", "0 0 0 2 0 1", integers(6));
  expect_header_refused(ErrorCode::bad_file, "1.vti: holds no samples of extent 1 3 0 2 0 1");
  write_pieces();
  write_piece("d/1.vti", "1 3 0 2 0 1", integers(18), "Origin='1 2 3' Spacing='0.5 0.25 3'");
  expect_header_refused(ErrorCode::bad_file,
                        "its piece 1.vti has another Spacing, expected 0.5 0.25 2");
  write_piece("d/1.vti", "1 3 0 2 0 1", integers(18), "Origin='1 2 4' Spacing='0.5 0.25 2'");
  expect_header_refused(ErrorCode::bad_file, "its piece 1.vti has another Origin, expected 1 2 3");
  write_piece("d/1.vti", "1 3 0 2 0 1", integers(17));
  expect_header_refused(ErrorCode::bad_file, "array 'v' has 17 numbers, expected 18");
  write_bytes(folder_ / "d/1.vti", read_bytes(header()));
  expect_header_refused(ErrorCode::bad_file, "1.vti: holds 'PImageData', expected ImageData");
  write_header("<Piece Extent='0 3 0 2 0 1'/>");
  expect_header_refused(ErrorCode::bad_file, "without a Source");
  write_header("<Piece Extent='0 4 0 2 0 1' Source='d/0.vti'/>");
  expect_header_refused(ErrorCode::bad_file, "within the WholeExtent 0 3 0 2 0 1");
}

TEST_F(VtkXml, RectilinearGridsNeedEqualSteps) {
  const auto grid = [](const std::string& x) {
    const std::string coordinates = "<Coordinates>" + floats("x", x) +
                                    array("type='Int32' Name='y'", "9 7 5") +
                                    array("type='Float64' Name='z'", "0 0.5") + "</Coordinates>";
    return vtk_file("RectilinearGrid", "WholeExtent='2 5 0 2 0 1'",
                    piece("2 5 0 2 0 1", point_data(floats("v", integers(kPoints))) + coordinates));
  };
  const VolumeFile file = read(grid("0.1 0.4333333 0.7666667 1.1"));
  expect_size_and_spacing(file.volume, {4, 3, 2}, {1.0 / 3, 2, 0.5});
  EXPECT_NEAR(file.volume.view.grid.origin.x, 0.1, 1e-8);
  EXPECT_EQ(file.volume.view.grid.origin.y, 9);
  EXPECT_EQ(file.volume.view.grid.direction[1], (Vec3{0, -1, 0}));
  EXPECT_EQ(decision(file, "spacing"), "the equal steps of the coordinates");
  expect_ramp(file);
  EXPECT_NO_THROW(read(grid("0 1.0005 2 3")));
  expect_refused(grid("0 1.005 2 3"), ErrorCode::unsupported,
                 "its x coordinates are uneven: steps of 0.995");
  expect_refused(grid("0 1 2.5 3"), ErrorCode::unsupported, "steps of 0.5 and of 1.5");
  expect_refused(grid("0 1 2"), ErrorCode::bad_file, "has 3 numbers, expected 4");
  std::string none = grid("0 1 2 3");
  none.replace(none.find("<Coordinates>"), 13, "<Coordinate_>")
      .replace(none.find("</Coordinates>"), 14, "</Coordinate_>");
  expect_refused(none, ErrorCode::bad_file, "has no <Coordinates>");
}

TEST_F(VtkXml, RectilinearPiecesAreAssembled) {
  const auto coordinates = [](const std::string& x) {
    return "<Coordinates>" + floats("x", x) + floats("y", "0 1 2") + floats("z", "0 1") +
           "</Coordinates>";
  };
  const auto write = [&](const std::string& name, const std::string& extent,
                         const std::string& values, const std::string& x) {
    const std::string content = point_data(floats("v", values)) + coordinates(x);
    write_bytes(folder_ / name, vtk_file("RectilinearGrid", "WholeExtent='" + extent + "'",
                                         piece(extent, content)));
  };
  write("0.vtr", "0 1 0 2 0 1", "0 1 4 5 8 9 12 13 16 17 20 21", "5 7");
  write("1.vtr", "1 3 0 2 0 1", "1 2 3 5 6 7 9 10 11 13 14 15 17 18 19 21 22 23", "7 9 11");
  const std::string header =
      "<PPointData><PDataArray type='Float32' Name='v'/></PPointData>"
      "<Piece Extent='0 1 0 2 0 1' Source='0.vtr'/><Piece Extent='1 3 0 2 0 1' Source='1.vtr'/>";
  write_bytes(folder_ / "p.pvtr",
              vtk_file("PRectilinearGrid", "WholeExtent='0 3 0 2 0 1'", header));
  const VolumeFile file = read_volume_file(folder_ / "p.pvtr");
  expect_size_and_spacing(file.volume, {4, 3, 2}, {2, 1, 1}, 0);
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{5, 0, 0}));
  expect_ramp(file);
}

TEST_F(VtkXml, OtherDataSetsAreNamed) {
  expect_refused(vtk_file("PolyData", "", ""), ErrorCode::unsupported,
                 "is a mesh file (VTK PolyData)");
  expect_refused(vtk_file("UnstructuredGrid", "", ""), ErrorCode::unsupported,
                 "holds an unstructured grid (UnstructuredGrid)");
  expect_refused(vtk_file("PStructuredGrid", "", ""), ErrorCode::unsupported,
                 "holds a curvilinear grid (PStructuredGrid)");
  expect_refused(vtk_file("Collection", "", ""), ErrorCode::unsupported,
                 "is a list of other files");
  expect_refused(vtk_file("vtkMultiBlockDataSet", "", ""), ErrorCode::unsupported,
                 "is a list of other files");
  expect_refused(vtk_file("Table", "", ""), ErrorCode::unsupported, "holds 'Table'");
  write_bytes(folder_ / "a.vtkhdf", "\x89HDF\r\n\x1a\n");
  expect_error(ErrorCode::unsupported, "is a VTKHDF file", folder_ / "a.vtkhdf",
               [&] { read_volume(folder_ / "a.vtkhdf"); });
  expect_refused("<?xml version='1.0'?><svg></svg><!-- <VTKFile></VTKFile>", ErrorCode::bad_file,
                 "is not well-formed XML");
  expect_refused("<svg a='<VTKFile'></VTKFile>", ErrorCode::bad_file, "is not well-formed XML");
}

TEST_F(VtkXml, ValuesAreAllThereOrRefused) {
  const auto values = [](const std::string& attributes, const std::string& content) {
    return image(point_data("<DataArray type='Float32' Name='v' " + attributes + ">" + content +
                            "</DataArray>"));
  };
  expect_refused(values("format='ascii'", integers(23)), ErrorCode::bad_file,
                 "array 'v' has 23 numbers, expected 24");
  expect_refused(values("format='ascii'", integers(25)), ErrorCode::bad_file,
                 "array 'v' has more numbers, expected 24");
  expect_refused(values("format='ascii'", integers(23) + "x"), ErrorCode::bad_file,
                 "has 'x', expected a value of type float32");
  expect_refused(values("format='ascii'", ""), ErrorCode::bad_file, "");
  expect_refused(values("format='ascii' NumberOfTuples='12'", integers(24)), ErrorCode::bad_file,
                 "states NumberOfTuples 12, expected 24");
  EXPECT_NO_THROW(read(values("format='ascii' NumberOfTuples='24'", integers(24))));
  // VTK 9.1 reads these as well and returns uninitialised memory for the missing values.
  const std::string base64 =
      "YAAAAAAAAAAAAIA/AAAAQAAAQEA";  // the header states 96 bytes, the file has 16
  expect_refused(values("format='binary'", base64), ErrorCode::bad_file, "states 96 bytes");
  expect_refused(
      values("format='binary'", base64 + std::string(100, ' ') + "=" + std::string(200, '\n')),
      ErrorCode::bad_file, "its samples end too early");
  expect_refused(
      values("format='binary'", "YAAA" + std::string(40, 'A') + "*" + std::string(100, 'A')),
      ErrorCode::bad_file, "base64 text ends too early");
}

TEST_F(VtkXml, InformationKeysAreNotValues) {
  const std::string key =
      "<InformationKey name='L2_NORM_RANGE' location='vtkDataArray' length='2'>\n"
      "<Value index='0'>\n1\n</Value>\n</InformationKey>\n";
  const std::string values = "<DataArray type='Float32' Name='v' format='ascii'>";
  expect_ramp(read(image(point_data(values + integers(kPoints) + key + "</DataArray>"))));
  expect_ramp(read(image(point_data(values + key + integers(kPoints) + "</DataArray>"))));
}

TEST_F(VtkXml, AppendedValuesAreAllThereOrRefused) {
  expect_ramp(read(appended(number(96) + ramp_bytes())));
  expect_ramp(read(appended(number(96, 8) + ramp_bytes(), "header_type='UInt64'")));
  expect_refused(appended(number(95) + ramp_bytes()), ErrorCode::bad_file,
                 "has 95 bytes of values, expected 96");
  expect_refused(appended(number(97) + ramp_bytes()), ErrorCode::bad_file,
                 "has 97 bytes of values, expected 96");
  expect_refused(appended(number(96) + ramp_bytes(23)), ErrorCode::bad_file,
                 "states 96 bytes of samples, the file has 93");
  expect_refused(appended(""), ErrorCode::bad_file, "");
  std::string far = appended(number(96) + ramp_bytes());
  far.replace(far.find("offset='0'"), 10, "offset='9999'");
  expect_refused(far, ErrorCode::bad_file,
                 "array 'v' begins at 9999 in appended data of 101 bytes");
  std::string no_offset = appended(number(96) + ramp_bytes());
  no_offset.replace(no_offset.find("offset='0'"), 10, "          ");
  expect_refused(no_offset, ErrorCode::bad_file, "has the offset ''");
  std::string no_mark = appended(number(96) + ramp_bytes());
  no_mark.replace(no_mark.find("\n_"), 2, "\n ");
  expect_refused(no_mark, ErrorCode::bad_file, "does not begin with '_'");
  EXPECT_THROW(read(appended(number(96) + ramp_bytes()), {.max_memory = 95}), Error);
}

TEST_F(VtkXml, CompressedBlocksAreAllThereOrRefused) {
  const std::string zlib = "header_type='UInt32' compressor='vtkZLibDataCompressor'";
  const std::string block = deflated(ramp_bytes());
  const auto blocks = [&](std::uint64_t count, std::uint64_t bytes, std::uint64_t last,
                          std::uint64_t packed) {
    return number(count) + number(bytes) + number(last) + number(packed);
  };
  expect_ramp(read(appended(blocks(1, 96, 0, block.size()) + block, zlib)));
  expect_ramp(read(appended(blocks(1, 32768, 96, block.size()) + block, zlib)));
  expect_ramp(
      read(appended(blocks(1, 0xFFFFFFFF, 96, block.size()) + block, zlib)));  // never allocated
  expect_refused(appended(blocks(1, 92, 0, block.size()) + block, zlib), ErrorCode::bad_file,
                 "has 92 bytes of values, expected 96");
  const std::string shorter = deflated(ramp_bytes(20)), longer = deflated(ramp_bytes(30));
  expect_refused(appended(blocks(1, 96, 0, shorter.size()) + shorter, zlib), ErrorCode::bad_file,
                 "damaged in block 0 of 1");
  expect_refused(appended(blocks(1, 96, 0, longer.size()) + longer, zlib), ErrorCode::bad_file,
                 "damaged in block 0 of 1");
  expect_refused(appended(blocks(1, 96, 0, block.size() - 1) + block, zlib), ErrorCode::bad_file,
                 "damaged in block 0 of 1");
  expect_refused(appended(blocks(1, 96, 0, 100000) + block, zlib), ErrorCode::bad_file,
                 "1 blocks of 96 bytes");
  expect_refused(appended(blocks(0, 0, 0, 0) + block, zlib), ErrorCode::bad_file,
                 "has 0 bytes of values");
  expect_refused(appended(blocks(0xFFFFFFFF, 1, 0, 1) + block, zlib), ErrorCode::bad_file,
                 "its compressed data is damaged");
  const std::string lz4 = "header_type='UInt32' compressor='vtkLZ4DataCompressor'";
  const std::string literal =
      std::string("\xF0\x01", 2) + std::string(16, '\0');  // 16 zeros: fewer than 96
  expect_refused(appended(blocks(1, 96, 0, literal.size()) + literal, lz4), ErrorCode::bad_file,
                 "damaged in block 0 of 1");
  expect_refused(appended(number(96) + ramp_bytes(), "compressor='vtkZstdCompressor'"),
                 ErrorCode::unsupported, "is compressed by");
}

// Written by VTK with each compressor and encoding, and cut at many places.
TEST_F(VtkXml, FilesOfVtkAreReadUnlessTheyAreCut) {
  vtkNew<vtkImageData> vtk_image;
  vtk_image->SetDimensions(4, 3, 2);
  vtkNew<vtkFloatArray> values;
  values->SetName("v");
  for (int i = 0; i < kPoints; ++i) values->InsertNextValue(static_cast<float>(i));
  vtk_image->GetPointData()->SetScalars(values);
  for (int compressor = 0; compressor <= vtkXMLWriter::LZMA; ++compressor) {
    for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
      vtkNew<vtkXMLImageDataWriter> writer;
      writer->SetFileName(path().c_str());
      writer->SetInputData(vtk_image);
      writer->SetCompressorType(compressor);
      writer->SetDataMode(mode);
      writer->SetByteOrderToBigEndian();
      writer->Write();
      SCOPED_TRACE(std::to_string(compressor) + " " + std::to_string(mode));
      const std::string whole = read_bytes(path());
      expect_ramp(read_volume_file(path()));
      const std::size_t samples =
          mode == vtkXMLWriter::Appended ? whole.find("   _") : whole.find("<DataArray");
      const std::size_t end =
          whole.find(mode == vtkXMLWriter::Appended ? "</AppendedData" : "</DataArray", samples);
      for (std::size_t at = samples; at < end;
           at += 7) {  // the end of the file stays: only samples are missing
        write_bytes(path(), whole.substr(0, at) + whole.substr(std::min(at + 7, end)));
        try {
          expect_ramp(read_volume_file(path()));  // only blanks or an attribute were cut
        } catch (const Error&) {
        }
        write_bytes(path(), whole.substr(0, at));
        EXPECT_THROW(read_volume(path()), Error);
      }
    }
  }
}

TEST_F(VtkXml, BitsAreRead) {
  const auto bits = [](const std::string& format, const std::string& values) {
    return image(point_data("<DataArray type='Bit' Name='v' format='" + format + "'>" + values +
                            "</DataArray>"));
  };
  const VolumeFile text = read(bits("ascii", "1 0 0 0 0 0 0 0  0 0 0 0 0 0 0 1  1 1 1 1 0 0 0 0"));
  const VolumeFile binary = read(bits("binary", "AwAAAIAB8A=="));  // 3 bytes: 80 01 F0
  EXPECT_EQ(text.volume.view.type, SampleType::uint8);
  EXPECT_EQ(samples_as_double(text.volume), samples_as_double(binary.volume));
  EXPECT_EQ(sample_as_double(binary.volume, 15), 1);
  expect_refused(bits("ascii", "2 " + integers(23, 0, 0)), ErrorCode::bad_file,
                 "has '2', expected a value of type bit");
}

TEST_F(VtkXml, CompressedFilesAreRefused) {
  const std::string whole = image(point_data(floats("v", integers(kPoints))));
  gzFile file = gzopen(path().c_str(), "wb");
  gzwrite(file, whole.data(), static_cast<unsigned>(whole.size()));
  gzclose(file);
  expect_error(ErrorCode::unsupported, "is a compressed VTK XML file", path(),
               [&] { read_volume(path()); });
}

TEST_F(VtkXml, HostileElementsAreRefused) {
  std::string deep = "<VTKFile type='ImageData'>";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  expect_refused(deep + "</VTKFile>", ErrorCode::bad_file, "more than 32 levels");
  expect_refused(vtk_file("ImageData", "WholeExtent='0 2147483646 0 99999 0 1'",
                          piece("0 2147483646 0 99999 0 1", point_data(floats("v", "1 2")))),
                 ErrorCode::bad_file, "far more than a file");
  expect_refused(
      vtk_file("ImageData", "WholeExtent='0 2147483646 0 2147483646 0 2147483646'",
               piece("0 2147483646 0 2147483646 0 2147483646", point_data(floats("v", "1 2")))),
      ErrorCode::bad_file, "more than any file can hold");
  expect_refused(
      vtk_file("RectilinearGrid", "WholeExtent='0 2147483646 0 1 0 1'",
               piece("0 2147483646 0 1 0 1", point_data(floats("v", "1 2")) + "<Coordinates>" +
                                                 floats("x", "1") + floats("y", "0 1") +
                                                 floats("z", "0 1") + "</Coordinates>")),
      ErrorCode::bad_file, "far more than a file");
}

}  // namespace
}  // namespace isoatlas::detail::test
