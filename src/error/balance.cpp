// SPDX-License-Identifier: Apache-2.0
#include "error/balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr int kRounds = 2;  // closest points are looked up anew in each
constexpr int kSweeps = 8;
constexpr double kMostOfEdge = 0.2;  // no vertex goes farther than this share of its shortest edge
constexpr double kLeastLean = 0.25;  // where triangles stand steeply on the normal, go slowly

}  // namespace

void balance(const MeasuredSurface& surface, std::span<const CellId> cells, LevelMesh& mesh, VertexPlacement& places) {
  const std::uint32_t all = mesh.cell_count();
  std::vector<float>& offset = places.offset;
  offset.resize(all, 0);
  const auto anchor_point = [&](CellId c) { return places.base(surface.surfels, c); };
  std::vector<std::uint8_t> listed(all, 0), movable(all, 0);
  for (const CellId c : cells) listed[c] = 1;
  for (const CellId c : cells) {
    bool inner = !surface.graph.on_boundary[places.anchor[c]] && places.may_move(c);
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) inner = inner && listed[n];
    }
    movable[c] = inner;
  }
  std::vector<ClosestPoint> closest;
  std::vector<double> pull(all), weight(all);
  std::vector<float> most(all, 0);
  for (const CellId c : cells) {
    double squared = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) {
        if (n != c) squared = std::min(squared, squared_length(anchor_point(c) - anchor_point(n)));
      }
    }
    most[c] = static_cast<float>(kMostOfEdge * std::sqrt(squared));
  }
  for (int round = 0; round < kRounds; ++round) {
    find_closest(surface, mesh, cells, closest);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (const CellId c : cells) pull[c] = weight[c] = 0;
      std::size_t i = 0;
      for (const CellId cell : cells) {
        for (const CVertexId v : mesh.c_vertices_of.row(cell)) {
          const ClosestPoint& p = closest[i++];
          const Triangle& t = mesh.triangles[p.triangle];
          const Vec3 normal = mesh.triangle_normal[p.triangle];
          double residual = 0;  // corner by corner, so that the weights' rounding does not count
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 from = places.point(surface.surfels, t[k]);
            residual += static_cast<double>(p.weight[k]) * dot(normal, surface.surfels.point[v] - from);
          }
          for (std::size_t k = 0; k < 3; ++k) {
            const CellId c = t[k];
            if (!listed[c]) continue;
            const double lean = dot(normal, mesh.normal[c]);
            const double w = static_cast<double>(surface.surfels.area[v] * p.weight[k]);
            pull[c] += w * lean * residual;
            weight[c] += w * std::max(kLeastLean, lean * lean);
          }
        }
      }
      for (const CellId c : cells) {
        if (movable[c] && weight[c] > 0) offset[c] = std::clamp(offset[c] + static_cast<float>(pull[c] / weight[c]), -most[c], most[c]);
      }
    }
    place(mesh, surface.surfels, cells, places);
  }
}

}  // namespace isoatlas::detail
