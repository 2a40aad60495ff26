// SPDX-License-Identifier: Apache-2.0
// .3mf: written files as lib3mf, an independent reader, reads them; files as other programs write
// them; damaged packages.
#include <gtest/gtest.h>
#include <Model/COM/NMR_DLLInterfaces.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "isoatlas/io.h"
#include "mesh_files/zip_archive.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

TriangleMesh tetrahedron() {
  return {{{1e-7 / 3, 0, 0}, {1234.1, 0, 0}, {0, -1e5 / 7, 0}, {0, 0, 2.5e-3}},
          {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
}

TriangleMesh open_tetrahedron() {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  return mesh;
}

// The model as lib3mf reads it in its strict mode, in which every warning is an error.
struct Lib3mfModel {
  TriangleMesh mesh;
  DWORD unit = 0, type = 0, items = 0;
};

#define EXPECT_DONE(call) ASSERT_EQ(NMR::call, 0U)

void read_by_lib3mf(const fs::path& path, Lib3mfModel& out) {
  void **model = nullptr, **reader = nullptr, **items = nullptr, **item = nullptr,
       **object = nullptr;
  BOOL more = 0;
  EXPECT_DONE(lib3mf_createmodel(&model));
  EXPECT_DONE(lib3mf_model_queryreader(model, "3mf", &reader));
  EXPECT_DONE(lib3mf_reader_setstrictmodeactive(reader, 1));
  EXPECT_DONE(lib3mf_reader_readfromfileutf8(reader, path.c_str()));
  EXPECT_DONE(lib3mf_model_getunit(model, &out.unit));
  EXPECT_DONE(lib3mf_model_getbuilditems(model, &items));
  EXPECT_DONE(lib3mf_builditemiterator_movenext(items, &more));
  while (more != 0) {
    ++out.items;
    EXPECT_DONE(lib3mf_builditemiterator_getcurrent(items, &item));
    EXPECT_DONE(lib3mf_builditem_getobjectresource(item, &object));
    EXPECT_DONE(lib3mf_object_gettype(object, &out.type));
    DWORD vertices = 0, triangles = 0;
    EXPECT_DONE(lib3mf_meshobject_getvertexcount(object, &vertices));
    EXPECT_DONE(lib3mf_meshobject_gettrianglecount(object, &triangles));
    for (DWORD v = 0; v < vertices; ++v) {
      NMR::MODELMESHVERTEX vertex{};
      EXPECT_DONE(lib3mf_meshobject_getvertex(object, v, &vertex));
      out.mesh.positions.push_back(
          {vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2]});
    }
    for (DWORD t = 0; t < triangles; ++t) {
      NMR::MODELMESHTRIANGLE triangle{};
      EXPECT_DONE(lib3mf_meshobject_gettriangle(object, t, &triangle));
      out.mesh.triangles.push_back(
          {triangle.m_nIndices[0], triangle.m_nIndices[1], triangle.m_nIndices[2]});
    }
    EXPECT_DONE(lib3mf_builditemiterator_movenext(items, &more));
  }
  for (void** instance : {object, item, items, reader, model}) {
    if (instance != nullptr) NMR::lib3mf_release(instance);
  }
}

TEST(Mesh3mf, Lib3mfReadsTheSameMesh) {
  const TempFolder folder;
  const fs::path path = folder / "a.3mf";
  write_mesh(tetrahedron(), path,
             {.space = "LPS", .comment = "<isoatlas> & \"co\"", .unit = LengthUnit::millimetre});
  Lib3mfModel model;
  read_by_lib3mf(path, model);
  EXPECT_EQ(model.unit, NMR::MODELUNIT_MILLIMETER);
  EXPECT_EQ(model.type, NMR::MODELOBJECTTYPE_MODEL);
  EXPECT_EQ(model.items, 1U);
  EXPECT_EQ(model.mesh.triangles, tetrahedron().triangles);
  ASSERT_EQ(model.mesh.positions.size(), 4U);
  for (std::size_t v = 0; v < 4; ++v) {  // lib3mf keeps them as floats
    const Vec3 a = model.mesh.positions[v], b = tetrahedron().positions[v];
    EXPECT_LE(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 1e-3);
  }
  EXPECT_EQ(mesh_file_info(path).comment, "<isoatlas> & \"co\"");
}

TEST(Mesh3mf, UnitsAreThoseOf3mf) {
  struct Row {
    LengthUnit unit;
    DWORD written;
    double scale;
    std::string note;
  };
  const std::vector<Row> rows{
      {LengthUnit::micrometre, NMR::MODELUNIT_MICROMETER, 1, ""},
      {LengthUnit::millimetre, NMR::MODELUNIT_MILLIMETER, 1, ""},
      {LengthUnit::centimetre, NMR::MODELUNIT_CENTIMETER, 1, ""},
      {LengthUnit::metre, NMR::MODELUNIT_METER, 1, ""},
      {LengthUnit::inch, NMR::MODELUNIT_INCH, 1, ""},
      {LengthUnit::nanometre, NMR::MODELUNIT_MICROMETER, 1e3, "in micrometres"},
      {LengthUnit::angstrom, NMR::MODELUNIT_MICROMETER, 1e4, "in micrometres"},
      {LengthUnit::unknown, NMR::MODELUNIT_MILLIMETER, 1, "millimetres, as the volume states none"},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(symbol(row.unit));
    const TempFolder folder;
    const fs::path path = folder / "a.3mf";
    const StoredPositions stored =
        write_mesh(tetrahedron(), path, {.space = "LPS", .comment = "", .unit = row.unit});
    Lib3mfModel model;
    read_by_lib3mf(path, model);
    EXPECT_EQ(model.unit, row.written);
    EXPECT_EQ(stored.notes.size(), row.note.empty() ? 0U : 1U);
    for (const std::string& note : stored.notes)
      EXPECT_NE(note.find(row.note), std::string::npos) << note;
    TriangleMesh read = read_mesh(path);
    EXPECT_EQ(mesh_file_info(path).unit, stored.unit);
    for (std::size_t v = 0; v < 4; ++v)
      EXPECT_EQ(read.positions[v].x,
                tetrahedron().positions[v].x / row.scale);  // exact: one division
    if (row.unit == LengthUnit::unknown) continue;
    convert_unit(read, stored.unit, row.unit);
    EXPECT_NEAR(read.positions[1].x, 1234.1, 1e-12);
  }
}

TEST(Mesh3mf, OpenMeshesAreSurfaces) {
  const TempFolder folder;
  const StoredPositions stored =
      write_mesh(open_tetrahedron(), folder / "a.3mf",
                 {.space = "LPS", .comment = "", .unit = LengthUnit::millimetre});
  ASSERT_EQ(stored.notes.size(), 1U);
  EXPECT_NE(stored.notes[0].find("open"), std::string::npos);
  Lib3mfModel model;
  read_by_lib3mf(folder / "a.3mf", model);
  EXPECT_EQ(model.type, NMR::MODELOBJECTTYPE_SURFACE);
  EXPECT_EQ(model.items, 1U);
  EXPECT_EQ(read_mesh(folder / "a.3mf").triangles, open_tetrahedron().triangles);
}

TEST(Mesh3mf, BytesDependOnTheMeshAlone) {
  const TempFolder folder;
  write_mesh(tetrahedron(), folder / "a.3mf");
  ASSERT_EQ(setenv("TZ", "Pacific/Kiritimati", 1), 0);  // archives store local times
  tzset();
  write_mesh(tetrahedron(), folder / "b.3mf");
  unsetenv("TZ");
  tzset();
  EXPECT_EQ(read_bytes(folder / "a.3mf"), read_bytes(folder / "b.3mf"));
}

// A package as other programs write it.
void write_package(const fs::path& path, const std::string& model,
                   const std::string& target = "/3D/3dmodel.model",
                   const std::string& name = "3D/3dmodel.model") {
  const std::string relationships =
      "<Relationships><Relationship Type=\"other\" Target=\"/x\"/><Relationship Id=\"r\" "
      "Target=\"" +
      target +
      "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  write_bytes(path, io::zip_bytes({{"[Content_Types].xml", "<Types/>"},
                                   {"_rels/.rels", relationships},
                                   {name, model}},
                                  path));
}

