// SPDX-License-Identifier: Apache-2.0
// .gii: written files, files as other programs write them, and damaged files. tests/cli also reads
// written files with nibabel, if it is installed.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <random>

#include "isoatlas/io.h"
#include "mesh_files/base64.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

TriangleMesh tetrahedron() {
  return {{{1.0 / 3, 0, 0}, {100.25, 0, 0}, {0, -30.7, 0}, {0, 0, 25.3}},
          {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
}

TEST(MeshGii, CoordinatesAreInRasAndMillimetres) {
  struct Row {
    std::string space;
    LengthUnit unit;
    double sign, scale;
    std::string read_space;
    LengthUnit read_unit;
    std::size_t notes;
  };
  const std::vector<Row> rows{
      {"LPS", LengthUnit::millimetre, -1, 1, "RAS", LengthUnit::millimetre, 1},
      {"lps", LengthUnit::unknown, -1, 1, "RAS", LengthUnit::millimetre, 2},
      {"ras", LengthUnit::unknown, 1, 1, "RAS", LengthUnit::millimetre, 1},
      {"RAS", LengthUnit::millimetre, 1, 1, "RAS", LengthUnit::millimetre, 0},
      {"RAS", LengthUnit::micrometre, 1, 1e-3, "RAS", LengthUnit::millimetre, 1},
      {"LPS", LengthUnit::metre, -1, 1e3, "RAS", LengthUnit::millimetre, 2},
      {"voxel", LengthUnit::unknown, 1, 1, "voxel", LengthUnit::unknown, 1},
      {"", LengthUnit::unknown, 1, 1, "", LengthUnit::unknown, 1},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.space + " " + std::string(symbol(row.unit)));
    const TempFolder folder;
    const fs::path path = folder / "a.surf.gii";
    check_mesh_path(path);
    const StoredPositions stored = write_mesh(
        tetrahedron(), path, {.space = row.space, .comment = "isoatlas 0.1.0", .unit = row.unit});
    EXPECT_TRUE(stored.single_precision);
    EXPECT_EQ(stored.notes.size(), row.notes);
    const TriangleMesh read = read_mesh(path);
    EXPECT_EQ(read.triangles, tetrahedron().triangles);
    ASSERT_EQ(read.positions.size(), 4U);
    double largest = 0;
    for (std::size_t v = 0; v < 4; ++v) {
      const Vec3 p = read.positions[v], given = tetrahedron().positions[v];
      EXPECT_NEAR(p.x, row.sign * row.scale * given.x, 1e-5 * row.scale);
      EXPECT_NEAR(p.y, row.sign * row.scale * given.y, 1e-5 * row.scale);
      EXPECT_NEAR(p.z, row.scale * given.z, 1e-5 * row.scale);
      const double back = 1 / row.scale;
      largest =
          std::max(largest, std::hypot(back * row.sign * p.x - given.x,
                                       back * row.sign * p.y - given.y, back * p.z - given.z));
    }
    EXPECT_GT(stored.largest_rounding, 0);
    EXPECT_NEAR(stored.largest_rounding, largest, 1e-12);  // in the unit of the input mesh
    const MeshFileInfo info = mesh_file_info(path);
    EXPECT_EQ(info.space, row.read_space);
    EXPECT_EQ(info.unit, row.read_unit);
    EXPECT_EQ(info.comment, "isoatlas 0.1.0");
    const std::string bytes = read_bytes(path);
    EXPECT_EQ(bytes.find("NIFTI_XFORM_SCANNER_ANAT") != std::string::npos, row.read_space == "RAS");
    EXPECT_NE(bytes.find("<Value>Closed</Value>"), std::string::npos);
    EXPECT_NE(bytes.find("<MatrixData>\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n</MatrixData>"),
              std::string::npos);  // nibabel requires four lines
  }
}

TEST(MeshGii, FileThatWouldMergeVerticesIsNotWritten) {
  const TempFolder folder;
  TriangleMesh mesh = tetrahedron();
  mesh.positions[0] = {100.25, 1e-50, 0};
  expect_error(ErrorCode::bad_file, "would become one", folder / "a.gii",
               [&] { write_mesh(mesh, folder / "a.gii"); });
  EXPECT_EQ(folder.file_count(), 0U);
}

// --------------------------------------------------------------------------- files of other
// programs

struct Array {
  std::string intent, type, encoding, data;
  std::string dims = "Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\"", order = "RowMajorOrder",
              endian = "LittleEndian";
};

std::string gifti(const std::vector<Array>& arrays, const std::string& metadata = "<MetaData/>") {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE GIFTI SYSTEM \"x.dtd\">\n<GIFTI "
      "Version=\"1.0\">" +
      metadata + "<LabelTable/>";
  for (const Array& a : arrays) {
    xml += "<DataArray Intent=\"" + a.intent + "\" DataType=\"" + a.type +
           "\" ArrayIndexingOrder=\"" + a.order + "\" " + a.dims + " Encoding=\"" + a.encoding +
           "\" Endian=\"" + a.endian +
           "\"><MetaData/><CoordinateSystemTransformMatrix><MatrixData>" +
           "2 0 0 9 0 2 0 9 0 0 2 9 0 0 0 1</MatrixData></CoordinateSystemTransformMatrix><Data>" +
           a.data + "</Data></DataArray>";
  }
  return xml + "</GIFTI>";
}

const std::string kFloat = "NIFTI_TYPE_FLOAT32", kInt = "NIFTI_TYPE_INT32",
                  kGzip = "GZipBase64Binary";
const std::string kPoints = "NIFTI_INTENT_POINTSET", kTriangles = "NIFTI_INTENT_TRIANGLE";
const std::vector<Vec3> kCorners{{0, 1, 2}, {-3, 4.5, 6}, {7, 8, 9}};

const Array kTextPoints{.intent = kPoints,
                        .type = kFloat,
                        .encoding = "ASCII",
                        .data = "\n0 1 2\n -3 +4.5 +6e0\n7 8 9\n"};
const Array kTextTriangle{.intent = kTriangles,
                          .type = kInt,
                          .encoding = "ASCII",
                          .data = "2 1 0",
                          .dims = "Dimensionality=\"2\" Dim0=\"1\" Dim1=\"3\""};

template <class Value>
std::string bytes_of(std::vector<Value> values, bool big_endian = false) {
  std::string bytes(values.size() * sizeof(Value), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  for (std::size_t i = 0; big_endian && i < bytes.size(); i += sizeof(Value))
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(Value)));
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

TriangleMesh read_text(const std::string& text) {
  const TempFolder folder;
  write_bytes(folder / "a.gii", text);
  return read_mesh(folder / "a.gii");
}

TEST(MeshGii, EncodingsOrdersAndTypes) {
  const std::vector<float> rows{0, 1, 2, -3, 4.5F, 6, 7, 8, 9},
      columns{0, -3, 7, 1, 4.5F, 8, 2, 6, 9};
  std::vector<Array> points{kTextPoints};
  points.push_back({.intent = kPoints,
                    .type = kFloat,
                    .encoding = "Base64Binary",
                    .data = io::to_base64(bytes_of(rows))});
  points.push_back({.intent = kPoints,
                    .type = kFloat,
                    .encoding = kGzip,
                    .data = io::to_base64(deflated(bytes_of(rows)))});
  points.push_back({.intent = kPoints,
                    .type = kFloat,
                    .encoding = kGzip,
                    .data = io::to_base64(deflated(bytes_of(rows, true))),
                    .endian = "BigEndian"});
  points.push_back({.intent = kPoints,
                    .type = kFloat,
                    .encoding = kGzip,
                    .data = io::to_base64(deflated(bytes_of(columns))),
                    .order = "ColumnMajorOrder"});
  points.push_back(
      {.intent = kPoints,
       .type = "NIFTI_TYPE_FLOAT64",
       .encoding = kGzip,
       .data = io::to_base64(deflated(bytes_of(std::vector<double>(rows.begin(), rows.end()))))});
  points.push_back({.intent = kPoints,
                    .type = kFloat,
                    .encoding = "ASCII",
                    .data = "0 -3 7 1 4.5 8 2 6 9",
                    .order = "ColumnMajorOrder"});
  std::string broken = io::to_base64(bytes_of(rows));
  for (std::size_t i = 8; i < broken.size(); i += 9)
    broken.insert(i, "\n  ");  // line breaks at any place
  points.push_back({.intent = kPoints, .type = kFloat, .encoding = "Base64Binary", .data = broken});
  for (const Array& array : points) {
    SCOPED_TRACE(array.encoding + array.order + array.endian + array.type);
    const TriangleMesh mesh = read_text(gifti({kTextTriangle, array}));
    EXPECT_EQ(mesh.positions, kCorners);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 1, 0}}));
  }
}

