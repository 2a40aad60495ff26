// SPDX-License-Identifier: Apache-2.0
// What people use today, to compare with: marching cubes, by VTK.
#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cmath>

#include "page/page.h"

namespace isoatlas {
namespace {

int vtk_type(SampleType type) {
  switch (type) {
    case SampleType::int8:
      return VTK_TYPE_INT8;
    case SampleType::uint8:
      return VTK_TYPE_UINT8;
    case SampleType::int16:
      return VTK_TYPE_INT16;
    case SampleType::uint16:
      return VTK_TYPE_UINT16;
    case SampleType::int32:
      return VTK_TYPE_INT32;
    case SampleType::uint32:
      return VTK_TYPE_UINT32;
    case SampleType::int64:
      return VTK_TYPE_INT64;
    case SampleType::uint64:
      return VTK_TYPE_UINT64;
    case SampleType::float32:
      return VTK_TYPE_FLOAT32;
    case SampleType::float64:
      return VTK_TYPE_FLOAT64;
  }
  return VTK_VOID;
}

}  // namespace

std::optional<MeshQuality> marching_cubes_quality(const VolumeView& volume, double isovalue) {
  const auto& [nx, ny, nz] = volume.grid.size;
  const Vec3 spacing = volume.grid.spacing;
  const auto samples = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(volume.type)));
  // VTK only reads them (save = 1: it does not free them either).
  samples->SetVoidArray(const_cast<void*>(volume.samples), static_cast<vtkIdType>(nx * ny * nz), 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(static_cast<int>(nx), static_cast<int>(ny), static_cast<int>(nz));
  image->SetSpacing(spacing.x, spacing.y, spacing.z);
  image->GetPointData()->SetScalars(samples);
  vtkNew<vtkFlyingEdges3D> cubes;
  cubes->SetInputData(image);
  cubes->SetValue(0, isovalue);
  cubes->ComputeNormalsOff();
  cubes->ComputeScalarsOff();
  cubes->Update();

  vtkPolyData& surface = *cubes->GetOutput();
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<std::size_t>(surface.GetNumberOfPoints()));
  for (vtkIdType v = 0; v < surface.GetNumberOfPoints(); ++v) {
    Vec3& p = mesh.positions[static_cast<std::size_t>(v)];
    double at[3];
    surface.GetPoint(v, at);
    p = {at[0], at[1], at[2]};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return std::nullopt;
  }
  vtkCellArray& polygons = *surface.GetPolys();
  mesh.triangles.reserve(static_cast<std::size_t>(polygons.GetNumberOfCells()));
  for (vtkIdType t = 0; t < polygons.GetNumberOfCells(); ++t) {
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    polygons.GetCellAtId(t, count, corners);
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = static_cast<std::uint32_t>(corners[k]);
    mesh.triangles.push_back(triangle);
  }
  if (mesh.triangles.empty()) return std::nullopt;
  return mesh_quality(mesh);
}

}  // namespace isoatlas
