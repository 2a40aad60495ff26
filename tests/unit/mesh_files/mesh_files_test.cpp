// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/mesh_counts.h"

namespace isoatlas::detail::test {
namespace {

constexpr std::array kFormats{".ply", ".stl", ".obj", ".off", ".vtp", ".3mf", ".gii"};
constexpr std::array kDoubleFormats{".ply", ".obj", ".off", ".vtp", ".3mf"};

// An octahedron far from the origin; its coordinates need all digits of a double.
TriangleMesh octahedron() {
  const Vec3 c{1000.1, -2000.2 / 3, 1e-5 / 7};
  TriangleMesh mesh;
  mesh.positions = {{c.x + 1, c.y, c.z}, {c.x - 1, c.y, c.z}, {c.x, c.y + 1, c.z},
                    {c.x, c.y - 1, c.z}, {c.x, c.y, c.z + 1}, {c.x, c.y, c.z - 1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

const MeshFileInfo kInfo{.space = "LPS", .comment = "isoatlas 0.1.0"};

TEST(MeshFiles, DoubleFormatsKeepEveryBit) {
  for (const char* extension : kDoubleFormats) {
    SCOPED_TRACE(extension);
    const TempFolder folder;
    const auto path = folder / (std::string("mesh") + extension);
    const TriangleMesh mesh = octahedron();
    check_mesh_path(path);
    EXPECT_EQ(folder.file_count(), 0U);
    write_mesh(mesh, path, kInfo);
    EXPECT_EQ(folder.file_count(), 1U);
    const TriangleMesh read = read_mesh(path);
    EXPECT_EQ(read.positions, mesh.positions);
    EXPECT_EQ(read.triangles, mesh.triangles);
  }
}

TEST(MeshFiles, StlKeepsFloatsAndTheOrderOfTriangles) {
  const TempFolder folder;
  const TriangleMesh mesh = octahedron();
  write_mesh(mesh, folder / "mesh.stl", kInfo);
  const TriangleMesh read = read_mesh(folder / "mesh.stl");
  ASSERT_EQ(read.positions.size(), mesh.positions.size());
  ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& a = read.positions[read.triangles[t][k]];
      const Vec3& b = mesh.positions[mesh.triangles[t][k]];
      // Compared as floats: g++ 12 with -O2 does not round a double that is cast to float and then
      // compared as double.
      const std::array<float, 3> rounded{static_cast<float>(b.x), static_cast<float>(b.y),
                                         static_cast<float>(b.z)};
      EXPECT_EQ((std::array<float, 3>{static_cast<float>(a.x), static_cast<float>(a.y),
                                      static_cast<float>(a.z)}),
                rounded);
      EXPECT_EQ(static_cast<float>(a.x), a.x);
    }
  }
}

// Programs for printing read an .stl as millimetres.
TEST(MeshFiles, StlIsInMillimetresIfTheUnitIsKnown) {
  struct Row {
    LengthUnit unit;
    double scale;
    std::string note;
  };
  const std::vector<Row> rows{{LengthUnit::millimetre, 1, ""},
                              {LengthUnit::centimetre, 10, "are in millimetres"},
                              {LengthUnit::inch, 25.4, "are in millimetres"},
                              {LengthUnit::micrometre, 1e-3, "are in millimetres"},
                              {LengthUnit::unknown, 1, "the volume states no unit"}};
  for (const Row& row : rows) {
    SCOPED_TRACE(symbol(row.unit));
    const TempFolder folder;
    const auto path = folder / "a.stl";
    const StoredPositions stored = write_mesh(
        octahedron(), path, {.space = "LPS", .comment = "isoatlas 0.1.0", .unit = row.unit});
    ASSERT_EQ(stored.notes.size(), row.note.empty() ? 0U : 1U);
    if (!row.note.empty()) {
      EXPECT_NE(stored.notes[0].find(row.note), std::string::npos);
    }
    const LengthUnit unit = row.unit == LengthUnit::unknown ? row.unit : LengthUnit::millimetre;
    EXPECT_EQ(stored.unit, unit);
    EXPECT_EQ(mesh_file_info(path).unit, unit);
    EXPECT_EQ(mesh_file_info(path).space, "LPS");
    const TriangleMesh read = read_mesh(path);
    EXPECT_NEAR(read.positions[read.triangles[0][0]].x, 1001.1 * row.scale, 1e-4 * row.scale);
    EXPECT_NEAR(stored.largest_rounding, 0, 1e-4);  // in the unit of the mesh
    EXPECT_GT(stored.largest_rounding, 1e-6);
  }
  const TempFolder folder;
  EXPECT_NE(write_mesh(octahedron(), folder / "a.stl", {.space = "voxel", .comment = ""})
                .notes.at(0)
                .find("sample indices"),
            std::string::npos);
}

TEST(MeshFiles, SameMeshSameBytesAndTheSpaceIsInThem) {
  for (const char* extension : kFormats) {
    SCOPED_TRACE(extension);
    const TempFolder folder;
    write_mesh(octahedron(), folder / (std::string("a") + extension), kInfo);
    write_mesh(octahedron(), folder / (std::string("other_name") + extension), kInfo);
    const std::string bytes = read_bytes(folder / (std::string("a") + extension));
    EXPECT_EQ(bytes, read_bytes(folder / (std::string("other_name") + extension)));
    EXPECT_EQ(mesh_space(folder / (std::string("a") + extension)),
              std::string(extension) == ".gii" ? "RAS" : "LPS");
    EXPECT_FALSE(bytes.starts_with("solid"));
  }
}

TEST(MeshFiles, CommentCannotAddLines) {
  for (const char* extension : kFormats) {
    SCOPED_TRACE(extension);
    const TempFolder folder;
    const auto path = folder / (std::string("a") + extension);
    write_mesh(octahedron(), path,
               {.space = "LPS\nend_header", .comment = std::string(300, 'x') + "\nv 1 2 3\n<&\">"});
    EXPECT_EQ(read_mesh(path).triangles.size(), octahedron().triangles.size());
  }
}

// The rounding stated before a file is written equals the rounding found by reading it back.
TEST(MeshFiles, RoundingIsKnownBefore) {
  const TempFolder folder;
  for (const LengthUnit unit :
       {LengthUnit::unknown, LengthUnit::millimetre, LengthUnit::micrometre, LengthUnit::metre}) {
    const MeshFileInfo info{.space = "LPS", .comment = "", .unit = unit};
    for (const char* extension : kFormats) {
      SCOPED_TRACE(extension + std::string(symbol(unit)));
      const auto path = folder / (std::string("a") + extension);
      const double expected = rounding_of_mesh_file(octahedron(), path, info);
      EXPECT_EQ(write_mesh(octahedron(), path, info).largest_rounding, expected);
      EXPECT_EQ(expected > 0, std::string(extension) == ".stl" || std::string(extension) == ".gii");
    }
  }
}

TEST(MeshFiles, StlThatWouldMergeVerticesIsNotWritten) {
  const TempFolder folder;
  TriangleMesh mesh = octahedron();
  mesh.positions.push_back(mesh.positions[2]);
  mesh.positions.back().x += 1e-6;  // less than the spacing of floats near 1000
  mesh.triangles.push_back({0, 1, 6});
  const auto path = folder / "mesh.stl";
  write_bytes(path, "old");
  expect_error(ErrorCode::bad_file, "vertices 2 and 6 would become one", path,
               [&] { write_mesh(mesh, path); });
  EXPECT_EQ(read_bytes(path), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  mesh.positions.back() = {1e39, 0, 0};
  expect_error(ErrorCode::bad_file, "vertex 6 is out of the range", path,
               [&] { write_mesh(mesh, path); });
  mesh.positions = {{0, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  expect_error(ErrorCode::bad_file, "vertices 0 and 1", path, [&] { write_mesh(mesh, path); });
}

TEST(MeshFiles, WrongMeshesAreNotWritten) {
  const TempFolder folder;
  for (const char* extension : kFormats) {
    const auto path = folder / (std::string("mesh") + extension);
    TriangleMesh mesh = octahedron();
    mesh.triangles[3][1] = 6;
    expect_error(ErrorCode::bad_argument, "triangle 3 uses vertex 6", path,
                 [&] { write_mesh(mesh, path); });
    mesh = octahedron();
    mesh.positions[4].y = std::nan("");
    expect_error(ErrorCode::bad_argument, "vertex 4 is not finite", path,
                 [&] { write_mesh(mesh, path); });
  }
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(MeshFiles, PathIsCheckedBeforeTheWork) {
  const TempFolder folder;
  expect_error(ErrorCode::unsupported, ".ply .stl .obj .off .vtp .3mf .gii, or .glb or .vtm",
               folder / "a.xyz", [&] { check_mesh_path(folder / "a.xyz"); });
  expect_error(ErrorCode::bad_file, "there is no folder", folder / "none/a.ply",
               [&] { check_mesh_path(folder / "none/a.ply"); });
  std::filesystem::create_directory(folder / "dir.ply");
  expect_error(ErrorCode::bad_file, "it is a folder", folder / "dir.ply",
               [&] { check_mesh_path(folder / "dir.ply"); });
  check_mesh_path(folder / "A.PLY");
  write_bytes(folder / "there.ply", "old");
  check_mesh_path(folder / "there.ply");
  EXPECT_EQ(read_bytes(folder / "there.ply"), "old");
}

TEST(MeshFiles, ErrorsDoNotListTheRefusedFormat) {
  const TempFolder folder;
  for (const char* name : {"a.glb", "a.vtm", "a.xyz"}) {
    write_bytes(folder / name, "x");
    try {
      read_mesh(folder / name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_NE(what.find(".ply .stl .obj .off .vtp .3mf .gii"), std::string::npos) << what;
      EXPECT_EQ(what.find("or .glb"), std::string::npos) << what;
    }
  }
}

// Files as other programs write them.

TriangleMesh read_text(const std::string& name, const std::string& text) {
  const TempFolder folder;
  write_bytes(folder / name, text);
  return read_mesh(folder / name);
}

const std::vector<Triangle> kSquareFan{{0, 1, 2}, {0, 2, 3}};

TEST(MeshFiles, PlyAscii) {
  const TriangleMesh mesh = read_text(
      "a.ply",
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 4\r\nproperty float x\r\nproperty "
      "float y\r\n"
      "property float z\r\nproperty uchar red\r\nelement face 2\r\nproperty uchar flags\r\n"
      "property list uchar int vertex_indices\r\nelement edge 1\r\nproperty int a\r\nend_header\r\n"
      "0 0 0 255\r\n1 0 0 0\r\n1 1 0 0\r\n0 1 .5e1 0\r\n7 4 0 1 2 3\r\n0 2 0 1\r\n5\r\n");
  EXPECT_EQ(mesh.positions[3], (Vec3{0, 1, 5}));
  EXPECT_EQ(mesh.triangles, kSquareFan);
}

TEST(MeshFiles, PlyBigEndian) {
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double "
      "y\nproperty short z\n"
      "element face 1\nproperty list uint8 uint16 vertex_index\nend_header\n";
  const auto big = [&](auto value) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    std::reverse(bytes.begin(), bytes.end());
    text.append(bytes.data(), bytes.size());
  };
  for (const int v : {0, 1, 2}) {
    big(0.5F * static_cast<float>(v));
    big(0.1 * v * v);
    big(static_cast<std::int16_t>(-v));
  }
  text += '\3';
  for (const int index : {0, 2, 1}) {
    big(static_cast<std::uint16_t>(index));
  }
  const TriangleMesh mesh = read_text("a.ply", text);
  EXPECT_EQ(mesh.positions[2], (Vec3{1, 0.1 * 2 * 2, -2}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 2, 1}}));
}

TEST(MeshFiles, ObjKeepsSharedVerticesWithNormalsAndTexture) {
  const TriangleMesh mesh =
      read_text("a.obj",
                "# x\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 +1 0\nvt 0 0\nvt 1 "
                "0\nvn 0 0 1\nvn 0 1 0\n"
                "usemtl m\ns off\nl 1 2\nf 1/1/1 2/2/2 3//1 4\n\nf -4/1/2 -2 -1 \\\n  -3\n");
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 2, 3}, {0, 3, 1}}));
}

TEST(MeshFiles, OffVariants) {
  const std::string body = "4 1 0\n0 0 0\n1 0 0\n# comment\n\n1 1 0\n0 1 0\n4 0 1 2 3\n";
  EXPECT_EQ(read_text("a.off", "OFF\n" + body).triangles, kSquareFan);
  EXPECT_EQ(read_text("a.off", "OFF " + body).triangles, kSquareFan);
  EXPECT_EQ(read_text("a.off", "# first\nOFF # x\n" + body).triangles, kSquareFan);
  EXPECT_EQ(
      read_text(
          "a.off",
          "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 1 2 3 4\n1 1 0 0 0 0 0\n3 0 1 2 0.5 0.5 0.5\n")
          .triangles,
      (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_THROW(read_text("a.off", "4OFF\n" + body),
               Error);  // homogeneous coordinates are not read
  EXPECT_THROW(read_text("a.off", "nOFF\n3\n" + body), Error);
  EXPECT_THROW(read_text("a.off", "OFF BINARY\n" + body), Error);
}

TEST(MeshFiles, StlAsciiMergesEqualCorners) {
  const TriangleMesh mesh = read_text("a.stl",
                                      "solid a name\n facet normal 0 0 1\n  outer loop\n   vertex "
                                      "0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n"
                                      "  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   "
                                      "vertex -0.0 0 0e0\n   vertex 1.0 1 0\n"
                                      "   vertex 0 1 0\n  endloop\n endfacet\nendsolid a name\n");
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.triangles, kSquareFan);
}

TEST(MeshFiles, SeveralSolidsOfAnStlAreOneMesh) {
  const std::string loop = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ";
  const std::string end = "\nendloop\nendfacet\nendsolid\n";
  const TriangleMesh mesh = read_text(
      "a.stl", "solid one\n" + loop + "1 1 0" + end + "solid two\n" + loop + "0 -1 0" + end);
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.triangles.size(), 2U);
}

TEST(MeshFiles, BinaryStlThatStartsWithSolid) {
  const TempFolder folder;
  write_mesh(octahedron(), folder / "a.stl");
  std::string bytes = read_bytes(folder / "a.stl");
  bytes.replace(0, 6, "solid ");
  write_bytes(folder / "a.stl", bytes);
  EXPECT_EQ(read_mesh(folder / "a.stl").triangles.size(), 8U);
  write_bytes(folder / "a.stl", bytes + "more");
  expect_error(ErrorCode::bad_file, "states 8 triangles", folder / "a.stl",
               [&] { read_mesh(folder / "a.stl"); });
}

TEST(MeshFiles, VtpStripsAndPolygonsBecomeTriangles) {
  const std::string head =
      "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n<Piece "
      "NumberOfPoints=\"4\" "
      "NumberOfVerts=\"1\" NumberOfLines=\"0\" NumberOfStrips=\"1\" "
      "NumberOfPolys=\"1\">\n<Points><DataArray type=\"Float32\" "
      "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>\n";
  const auto cells = [](const std::string& kind, const std::string& ids, const std::string& end) {
    return "<" + kind + "><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" + ids +
           "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">" + end +
           "</DataArray></" + kind + ">\n";
  };
  const std::string tail = "</Piece>\n</PolyData>\n</VTKFile>\n";
  const TriangleMesh mesh =
      read_text("a.vtp", head + cells("Verts", "2", "1") + cells("Strips", "0 1 3 2", "4") +
                             cells("Polys", "0 1 2 3", "4") + tail);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}}));
  EXPECT_THROW(
      read_text("b.vtp", head + cells("Verts", "2", "1") + cells("Strips", "0 1 3 2", "4") +
                             cells("Polys", "0 1 2 9", "4") + tail),
      Error);
  EXPECT_THROW(
      read_text("c.vtp", head + cells("Verts", "2", "1") + cells("Strips", "0 1 3 2", "4") +
                             cells("Polys", "0 1 2 3", "400") + tail),
      Error);
  EXPECT_THROW(
      read_text("d.vtp", head + cells("Verts", "2", "1") + cells("Strips", "0 1 3 2", "4") +
                             cells("Polys", "0 1 -2 3", "-4") + tail),
      Error);
}

