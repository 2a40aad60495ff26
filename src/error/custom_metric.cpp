// SPDX-License-Identifier: Apache-2.0
#include "error/custom_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "core/vector_math.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kMeasuredCellsPerChunk = 64;

}  // namespace

double custom_value(const CustomMetric& metric, const Surfels& surfels, const LevelMesh& mesh,
                    CellId cell) {
  const auto c_vertices = mesh.c_vertices_of.row(cell);
  std::vector<Vec3> points, normals;
  std::vector<double> areas;
  for (const CVertexId v : c_vertices) {
    points.push_back(surfels.point[v]);
    normals.push_back(surfels.normal[v]);
    areas.push_back(surfels.area[v]);
  }
  std::vector<std::array<Vec3, 3>> triangles;
  for (const std::uint32_t t : mesh.triangles_of.row(cell)) {
    std::array<Vec3, 3> corners = mesh.corners(t);
    const auto own = ranges::find(mesh.triangles[t], cell) - mesh.triangles[t].begin();
    std::rotate(corners.begin(), corners.begin() + own, corners.end());
    triangles.push_back(corners);
  }
  const double value =
      metric.value({mesh.point[cell], mesh.normal[cell], points, normals, areas, triangles});
  if (std::isnan(value))
    throw Error(ErrorCode::bad_argument, "the metric " + metric.name + " is not a number");
  return value;
}

double custom_maximum(const CustomMetric& metric, const Surfels& surfels, const LevelMesh& mesh) {
  std::vector<double> values(mesh.cell_count());
  for_each_index(values.size(), kMeasuredCellsPerChunk, [&](std::size_t c) {
    values[c] = custom_value(metric, surfels, mesh, static_cast<CellId>(c));
  });
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace isoatlas::detail

namespace isoatlas {

Constraint sized_by(std::function<double(Vec3)> longest_edge) {
  using namespace detail;
  require(static_cast<bool>(longest_edge), "the edge-length field has no function");
  const auto largest_ratio = [longest_edge = std::move(longest_edge)](const CellGeometry& cell) {
    double largest = 0;
    for (const std::array<Vec3, 3>& t : cell.triangles) {
      for (const Vec3& end : {t[1], t[2]}) {
        const double allowed = longest_edge(0.5 * (t[0] + end));
        if (!(allowed > 0))
          throw Error(ErrorCode::bad_argument, "the edge-length field is not positive everywhere");
        largest = std::max(largest, length(end - t[0]) / allowed);
      }
    }
    return largest;
  };
  return bounded("edge-length", largest_ratio, 1);
}

}  // namespace isoatlas
