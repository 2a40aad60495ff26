// SPDX-License-Identifier: Apache-2.0
// VTK reads what isoatlas writes as VTK XML poly data.
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <random>

#include "isoatlas/io.h"
#include "mesh_files/formats.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

struct Written {
  TriangleMesh mesh;
  std::vector<float> distance;
  std::size_t caps = 0;
};

Written random_mesh(std::size_t vertices, std::size_t triangles, std::size_t caps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1e3, 1e3);
  Written out;
  out.caps = caps;
  for (std::size_t v = 0; v < vertices; ++v) {
    out.mesh.positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
    out.distance.push_back(static_cast<float>(v) / 3);
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto corner = [&](std::size_t k) {
      return static_cast<std::uint32_t>((t + k * (1 + random() % 7)) % vertices);
    };
    out.mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  return out;
}

std::string field(vtkPolyData& data, const char* name) {
  auto* const array = vtkStringArray::SafeDownCast(data.GetFieldData()->GetAbstractArray(name));
  return array == nullptr || array->GetNumberOfValues() != 1 ? "?" : array->GetValue(0);
}

void expect_same(const Written& written, vtkPolyData& data) {
  const TriangleMesh& mesh = written.mesh;
  ASSERT_EQ(static_cast<std::size_t>(data.GetNumberOfPoints()), mesh.positions.size());
  ASSERT_EQ(static_cast<std::size_t>(data.GetNumberOfPolys()), mesh.triangles.size());
  ASSERT_EQ(data.GetNumberOfCells(), data.GetNumberOfPolys());
  vtkDataArray* const distance = data.GetPointData()->GetArray("max_distance");
  ASSERT_NE(distance, nullptr);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double* const point = data.GetPoint(static_cast<vtkIdType>(v));
    ASSERT_EQ(mesh.positions[v], (Vec3{point[0], point[1], point[2]}));
    ASSERT_EQ(distance->GetComponent(static_cast<vtkIdType>(v), 0), written.distance[v]);
  }
  vtkDataArray* const caps = data.GetCellData()->GetArray("cap");
  ASSERT_EQ(caps != nullptr, written.caps > 0);
  vtkNew<vtkIdList> corners;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    data.GetPolys()->GetCellAtId(static_cast<vtkIdType>(t), corners);
    ASSERT_EQ(corners->GetNumberOfIds(), 3);
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(corners->GetId(static_cast<vtkIdType>(k)), mesh.triangles[t][k]);
    const bool is_cap = t >= mesh.triangles.size() - written.caps;
    if (caps != nullptr) {
      ASSERT_EQ(caps->GetComponent(static_cast<vtkIdType>(t), 0), is_cap);
    }
  }
}

// Sizes below, at and above one block of compressed bytes (32 KiB).
TEST(WriteVtp, VtkReadsTheSameMesh) {
  const Written meshes[] = {random_mesh(3, 1, 0), random_mesh(1000, 2000, 17),
                            random_mesh(4096, 4096, 4096), random_mesh(50'000, 90'000, 1)};
  for (const Written& written : meshes) {
    SCOPED_TRACE(written.mesh.triangles.size());
    const TempFolder folder;
    io::AtomicFile file(folder / "a.vtp");
    io::write_vtp(written.mesh, {{"SPACE", "RAS"}, {"COMMENT", "a < b & \"c\""}, {"EMPTY", ""}},
                  written.distance, written.caps, file);
    file.commit();
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder / "a.vtp").c_str());
    reader->Update();
    ASSERT_EQ(reader->GetErrorCode(), 0U);
    expect_same(written, *reader->GetOutput());
    EXPECT_EQ(field(*reader->GetOutput(), "SPACE"), "RAS");
    EXPECT_EQ(field(*reader->GetOutput(), "COMMENT"), "a < b & \"c\"");
    EXPECT_EQ(reader->GetOutput()->GetFieldData()->GetAbstractArray("EMPTY"), nullptr);
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
