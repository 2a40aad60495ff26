// SPDX-License-Identifier: Apache-2.0
// VTK XML poly data as VTK writes it, in all its encodings, and damaged files.
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <random>

#include "isoatlas/io.h"
#include "mesh_files/formats.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

struct Encoding {
  int mode = vtkXMLWriter::Appended;
  int compressor = vtkXMLWriter::NONE;
  int header_type = vtkXMLWriter::UInt32;
  int id_type = vtkXMLWriter::Int64;
  int byte_order = vtkXMLWriter::LittleEndian;
  bool is_base64 = true;
  int pieces = 1;
};

std::string to_string(const Encoding& e) {
  const std::string mode = e.mode == vtkXMLWriter::Ascii    ? "text"
                           : e.mode == vtkXMLWriter::Binary ? "inline"
                                                            : "appended";
  return mode + ", compressor " + std::to_string(e.compressor) + ", header " +
         std::to_string(e.header_type) + ", ids " + std::to_string(e.id_type) + ", order " +
         std::to_string(e.byte_order) + (e.is_base64 ? ", base64, " : ", raw, ") +
         std::to_string(e.pieces) + " pieces";
}

std::vector<Encoding> all_encodings() {
  std::vector<Encoding> all;
  for (const int compressor :
       {vtkXMLWriter::NONE, vtkXMLWriter::ZLIB, vtkXMLWriter::LZ4, vtkXMLWriter::LZMA})
    for (const int header_type : {vtkXMLWriter::UInt32, vtkXMLWriter::UInt64})
      for (const int id_type : {vtkXMLWriter::Int32, vtkXMLWriter::Int64})
        for (const int byte_order : {vtkXMLWriter::LittleEndian, vtkXMLWriter::BigEndian})
          for (const int pieces : {1, 3}) {
            all.push_back({vtkXMLWriter::Appended, compressor, header_type, id_type, byte_order,
                           false, pieces});
            all.push_back({vtkXMLWriter::Appended, compressor, header_type, id_type, byte_order,
                           true, pieces});
            all.push_back(
                {vtkXMLWriter::Binary, compressor, header_type, id_type, byte_order, true, pieces});
          }
  for (const int pieces : {1, 3}) all.push_back({.mode = vtkXMLWriter::Ascii, .pieces = pieces});
  return all;
}

// Points with few digits, which text keeps exactly, enough for several compressed blocks, and
// quadrilaterals between them.
vtkSmartPointer<vtkPolyData> grid_of_quadrilaterals(int side) {
  std::mt19937 random(3);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkFloatArray> distance;
  distance->SetName("max_distance");
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      points->InsertNextPoint(x, y, static_cast<double>(random() % 4) / 16);
      distance->InsertNextValue(static_cast<float>(x + y) / 4);
    }
  vtkNew<vtkCellArray> polygons;
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const vtkIdType first = y * side + x;
      const vtkIdType corners[4] = {first, first + 1, first + side + 1, first + side};
      polygons->InsertNextCell(4, corners);
    }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(polygons);
  data->GetPointData()->AddArray(distance);
  vtkNew<vtkStringArray> space;
  space->SetName("SPACE");
  space->InsertNextValue("RAS & more");
  space->InsertNextValue("a second one");
  data->GetFieldData()->AddArray(space);
  return data;
}

void write(vtkPolyData* data, const Encoding& encoding, const std::filesystem::path& path) {
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(data);
  writer->SetDataMode(encoding.mode);
  writer->SetCompressorType(encoding.compressor);
  writer->SetHeaderType(encoding.header_type);
  writer->SetIdType(encoding.id_type);
  writer->SetByteOrder(encoding.byte_order);
  writer->SetEncodeAppendedData(encoding.is_base64);
  writer->SetNumberOfPieces(encoding.pieces);
  writer->SetBlockSize(4096);
  ASSERT_EQ(writer->Write(), 1);
}

// VTK's writer repeats all of this data in each piece.
void expect_equal(const TriangleMesh& mesh, int pieces, vtkPolyData& data) {
  const auto points = static_cast<std::size_t>(data.GetNumberOfPoints());
  const auto polygons = static_cast<std::size_t>(data.GetNumberOfPolys());
  ASSERT_EQ(mesh.positions.size(), points * static_cast<std::size_t>(pieces));
  ASSERT_EQ(mesh.triangles.size(), 2 * polygons * static_cast<std::size_t>(pieces));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double* const point = data.GetPoint(static_cast<vtkIdType>(v % points));
    ASSERT_EQ(mesh.positions[v], (Vec3{point[0], point[1], point[2]}));
  }
  for (std::size_t polygon = 0; polygon < polygons * static_cast<std::size_t>(pieces); ++polygon) {
    vtkNew<vtkIdList> corners;
    data.GetPolys()->GetCellAtId(static_cast<vtkIdType>(polygon % polygons), corners);
    const auto corner = [&](vtkIdType k) {
      return static_cast<std::uint32_t>(corners->GetId(k)) +
             static_cast<std::uint32_t>(polygon / polygons * points);
    };
    ASSERT_EQ(mesh.triangles[2 * polygon], (Triangle{corner(0), corner(1), corner(2)}));
    ASSERT_EQ(mesh.triangles[2 * polygon + 1], (Triangle{corner(0), corner(2), corner(3)}));
  }
}

TEST(ReadVtp, EveryEncodingThatVtkWrites) {
  const auto data = grid_of_quadrilaterals(40);
  for (const Encoding& encoding : all_encodings()) {
    SCOPED_TRACE(to_string(encoding));
    const TempFolder folder;
    write(data, encoding, folder / "a.vtp");
    std::map<std::string, std::string> fields;
    std::vector<float> distance;
    const TriangleMesh mesh = io::read_vtp(folder / "a.vtp", fields, distance);
    expect_equal(mesh, encoding.pieces, *data);
    EXPECT_EQ(fields["SPACE"], "RAS & more");
    ASSERT_EQ(distance.size(), mesh.positions.size());
    EXPECT_EQ(distance[1], 0.25F);
  }
}