// A closed prism over an L-shaped polygon; its polygons begin at a corner whose fan leaves the
// polygon.
TEST(MeshFiles, ConcavePolygonsAreCutInside) {
  const std::string faces =
      "f 2 3 4 5 6 1\nf 8 7 12 11 10 9\nf 1 7 8 2\nf 2 8 9 3\nf 3 9 10 4\nf 4 10 11 5\nf 5 11 12 "
      "6\nf 6 12 7 1\n";
  std::string vertices;
  for (const std::string z : {"1", "0"})
    for (const std::string xy : {"0 0", "2 0", "2 1", "1 1", "1 2", "0 2"})
      vertices += "v " + xy + " " + z + "\n";
  for (const std::string& text :
       {vertices + faces, faces + vertices}) {  // faces may precede the vertices
    const TriangleMesh mesh = read_text("l.obj", text);
    ASSERT_EQ(mesh.triangles.size(), 2U * 4 + 6 * 2);
    double volume = 0, area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
      const Vec3 n{(b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y),
                   (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z),
                   (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)};
      area += std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z) / 2;
      volume += (a.x * n.x + a.y * n.y + a.z * n.z) / 6;
    }
    EXPECT_NEAR(volume, 3, 1e-12);
    EXPECT_NEAR(area, 2 * 3 + 8, 1e-12);
    const MeshCounts counts = count_mesh(mesh);
    EXPECT_EQ(counts.fault, "");
    EXPECT_EQ(counts.topology.kinds, (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  }
}

