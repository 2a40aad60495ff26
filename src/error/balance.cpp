// SPDX-License-Identifier: Apache-2.0
#include "error/balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr int kRounds = 2;  // closest points are recomputed in each
constexpr int kSweeps = 8;
constexpr double kMaxShareOfEdge =
    0.2;  // no vertex moves farther than this share of its shortest edge
constexpr double kMinCosine =
    0.25;  // damps the step where triangle and vertex normals differ strongly

}  // namespace

void balance(const MeasuredSurface& surface, std::span<const CellId> cells, LevelMesh& mesh,
             VertexPlacement& placement) {
  const std::uint32_t all = mesh.cell_count();
  std::vector<float>& normal_offset = placement.normal_offset;
  normal_offset.resize(all, 0);
  const auto anchor_point = [&](CellId c) { return placement.base_point(surface.surfels, c); };
  std::vector<std::uint8_t> listed(all, 0), movable(all, 0);
  for (const CellId c : cells) listed[c] = 1;
  for (const CellId c : cells) {
    bool is_inner = !surface.graph.on_boundary[placement.anchor[c]] && placement.is_movable(c);
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) is_inner = is_inner && listed[n];
    }
    movable[c] = is_inner;
  }
  std::vector<ClosestPoint> closest;
  std::vector<double> correction(all), weight(all);
  std::vector<float> max_offset(all, 0);
  for (const CellId c : cells) {
    double squared = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) {
        if (n != c) squared = std::min(squared, squared_length(anchor_point(c) - anchor_point(n)));
      }
    }
    max_offset[c] = static_cast<float>(kMaxShareOfEdge * std::sqrt(squared));
  }
  for (int round = 0; round < kRounds; ++round) {
    find_closest(surface, mesh, cells, closest);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (const CellId c : cells) correction[c] = weight[c] = 0;
      std::size_t i = 0;
      for (const CellId cell : cells) {
        for (const CVertexId v : mesh.c_vertices_of.row(cell)) {
          const ClosestPoint& p = closest[i++];
          const Triangle& t = mesh.triangles[p.triangle];
          const Vec3 normal = mesh.triangle_normal[p.triangle];
          double residual =
              0;  // summed by corner, so that the rounding of the weights has no effect
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 from = placement.point(surface.surfels, t[k]);
            residual +=
                static_cast<double>(p.weight[k]) * dot(normal, surface.surfels.point[v] - from);
          }
          for (std::size_t k = 0; k < 3; ++k) {
            const CellId c = t[k];
            if (!listed[c]) continue;
            const double cosine = dot(normal, mesh.normal[c]);
            const double w = static_cast<double>(surface.surfels.area[v] * p.weight[k]);
            correction[c] += w * cosine * residual;
            weight[c] += w * std::max(kMinCosine, cosine * cosine);
          }
        }
      }
      for (const CellId c : cells) {
        if (movable[c] && weight[c] > 0)
          normal_offset[c] =
              std::clamp(normal_offset[c] + static_cast<float>(correction[c] / weight[c]),
                         -max_offset[c], max_offset[c]);
      }
    }
    update_points(mesh, surface.surfels, cells, placement);
  }
}

}  // namespace isoatlas::detail
