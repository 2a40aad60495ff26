// SPDX-License-Identifier: Apache-2.0
// Marching cubes of the page has the triangles of VTK's.
#include <gtest/gtest.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "page/marching_cubes_mesh.h"
#include "page/page.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

/// The corners of a triangle from its smallest corner on, so that the order of two meshes and the
/// first corner of their triangles do not matter, but the orientation does.
Corners from_smallest(Corners corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

struct FloatVolume {
  std::vector<float> samples;
  VolumeView view;
};

// White noise has grid cells of all 256 cases.
FloatVolume noise(test::Size size) {
  test::Random random(11);
  FloatVolume out;
  for (std::size_t i = 0; i < size[0] * size[1] * size[2]; ++i)
    out.samples.push_back(static_cast<float>(random.between(-40, 40)) + 0.25F);
  out.view = VolumeView::of(out.samples, size);
  out.view.grid.spacing = {0.5, 1, 2};  // exact, so that both programs round in the same way
  return out;
}

std::vector<Corners> by_vtk(const FloatVolume& volume, double isovalue) {
  const Grid& grid = volume.view.grid;
  vtkNew<vtkFloatArray> samples;
  for (const float sample : volume.samples) samples->InsertNextValue(sample);
  vtkNew<vtkImageData> image;
  image->SetDimensions(static_cast<int>(grid.size[0]), static_cast<int>(grid.size[1]),
                       static_cast<int>(grid.size[2]));
  image->SetSpacing(grid.spacing.x, grid.spacing.y, grid.spacing.z);
  image->GetPointData()->SetScalars(samples);
  vtkNew<vtkMarchingCubes> cubes;
  cubes->SetInputData(image);
  cubes->SetValue(0, isovalue);
  cubes->ComputeNormalsOff();
  cubes->ComputeScalarsOff();
  cubes->Update();
  std::vector<Corners> triangles;
  vtkPolyData& surface = *cubes->GetOutput();
  for (vtkIdType t = 0; t < surface.GetNumberOfCells(); ++t) {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      double at[3];
      surface.GetPoint(surface.GetCell(t)->GetPointId(static_cast<int>(k)), at);
      for (std::size_t axis = 0; axis < 3; ++axis) corners[k][axis] = static_cast<float>(at[axis]);
    }
    triangles.push_back(from_smallest(corners));
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Corners> by_page(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const Triangle& t : mesh.triangles) {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 at = mesh.positions[t[k]];
      corners[k] = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
    }
    triangles.push_back(from_smallest(corners));
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST(PageMarchingCubesMesh, HasTheTrianglesOfVtk) {
  const FloatVolume volume = noise({17, 14, 12});
  const TriangleMesh mesh = page::marching_cubes_mesh(volume.view, 0);
  const std::vector<Corners> expected = by_vtk(volume, 0), found = by_page(mesh);
  ASSERT_GT(expected.size(), 5'000u);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t t = 0; t < found.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(found[t][k][axis], expected[t][k][axis], 1e-5F) << t;
  }
}

// One vertex per grid edge that the surface crosses: shared by all grid cells at the edge.
TEST(PageMarchingCubesMesh, SharesVertices) {
  const FloatVolume volume = noise({9, 8, 7});
  const TriangleMesh mesh = page::marching_cubes_mesh(volume.view, 0);
  std::size_t crossed = 0;
  const auto is_inside = [&](std::size_t x, std::size_t y, std::size_t z) {
    return volume.samples[x + 9 * (y + 8 * z)] >= 0;
  };
  for (std::size_t z = 0; z < 7; ++z)
    for (std::size_t y = 0; y < 8; ++y)
      for (std::size_t x = 0; x < 9; ++x) {
        const bool inside = is_inside(x, y, z);
        crossed += x < 8 && is_inside(x + 1, y, z) != inside;
        crossed += y < 7 && is_inside(x, y + 1, z) != inside;
        crossed += z < 6 && is_inside(x, y, z + 1) != inside;
      }
  EXPECT_EQ(mesh.positions.size(), crossed);
}

TEST(PageMarchingCubesMesh, IsAbsentNextToSamplesThatAreNotFinite) {
  FloatVolume volume = noise({6, 6, 6});
  ASSERT_TRUE(marching_cubes_quality(volume.view, 0));
  volume.samples[43] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(marching_cubes_quality(volume.view, 0));
}

}  // namespace
}  // namespace isoatlas::detail
