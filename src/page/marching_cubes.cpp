// SPDX-License-Identifier: Apache-2.0
// Marching cubes by VTK, for comparison.
#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/vector_math.h"
#include "field/to_space.h"
#include "page/page.h"

namespace isoatlas::detail {
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

// For each point the nearest vertex of the marching cubes surface (ties: the first one). It is
// nearly always in the grid cell of the point.
std::vector<std::uint32_t> nearest_vertices(std::span<const Vec3> vertices,
                                            std::span<const Vec3> points) {
  const auto cell_of = [](Vec3 p) {
    const auto below = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    return std::array{below(p.x), below(p.y), below(p.z)};
  };
  std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> points_in;
  for (std::size_t i = 0; i < points.size(); ++i) points_in[cell_of(points[i])].push_back(i);
  std::vector<std::uint32_t> nearest(points.size(), 0);
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  const auto compare = [&](std::size_t i, std::uint32_t v) {
    const double d = length(vertices[v] - points[i]);
    if (d < distance[i]) distance[i] = d, nearest[i] = v;
  };
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    // Its own grid cell and those below it along any axes: a vertex is on an edge of up to four.
    for (unsigned k = 0; k < 8; ++k) {
      auto cell = cell_of(vertices[v]);
      for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] -= k >> axis & 1U;
      const auto found = points_in.find(cell);
      if (found == points_in.end()) continue;
      for (const std::size_t i : found->second) compare(i, v);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t v = 0; distance[i] > 2 && v < vertices.size(); ++v) compare(i, v);
  }
  return nearest;
}

void keep_components_at(TriangleMesh& mesh, std::span<const Vec3> points, Vec3 spacing) {
  if (mesh.positions.empty()) return;
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  std::vector<Vec3> index;
  for (const Vec3& p : mesh.positions)
    index.push_back({p.x / spacing.x, p.y / spacing.y, p.z / spacing.z});
  std::vector<std::uint8_t> is_kept(mesh.positions.size(), 0);
  for (const std::uint32_t v : nearest_vertices(index, points)) is_kept[sets.find(v)] = 1;
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return is_kept[sets.find(t[0])] == 0; });
}

}  // namespace

std::vector<Vec3> to_index(std::vector<Vec3> positions, const Grid& grid, Space space) {
  for (Vec3& p : positions) p = from_space(grid, space, p);
  return positions;
}

std::optional<MeshQuality> marching_cubes_quality(const VolumeView& volume, double isovalue,
                                                  std::span<const Vec3> of) {
  const auto& [nx, ny, nz] = volume.grid.size;
  const Vec3 spacing = volume.grid.spacing;
  const auto samples =
      vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(volume.type)));
  // VTK only reads the samples; with save = 1 it does not free them.
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
  if (!of.empty()) keep_components_at(mesh, of, spacing);
  if (mesh.triangles.empty()) return std::nullopt;
  return mesh_quality(mesh);
}

}  // namespace isoatlas::detail
