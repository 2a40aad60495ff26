// SPDX-License-Identifier: Apache-2.0
// The isosurface at full resolution, the input of decimation, and its conversion.
#pragma once

#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <cstdint>

#include "../vtk_image.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail::bench {

inline vtkSmartPointer<vtkPolyData> flying_edges(const VolumeView& volume, double isovalue) {
  vtkNew<vtkFlyingEdges3D> filter;
  filter->SetInputData(vtk_image(volume));
  filter->SetValue(0, isovalue);
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  return filter->GetOutput();
}

inline TriangleMesh triangle_mesh(vtkPolyData* surface) {
  TriangleMesh mesh;
  mesh.positions.reserve(static_cast<std::size_t>(surface->GetNumberOfPoints()));
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    double p[3];
    surface->GetPoint(i, p);
    mesh.positions.push_back({p[0], p[1], p[2]});
  }
  mesh.triangles.reserve(static_cast<std::size_t>(surface->GetNumberOfPolys()));
  vtkNew<vtkIdList> corners;
  vtkCellArray* cells = surface->GetPolys();
  for (cells->InitTraversal(); cells->GetNextCell(corners) != 0;)
    mesh.triangles.push_back({static_cast<std::uint32_t>(corners->GetId(0)),
                              static_cast<std::uint32_t>(corners->GetId(1)),
                              static_cast<std::uint32_t>(corners->GetId(2))});
  return mesh;
}

}  // namespace isoatlas::detail::bench