std::string object(const std::string& id, const std::string& content) {
  return "<object id='" + id + "'>" + content + "</object>";
}

const std::string kMesh =
    "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex z='+0' y='.0' x='1e0'/><vertex x='0' y=' "
    "1.0 ' z='0'/></vertices>"
    "<triangles><triangle v1='0' v2='1' v3='2' pid='7' p1='0'/></triangles></mesh>";

std::string model_of(const std::string& resources, const std::string& build,
                     const std::string& attributes = "") {
  return "<?xml version='1.0'?><!-- x --><model " + attributes +
         " xmlns:m='urn:m'><metadata name='Title'>a</metadata><resources>" + resources +
         "</resources><build>" + build + "</build></model>";
}

TEST(Mesh3mf, ComponentsAndTransforms) {
  const TempFolder folder;
  const fs::path path = folder / "a.3mf";
  // Object 2 has object 1 twice: moved, and mirrored in x; the item scales both. Object 3 is not
  // part of the build.
  write_package(
      path,
      model_of(
          "<m:colorgroup id='7'/>" + object("1", kMesh) +
              object(
                  "2",
                  "<components><component objectid='1' transform='1 0 0 0 1 0 0 0 1 10 20 30'/>"
                  "<component objectid='1' transform='-1 0 0 0 1 0 0 0 1 0 0 0'/></components>") +
              object("3", kMesh),
          "<item objectid='2' transform='2 0 0 0 2 0 0 0 2 1 0 0'/>", "unit='inch'"));
  const TriangleMesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.positions,
            (std::vector<Vec3>{
                {21, 40, 60}, {23, 40, 60}, {21, 42, 60}, {1, 0, 0}, {-1, 0, 0}, {1, 2, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{
                                {0, 1, 2}, {3, 5, 4}}));  // the mirrored copy keeps its orientation
  EXPECT_EQ(mesh_file_info(path).unit, LengthUnit::inch);
  EXPECT_EQ(mesh_space(path), "");
  write_package(path, model_of(object("1", kMesh), "<item objectid='1'/>"), "geometry/part.model",
                "geometry/part.model");
  EXPECT_EQ(read_mesh(path).positions[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh_file_info(path).unit, LengthUnit::millimetre);  // the default of the specification
}

// The core elements have a prefix, and the required extensions concern colours only.
TEST(Mesh3mf, NamespacePrefixes) {
  const TempFolder folder;
  const fs::path path = folder / "a.3mf";
  std::string model =
      model_of(object("1", kMesh), "<item objectid='1'/>", "unit='inch' requiredextensions='m'");
  for (const std::string name : {"model", "metadata", "resources", "object", "mesh", "vertices",
                                 "vertex", "triangles", "triangle", "build", "item"}) {
    for (const std::string mark : {"<", "</"}) {
      for (const std::string end : {" ", ">"}) {
        for (std::size_t at = model.find(mark + name + end); at != std::string::npos;
             at = model.find(mark + name + end, at + 1)) {
          model.insert(at + mark.size(), "c:");
        }
      }
    }
  }
  const std::string core = "xmlns:c='http://schemas.microsoft.com/3dmanufacturing/core/2015/02'";
  model.replace(model.find("xmlns:m='urn:m'"), 15,
                core + " xmlns:m='http://schemas.microsoft.com/3dmanufacturing/material/2015/02'");
  write_package(path, model);
  EXPECT_EQ(read_mesh(path).positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh_file_info(path).unit, LengthUnit::inch);
  model.replace(model.find(core), core.size(), "xmlns:c='urn:other'");
  write_package(path, model);
  expect_error(ErrorCode::bad_file, "has no model", path, [&] { read_mesh(path); });
}

TEST(Mesh3mf, BadPackagesGiveOneLine) {
  struct Bad {
    std::string model, message;
    ErrorCode code = ErrorCode::bad_file;
  };
  const std::string item = "<item objectid='1'/>";
  const auto vertex = [](const std::string& x) {
    return "<mesh><vertices><vertex x='" + x +
           "' y='0' z='0'/></vertices><triangles><triangle v1='0' v2='0' "
           "v3='0'/></triangles></mesh>";
  };
  std::string bomb = object("0", kMesh);
  for (int i = 1; i < 30; ++i) {
    std::string ten;
    for (int k = 0; k < 10; ++k) ten += "<component objectid='" + std::to_string(i - 1) + "'/>";
    bomb += object(std::to_string(i), "<components>" + ten + "</components>");
  }
  const std::vector<Bad> rows{
      {"<model", "is not XML"},
      {"<x/>", "has no model"},
      {model_of("", ""), "no triangles"},
      {model_of(object("2", kMesh), item), "has no object 1"},
      {model_of(object("1", vertex("abc")), item), "the x coordinate of a vertex is 'abc'"},
      {model_of(object("1", vertex("")), item), "the x coordinate of a vertex is ''"},
      {model_of(object("1", vertex("nan")), item), "not finite"},
      {model_of(object("1", vertex("1,5")), item),
       "the x coordinate of a vertex is '1,5', expected a number"},
      {model_of(object("1", vertex("1 2")), item),
       "the x coordinate of a vertex is '1 2', expected a number"},
      {model_of(object("1",
                       "<mesh><vertices><vertex x='0' y='0' z='0'/></vertices><triangles><triangle "
                       "v1='0' v2='0.5' v3='0'/></triangles></mesh>"),
                item),
       "v2='0.5'"},
      {model_of(object("1", kMesh), item, "requiredextensions='b' xmlns:b='urn:beams'"),
       "needs the 3MF extension urn:beams", ErrorCode::unsupported},
      {model_of(
           object(
               "1",
               "<mesh><vertices/><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>"),
           item),
       "v1='0'"},
      {model_of(object("1", "<components><component objectid='1'/></components>"), item),
       "nested too deeply"},
      {model_of(object("1", kMesh), "<item objectid='1' transform='1 0 0'/>"),
       "expected twelve numbers"},
      {model_of(
           object("1", "<components><component p:path='/3D/o.model' objectid='1'/></components>"),
           item),
       "several parts", ErrorCode::unsupported},
      {model_of(bomb, "<item objectid='29'/>"), "used too often"},
  };
  for (const Bad& row : rows) {
    SCOPED_TRACE(row.message);
    const TempFolder folder;
    write_package(folder / "a.3mf", row.model);
    expect_error(row.code, row.message, folder / "a.3mf", [&] { read_mesh(folder / "a.3mf"); });
  }
  const TempFolder folder;
  write_bytes(folder / "b.3mf", "no archive");
  expect_error(ErrorCode::bad_file, "is not a ZIP archive", folder / "b.3mf",
               [&] { read_mesh(folder / "b.3mf"); });
  write_bytes(folder / "c.3mf", io::zip_bytes({{"a", "b"}}, folder / "c.3mf"));
  expect_error(ErrorCode::bad_file, "has no part _rels/.rels", folder / "c.3mf",
               [&] { read_mesh(folder / "c.3mf"); });
  write_package(folder / "d.3mf", "<model/>", "/3D/other.model");
  expect_error(ErrorCode::bad_file, "has no part 3D/other.model", folder / "d.3mf",
               [&] { read_mesh(folder / "d.3mf"); });
}

// A package that is cut or has one byte changed gives an error, or the mesh itself if the byte is
// never read.
TEST(Mesh3mf, DamagedPackages) {
  const TempFolder folder;
  const fs::path path = folder / "a.3mf";
  write_mesh(tetrahedron(), path);
  const std::string whole = read_bytes(path);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write_bytes(path, whole.substr(0, length));
    EXPECT_THROW(read_mesh(path), Error) << length;
  }
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::string changed = whole;
    changed[random() % whole.size()] = static_cast<char>(random());
    write_bytes(path, changed);
    try {
      EXPECT_EQ(read_mesh(path).positions,
                tetrahedron().positions);  // the checksum of the archive is verified
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(Mesh3mf, LargeStatedSizesAreNotAllocated) {
  const TempFolder folder;
  const fs::path path = folder / "a.3mf";
  write_package(path, std::string(std::size_t{1} << 20, ' '));
  std::string bytes = read_bytes(path);
  const std::string size("\0\0\x10\0", 4),
      huge("\0\0\0\xF0", 4);  // size of the part, little endian, in two headers
  for (std::size_t at = bytes.find(size); at != std::string::npos; at = bytes.find(size, at + 4))
    bytes.replace(at, 4, huge);
  write_bytes(path, bytes);
  expect_error(ErrorCode::bad_file, "states 4026531840 bytes", path, [&] { read_mesh(path); });
}

}  // namespace
}  // namespace isoatlas::detail::test