TEST(MeshGii, BadFilesGiveOneLine) {
  struct Bad {
    std::string text, message;
    ErrorCode code = ErrorCode::bad_file;
  };
  const auto with = [](auto change) {
    Array array = kTextPoints;
    change(array);
    return gifti({array, kTextTriangle});
  };
  const std::string rows = bytes_of(std::vector<float>(9, 1));
  const std::vector<Bad> all{
      {"hello", "is not a GIfTI file"},
      {"<x/>", "is not a GIfTI file"},
      {gifti({kTextPoints, kTextTriangle}).substr(0, 300), "damaged or cut off"},
      {gifti({kTextTriangle}), "no array of points", ErrorCode::unsupported},
      {gifti({kTextPoints}), "no array of triangles", ErrorCode::unsupported},
      {gifti({kTextPoints, kTextPoints, kTextTriangle}), "more than one array of points",
       ErrorCode::unsupported},
      {with([](Array& a) { a.dims = "Dimensionality=\"2\" Dim0=\"4\" Dim1=\"3\""; }),
       "expected 12 numbers"},
      {with([](Array& a) { a.dims = "Dimensionality=\"2\" Dim0=\"4000000000\" Dim1=\"3\""; }),
       "far more than a file"},
      {with([](Array& a) {
         a.dims = "Dimensionality=\"2\" Dim0=\"99999999999999999999\" Dim1=\"3\"";
       }),
       "expected rows of 3"},
      {with([](Array& a) { a.dims = "Dimensionality=\"2\" Dim0=\"9000000000\" Dim1=\"3\""; }),
       "expected at most 4294967295"},
      {with([](Array& a) { a.dims = "Dimensionality=\"2\" Dim0=\"-3\" Dim1=\"3\""; }),
       "expected rows of 3"},
      {with([](Array& a) { a.dims = "Dimensionality=\"1\" Dim0=\"9\""; }), "expected rows of 3"},
      {with([](Array& a) { a.encoding = "ExternalFileBinary"; }),
       "with the encoding 'ExternalFileBinary'", ErrorCode::unsupported},
      {with([&](Array& a) {
         a.encoding = "Base64Binary", a.data = io::to_base64(rows).substr(0, 44);
       }),
       "has 33 bytes of values, expected 36"},
      {with([&](Array& a) {
         a.encoding = kGzip, a.data = io::to_base64(deflated(rows)).substr(0, 12);
       }),
       "cannot be decompressed"},
      {with([&](Array& a) { a.encoding = kGzip, a.data = io::to_base64(deflated(rows + rows)); }),
       "cannot be decompressed"},
      {with([&](Array& a) {
         a.encoding = kGzip, a.data = io::to_base64(deflated(rows.substr(0, 35)));
       }),
       "has 35 bytes of values, expected 36"},
      {with([&](Array& a) { a.encoding = kGzip, a.type = "NIFTI_TYPE_RGB24"; }),
       "type 'NIFTI_TYPE_RGB24'"},
      {with([](Array& a) { a.data = "0 1 2 3 4 5 6 7 nan"; }), "not finite"},
      {with([](Array& a) { a.data = "0 1 2 3 4 5 6 7 8 9"; }), "has '9' after its 9 numbers"},
      {gifti({kTextPoints,
              [] {
                Array a = kTextTriangle;
                a.data = "0 1 3";
                return a;
              }()}),
       "triangle 0 uses vertex 3"},
      {gifti({kTextPoints,
              [] {
                Array a = kTextTriangle;
                a.data = "0 1 -1";
                return a;
              }()}),
       "triangle 0 uses vertex"},
      {gifti({kTextPoints,
              [] {
                Array a = kTextTriangle;
                a.data = "0 1 1.5";
                return a;
              }()}),
       "triangle 0 uses vertex"},
  };
  for (const Bad& row : all) {
    SCOPED_TRACE(row.message);
    const TempFolder folder;
    write_bytes(folder / "a.gii", row.text);
    expect_error(row.code, row.message, folder / "a.gii", [&] { read_mesh(folder / "a.gii"); });
  }
}

TEST(MeshGii, DamagedFiles) {
  const TempFolder folder;
  const fs::path path = folder / "a.gii";
  write_mesh(tetrahedron(), path);
  const std::string whole = read_bytes(path);
  for (std::size_t length = 0; length + 2 < whole.size();
       length += 11) {  // a file without the last line break is complete
    write_bytes(path, whole.substr(0, length));
    EXPECT_THROW(read_mesh(path), Error) << length;
  }
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    std::string changed = whole;
    changed[random() % whole.size()] = static_cast<char>(random());
    write_bytes(path, changed);
    try {
      read_mesh(path);
      mesh_file_info(path);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(MeshGii, Base64) {
  std::string bytes;
  for (int n = 0; n < 300; ++n) {
    EXPECT_EQ(io::from_base64(io::to_base64(bytes)), bytes);
    EXPECT_EQ(io::to_base64(bytes).size() % 4, 0U);
    bytes += static_cast<char>(n * 7);
  }
  EXPECT_EQ(io::to_base64("Man"), "TWFu");
  EXPECT_EQ(io::to_base64("Ma"), "TWE=");
  EXPECT_EQ(io::to_base64("M"), "TQ==");
}

}  // namespace
}  // namespace isoatlas::detail::test