TEST(MeshFiles, WhatEditorsAndOtherProgramsWrite) {
  const std::string bom = "\xEF\xBB\xBF", triangle = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(read_text("a.obj", bom + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions.size(), 3U);
  EXPECT_EQ(read_text("a.off", bom + "OFF\n3 1 0\n" + triangle + "3 0 1 2\n").triangles.size(), 1U);
  EXPECT_EQ(read_text("b.off",
                      "NCOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 255 0 0 255\n0 1 0 0 0 1 "
                      "255 0 0 255\n3 0 1 2\n")
                .positions[1],
            (Vec3{1, 0, 0}));
  EXPECT_EQ(
      read_text("a.stl", bom + "SOLID a\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 "
                               "0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID a\n")
          .triangles.size(),
      1U);
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(read_text("d.obj", square + "f 1 2\\\n3 4\n").triangles, kSquareFan);
  EXPECT_EQ(read_text("d.obj", square + "f 1 2 \\\n3 4 # a square\n").triangles, kSquareFan);
  EXPECT_EQ(read_text("d.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                      "y\nproperty float z\nelement face 1\n"
                      "property list uchar int vertex_indexes\nend_header\n" +
                          triangle + "3 0 1 2\n")
                .triangles.size(),
            1U);
  EXPECT_EQ(read_text("e.obj", "v 0 0 \\\n 0\nv 1 0 0\nv 1 1 0 # corner\nv 0\\\n1 0\nf 1 2 3 4\n")
                .triangles,
            kSquareFan);
  const TempFolder folder;
  write_bytes(folder / "c.obj", "# COLORSPACE=RAS\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mesh_space(folder / "c.obj"), "");
}

// Line ends of old Macs, which some exporters still write.
TEST(MeshFiles, LinesThatEndInCarriageReturns) {
  const auto with_returns = [](std::string text) {
    std::ranges::replace(text, '\n', '\r');
    return text;
  };
  EXPECT_EQ(read_text("a.obj", with_returns("# x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"))
                .triangles,
            kSquareFan);
  EXPECT_EQ(read_text("a.off", with_returns("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"))
                .triangles,
            kSquareFan);
  EXPECT_EQ(read_text("a.stl", with_returns("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 "
                                            "0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
                                            "endfacet\nendsolid\n"))
                .triangles.size(),
            1U);
  const std::string ply = with_returns(
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar "
      "y\nproperty uchar z\n"
      "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n");
  const TriangleMesh mesh = read_text(
      "a.ply",
      ply + std::string("\n\r\r\1\2\3\1\2\4\3\0\1\2", 13));  // values whose bytes are line ends
  EXPECT_EQ(mesh.positions[0], (Vec3{10, 13, 13}));
}

TEST(MeshFiles, NumbersBelowTheSmallestDoubleAreZero) {
  const TriangleMesh mesh =
      read_text("a.obj", "v 1e-400 -1e-400 +1e-320\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], (Vec3{0, 0, 1e-320}));
}

struct BadMesh {
  std::string name, text, message;
};

TEST(MeshFiles, BadFilesGiveOneLine) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n";
  const std::string ply_faces =
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::vector<BadMesh> files{
      {"empty.ply", "", "is empty"},
      {"garbage.ply", "hello", "not a PLY file"},
      {"header.ply", ply, "ends in its header"},
      {"word.ply", ply + "nonsense\n", "line 7: found 'nonsense'"},
      {"promise.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float "
       "x\nend_header\n1234",
       "too short"},
      {"text.ply", ply + ply_faces + "0 0 0\n0 1 x\n", "line 11: found 'x', expected a number"},
      {"large.obj", "v 0 0 1e400\n", "line 1: found '1e400'"},
      {"short.ply", ply + ply_faces + "0 0 0\n0 1 0\n1 0 0\n3 0 1\n", "expected more data"},
      {"range.ply", ply + ply_faces + "0 0 0\n0 1 0\n1 0 0\n3 0 1 3\n", "triangle 0 uses vertex 3"},
      {"negative.ply", ply + ply_faces + "0 0 0\n0 1 0\n1 0 0\n3 0 1 -1\n", "uses vertex"},
      {"nan.ply", ply + ply_faces + "0 0 0\n0 nan 0\n1 0 0\n3 0 1 2\n", "vertex 1 is not finite"},
      {"none.ply", ply + "end_header\n0 0 0\n0 1 0\n1 0 0\n", "no triangles"},
      {"noz.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n" + ply_faces +
           "0 0\n",
       "no z coordinate"},
      {"garbage.stl", "hello", "too short"},
      {"count.stl", std::string(200, 'x'), "states"},
      {"cut.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n",
       "line 5: the file ends here"},
      {"four.stl",
       "solid\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
       "0\nendloop\nendsolid\n",
       "4 corners"},
      {"nan.stl",
       "solid\nouter loop\nvertex 0 0 nan\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendsolid\n",
       "not finite"},
      {"none.stl", "solid\nendsolid\n", "no triangles"},
      {"none.obj", "v 0 0 0\n", "no triangles"},
      {"zero.obj", "v 0 0 0\nf 0 1 1\n", "line 2: vertex number 0"},
      {"range.obj", "v 0 0 0\nf 1 1 2\n", "uses vertex 1"},
      {"before.obj", "v 0 0 0\nf 1 1 -2\n", "uses vertex"},
      {"word.obj", "v 0 0 zero\n", "line 1: found 'zero'"},
      {"two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "a face with 2 corners"},
      {"garbage.off", "hello", "line 1: found 'hello', expected OFF"},
      {"promise.off", "OFF\n1000000000000 1 0\n0 0 0\n", "too short"},
      {"negative.off", "OFF\n-1 1 0\n0 0 0\n", "too short"},
      {"cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0     \n#            ", "expected more lines"},
      {"short.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1\n",
       "line 6: found '', expected a vertex number"},
      {"count.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n-4 3 2 1 0\n", "a face with -4 corners"},
      {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n", "uses vertex 3"},
      {"garbage.vtp", "hello", "is not a VTK XML poly data file"},
  };
  for (const BadMesh& file : files) {
    const TempFolder folder;
    SCOPED_TRACE(file.name);
    write_bytes(folder / file.name, file.text);
    expect_error(ErrorCode::bad_file, file.message, folder / file.name,
                 [&] { read_mesh(folder / file.name); });
  }
  const TempFolder folder;
  write_bytes(folder / "strips.ply",
              ply +
                  "element face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\n"
                  "property list int int vertex_indices\nend_header\n0 0 0\n0 1 0\n1 0 0\n3 0 1 "
                  "2\n3 0 1 2\n");
  expect_error(ErrorCode::unsupported, "holds triangle strips", folder / "strips.ply",
               [&] { read_mesh(folder / "strips.ply"); });
  write_bytes(folder / "a.xyz", "x");
  expect_error(ErrorCode::unsupported, ".ply", folder / "a.xyz",
               [&] { read_mesh(folder / "a.xyz"); });
  expect_error(ErrorCode::bad_file, "no such file", folder / "a.ply",
               [&] { read_mesh(folder / "a.ply"); });
}

// A file that is cut or has one byte changed gives an Error or a mesh, never a crash; a cut binary
// file always gives an Error.
TEST(MeshFiles, DamagedFiles) {
  std::mt19937 random(7);
  for (const char* extension : kFormats) {
    SCOPED_TRACE(extension);
    const TempFolder folder;
    const auto path = folder / (std::string("a") + extension);
    write_mesh(octahedron(), path, kInfo);
    const std::string whole = read_bytes(path);
    const bool is_text = std::string(extension) == ".obj" || std::string(extension) == ".off";
    for (int i = 0; i < 150; ++i) {
      const std::size_t length = random() % (whole.size() - 8);
      write_bytes(path, whole.substr(0, length));
      try {
        const TriangleMesh mesh = read_mesh(path);
        EXPECT_TRUE(is_text) << "read " << mesh.triangles.size() << " triangles of " << length
                             << " of " << whole.size() << " bytes";
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
      std::string changed = whole;
      changed[random() % whole.size()] = static_cast<char>(random());
      write_bytes(path, changed);
      try {
        read_mesh(path);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
