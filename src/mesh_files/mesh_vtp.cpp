// SPDX-License-Identifier: Apache-2.0
// VTK's XML poly data, by VTK.
#include <vtkCellArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <string>

#include "files/file_error.h"
#include "mesh_files/formats.h"
#include "files/library_messages.h"
#include "mesh_files/polygon_fan.h"
#include "files/vtk_xml_file.h"

namespace isoatlas::io {

namespace {

constexpr const char* kDistanceArray = "max_distance";

void add_field(vtkPolyData& data, const std::string& name, const std::string& value) {
  if (!value.empty()) {
    vtkNew<vtkStringArray> field;
    field->SetName(name.c_str());
    field->InsertNextValue(value);
    data.GetFieldData()->AddArray(field);
  }
}

std::map<std::string, std::string> text_fields(vtkPolyData& data) {
  std::map<std::string, std::string> fields;
  vtkFieldData& all = *data.GetFieldData();
  for (int i = 0; i < all.GetNumberOfArrays(); ++i) {
    auto* field = vtkStringArray::SafeDownCast(all.GetAbstractArray(i));
    if (field != nullptr && field->GetName() != nullptr && field->GetNumberOfValues() > 0) {
      fields[field->GetName()] = field->GetValue(0);
    }
  }
  return fields;
}

void append_cells(TriangleMesh& mesh, vtkCellArray& cells, bool are_strips, const std::filesystem::path& path) {
  if (cells.GetNumberOfCells() == 0) {
    return;
  }
  if (!cells.IsValid()) {
    throw bad_file(path, "its list of polygons is damaged");
  }
  std::vector<std::uint32_t> corners;
  for (vtkIdType cell = 0; cell < cells.GetNumberOfCells(); ++cell) {
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    cells.GetCellAtId(cell, count, points);
    corners.clear();
    for (vtkIdType i = 0; i < count; ++i) {
      corners.push_back(vertex_index(points[i]));
    }
    if (!are_strips) {
      append_polygon(mesh, corners);
      continue;
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {  // every other triangle of a strip runs the other way round
      const bool is_even = i % 2 == 0;
      mesh.triangles.push_back({corners[i - 2], corners[is_even ? i - 1 : i], corners[is_even ? i : i - 1]});
    }
  }
}

}  // namespace

TriangleMesh read_vtp(const std::filesystem::path& path) {
  std::map<std::string, std::string> ignored;
  std::vector<float> ignored_too;
  return read_vtp(path, ignored, ignored_too);
}

TriangleMesh read_vtp(const std::filesystem::path& path, std::map<std::string, std::string>& fields, std::vector<float>& distance) {
  const LibraryMessages messages;
  vtkNew<vtkXMLPolyDataReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) {
    throw bad_file(path, "is not a VTK XML poly data file");
  }
  require_readable_vtk_xml(path);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  reader->GetPointDataArraySelection()->DisableAllArrays();
  reader->GetPointDataArraySelection()->EnableArray(kDistanceArray);
  reader->GetCellDataArraySelection()->DisableAllArrays();
  reader->Update();
  if (const std::string error = messages.first_vtk_error(); !error.empty() || reader->GetErrorCode() != 0) {
    throw bad_file(path, "cannot be read: " + (error.empty() ? "VTK reports a damaged file" : error));
  }
  vtkPolyData* data = reader->GetOutput();
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
  for (vtkIdType v = 0; v < data->GetNumberOfPoints(); ++v) {
    Vec3& position = mesh.positions[static_cast<std::size_t>(v)];
    double coordinates[3];
    data->GetPoint(v, coordinates);
    position = {coordinates[0], coordinates[1], coordinates[2]};
  }
  append_cells(mesh, *data->GetPolys(), false, path);
  append_cells(mesh, *data->GetStrips(), true, path);
  fields = text_fields(*data);
  distance.clear();
  if (vtkDataArray* array = data->GetPointData()->GetArray(kDistanceArray); array != nullptr && array->GetNumberOfComponents() == 1) {
    for (vtkIdType v = 0; v < array->GetNumberOfTuples(); ++v) distance.push_back(static_cast<float>(array->GetTuple1(v)));
  }
  return mesh;
}

void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  write_vtp(mesh, {{"SPACE", info.space}, {"COMMENT", info.comment}}, {}, file);  // SPACE is 3D Slicer's name for it
}

void write_vtp(const TriangleMesh& mesh, const std::map<std::string, std::string>& fields, const std::vector<float>& distance,
               AtomicFile& file) {
  const LibraryMessages messages;
  const auto vertex_count = static_cast<vtkIdType>(mesh.positions.size());
  const auto triangle_count = static_cast<vtkIdType>(mesh.triangles.size());

  // VTK reads our positions where they are (save = 1: it does not free them).
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  auto* first_coordinate = const_cast<double*>(reinterpret_cast<const double*>(mesh.positions.data()));
  coordinates->SetArray(first_coordinate, 3 * vertex_count, 1);
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);

  vtkNew<vtkTypeInt64Array> offsets;
  vtkNew<vtkTypeInt64Array> connectivity;
  offsets->SetNumberOfValues(triangle_count + 1);
  connectivity->SetNumberOfValues(3 * triangle_count);
  for (vtkIdType t = 0; t < triangle_count; ++t) {
    offsets->SetValue(t, 3 * t);
    for (int k = 0; k < 3; ++k) {
      connectivity->SetValue(3 * t + k, mesh.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
    }
  }
  offsets->SetValue(triangle_count, 3 * triangle_count);
  vtkNew<vtkCellArray> polygons;
  polygons->SetData(offsets, connectivity);

  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(polygons);
  for (const auto& [name, value] : fields) {
    add_field(*data, name, value);
  }
  if (!distance.empty()) {
    vtkNew<vtkFloatArray> array;
    array->SetName(kDistanceArray);
    array->SetArray(const_cast<float*>(distance.data()), static_cast<vtkIdType>(distance.size()), 1);
    data->GetPointData()->AddArray(array);
  }

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(file.written_path().c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  const bool written = writer->Write() != 0;
  if (!written || writer->GetErrorCode() != vtkErrorCode::NoError) {
    throw bad_file(file.destination(),
                   "cannot be written: VTK reports " + one_line(vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode())));
  }
}

}  // namespace isoatlas::io