std::string file_of(const std::string& piece) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n<PolyData>\n" +
         piece + "</PolyData>\n</VTKFile>\n";
}

std::string array_of(const std::string& attributes, const std::string& values) {
  return "<DataArray " + attributes + " format=\"ascii\">" + values + "</DataArray>\n";
}

const std::string kPoints =
    "<Points>" + array_of(R"(type="Float32" NumberOfComponents="3")", "0 0 0 1 0 0 1 1 0 0 1 0") +
    "</Points>\n";
const std::string kCorners = array_of(R"(type="Int32" Name="connectivity")", "0 1 2 0 2 3");
const std::string kEnds = array_of(R"(type="Int32" Name="offsets")", "3 6");

std::string piece_of(const std::string& counts, const std::string& contents) {
  return "<Piece " + counts + ">\n" + contents + "</Piece>\n";
}

std::string square(const std::string& polygons) {
  return file_of(piece_of(R"(NumberOfPoints="4" NumberOfPolys="2")",
                          kPoints + "<Polys>\n" + polygons + "</Polys>\n"));
}

TEST(ReadVtp, DamagedFilesGiveOneLine) {
  const std::vector<std::array<std::string, 2>> files{
      {square(kCorners + array_of(R"(type="Int32" Name="offsets")", "6 3")), "decrease"},
      {square(kCorners + array_of(R"(type="Int32" Name="offsets")", "-3 6")), "decrease"},
      {square(kCorners + array_of(R"(type="Int32" Name="offsets")", "3")), "far more than a file"},
      {square(kCorners + array_of(R"(type="Int64" Name="offsets")", "3 4000000000000")),
       "far more than a file"},
      {square(kCorners), "no arrays 'connectivity' and 'offsets' of its Polys"},
      {square(kEnds + array_of(R"(type="Float32" Name="connectivity")", "0 1 2 0 2 3")),
       "vertex numbers are Float32"},
      {square(kEnds +
              array_of(R"(type="UInt64" Name="connectivity")", "0 1 2 0 2 18446744073709551615")),
       "uses vertex"},
      {square(kEnds + array_of(R"(type="Int32" Name="connectivity")", "0 1 2 0 2 4")),
       "uses vertex 4"},
      {square(kEnds + array_of(R"(type="Int32" Name="connectivity")", "0 1 2 0 2 -1")),
       "uses vertex"},
      {square(kEnds + array_of(R"(type="Quaternion" Name="connectivity")", "0 1 2 0 2 3")),
       "unknown data type 'Quaternion'"},
      {square(kEnds + array_of(R"(type="String" Name="connectivity")", "0 1 2 0 2 3")),
       "array of strings"},
      {file_of(piece_of(R"(NumberOfPoints="1e30" NumberOfPolys="2")", kPoints)),
       "'1e30', expected a count"},
      {file_of(piece_of(R"(NumberOfPoints="-4" NumberOfPolys="2")", kPoints)),
       "'-4', expected a count"},
      {file_of(piece_of(R"(NumberOfPoints="4.5" NumberOfPolys="2")", kPoints)),
       "'4.5', expected a count"},
      {file_of(piece_of(R"(NumberOfPoints="400000000" NumberOfPolys="2")", kPoints)),
       "far more than a file"},
      {file_of(piece_of(R"(NumberOfPoints="5" NumberOfPolys="2")", kPoints)),
       "has 12 numbers, expected 15"},
      {file_of(piece_of(R"(NumberOfPoints="4" NumberOfPolys="2")", "")), "no array of points"},
      {file_of(piece_of(R"(NumberOfPoints="4")",
                        "<Points>" + array_of(R"(type="Float32")", "0 0 0 0") + "</Points>")),
       "1 coordinates, expected 3"},
      {file_of(""), "no triangles"},
      {"<VTKFile type=\"ImageData\"><ImageData/></VTKFile>", "it holds 'ImageData'"},
      {"<VTKFile type=\"PolyData\"></VTKFile>", "is not a VTK XML poly data file"},
      {"<VTKFile type=\"PolyData\"><PolyData>", "is cut off"},
      {"<VTKFile type=\"PolyData\"><PolyData></VTKFile>", "not well-formed XML"},
  };
  for (const auto& [text, message] : files) {
    SCOPED_TRACE(text);
    const TempFolder folder;
    write_bytes(folder / "a.vtp", text);
    expect_error(ErrorCode::bad_file, message, folder / "a.vtp",
                 [&] { read_mesh(folder / "a.vtp"); });
  }
}

// 16 bytes of appended base64 state an array of 2^39 bytes of text, which VTK's reader allocated.
TEST(ReadVtp, TextThatTheFileCannotHoldIsNotAllocated) {
  for (const std::string compressor : {"", " compressor=\"vtkZLibDataCompressor\""}) {
    const TempFolder folder;
    write_bytes(folder / "a.vtp",
                "<VTKFile type=\"PolyData\" header_type=\"UInt64\"" + compressor +
                    "><PolyData><FieldData><Array type=\"String\" Name=\"SPACE\" "
                    "format=\"appended\" offset=\"0\"/>"
                    "</FieldData></PolyData><AppendedData "
                    "encoding=\"base64\">_AQAAAIAAAAAEAACAAAAAAAAAAAAAAAAAAQAAAAAAAAA="
                    "</AppendedData></VTKFile>");
    EXPECT_THROW(read_mesh(folder / "a.vtp"), Error) << compressor;
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
