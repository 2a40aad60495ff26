// SPDX-License-Identifier: Apache-2.0
#include "error/error_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/two_ring.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCellsPerChunk = 64;
constexpr std::size_t kFewCVertices = 12;  // number of c-vertices of a cell that are tested first

}  // namespace

void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh,
                  std::span<const CellId> cells, std::vector<ClosestPoint>& out) {
  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
    first[i + 1] = first[i] + mesh.c_vertices_of.row(cells[i]).size();
  out.resize(first.back());
  for_each_chunk_reporting(
      cells.size(), kCellsPerChunk, surface.control, [&](std::size_t begin, std::size_t end) {
        surface.check_cancelled();
        TwoRing ring(mesh);
        for (std::size_t i = begin; i < end; ++i) {
          ring.set_cell(cells[i]);
          std::size_t at = first[i];
          for (const CVertexId v : mesh.c_vertices_of.row(cells[i])) {
            const auto [triangle, p] = ring.closest(surface.original_points[v]);
            out[at++] = {triangle,
                         {static_cast<float>(p.weight[0]), static_cast<float>(p.weight[1]),
                          static_cast<float>(p.weight[2])},
                         static_cast<float>(std::sqrt(p.squared_distance))};
          }
        }
      });
}

FaceNodes::FaceNodes(const SurfaceComplex& complex, const Isosurface& isosurface)
    : complex_(complex),
      isosurface_(isosurface),
      faces_of_(make_csr_adjacency(complex.c_vertex_count(),
                                   [&](auto add) {
                                     for (FaceId f = 0; f < complex.face_count(); ++f)
                                       add(complex.faces[f].corner[0], f);
                                   })),
      points_(complex.face_count()),
      is_known_(complex.face_count(), 0) {}

namespace {

// The node of a face is on the grid edge that the face goes around; its corners are in the four
// grid cells at that edge.
std::optional<Vec3> node_of(const Face& face, const SurfaceComplex& complex,
                            const Isosurface& isosurface) {
  std::array<double, 3> lowest, highest;
  lowest.fill(std::numeric_limits<double>::infinity());
  highest.fill(-std::numeric_limits<double>::infinity());
  for (int k = 0; k < face.size(); ++k) {
    const Vec3& p = complex.positions[face.corner[k]];
    const std::array<double, 3> at{p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      // a coordinate on the lower volume boundary counts as in the layer outside the volume
      const double cell = at[a] == 0 ? -1 : std::floor(at[a]);
      lowest[a] = std::min(lowest[a], cell);
      highest[a] = std::max(highest[a], cell);
    }
  }
  int axis = -1;
  for (int a = 0; a < 3; ++a) {
    if (lowest[a] != highest[a]) continue;
    if (axis >= 0) return std::nullopt;
    axis = a;
  }
  if (axis < 0 || lowest[axis] < 0) return std::nullopt;
  return isosurface.on_edge({highest[0], highest[1], highest[2]}, axis);
}

}  // namespace

Vec3 FaceNodes::point(FaceId f) const {
  if (!is_known_[f]) {
    const Face& face = complex_.faces[f];
    std::optional<Vec3> found = node_of(face, complex_, isosurface_);
    // Faces that were subdivided have c-vertices where the surface protrudes; a search between them
    // might find another sheet.
    if (!found && !face.is_triangle()) {
      Vec3 sum;
      for (int k = 0; k < face.size(); ++k) sum = sum + complex_.positions[face.corner[k]];
      found = isosurface_.onto_surface((1.0 / face.size()) * sum);
    }
    points_[f] = to_metric(found.value_or(complex_.positions[face.corner[0]]), complex_.spacing);
    is_known_[f] = 1;
  }
  return points_[f];
}

namespace {

// Updates `farthest` by the face nodes of a cell that are farther.
// @param ring  of the cell
void update_farthest_node(const MeasuredSurface& surface, const FaceNodes& face_nodes,
                          const LevelMesh& mesh, CellId cell, double exact_above, TwoRing& ring,
                          Farthest& farthest) {
  for (const CVertexId v : mesh.c_vertices_of.row(cell)) {
    face_nodes.for_each_at(v, [&](Vec3 p, const Face& face) {
      const auto known = std::max(exact_above, static_cast<double>(farthest.distance));
      const auto d = static_cast<float>(std::sqrt(ring.closest(p, known).second.squared_distance));
      if (d <= farthest.distance) return;
      const auto from_vertex = [&](CVertexId c) {
        return squared_length(surface.surfels.point[c] - mesh.point[cell]);
      };
      const auto is_nearer = [&](CVertexId a, CVertexId b) {
        return from_vertex(a) < from_vertex(b);
      };
      farthest = {
          d, *std::max_element(face.corner.begin(), face.corner.begin() + face.size(), is_nearer)};
    });
  }
}

}  // namespace

std::vector<CellDistance> find_farthest(const MeasuredSurface& surface, const LevelMesh& mesh,
                                        std::span<const CellId> cells, double exact_above,
                                        Thoroughness thoroughness, const FaceNodes* face_nodes) {
  std::vector<CellDistance> out(cells.size());
  for_each_chunk_reporting(
      cells.size(), kCellsPerChunk, surface.control, [&](std::size_t begin, std::size_t end) {
        surface.check_cancelled();
        TwoRing ring(mesh);
        for (std::size_t i = begin; i < end; ++i) {
          ring.set_cell(cells[i]);
          Farthest farthest;
          const auto c_vertices = mesh.c_vertices_of.row(cells[i]);
          const auto test = [&](CVertexId v) {
            const auto d = static_cast<float>(std::sqrt(
                ring.closest(surface.original_points[v], exact_above).second.squared_distance));
            if (d > farthest.distance) farthest = {d, v};
          };
          const std::size_t step =
              thoroughness == Thoroughness::exact
                  ? 1
                  : std::max<std::size_t>(1, c_vertices.size() / kFewCVertices);
          for (std::size_t k = 0; k < c_vertices.size(); k += step) test(c_vertices[k]);
          if (!(farthest.distance > exact_above)) {
            for (std::size_t k = 0; k < c_vertices.size(); ++k) {
              if (k % step != 0) test(c_vertices[k]);
            }
          }
          if (face_nodes != nullptr && !(farthest.distance > exact_above))
            update_farthest_node(surface, *face_nodes, mesh, cells[i], exact_above, ring, farthest);
          out[i] = {farthest, !ring.uses_neighbours()};
        }
      });
  return out;
}

std::vector<Farthest> measure_face_nodes(const MeasuredSurface& surface,
                                         const FaceNodes& face_nodes, const LevelMesh& mesh,
                                         std::span<const CellId> cells, double exact_above,
                                         std::vector<Farthest> farthest) {
  farthest.resize(cells.size());
  for_each_chunk_reporting(
      cells.size(), kCellsPerChunk, surface.control, [&](std::size_t begin, std::size_t end) {
        surface.check_cancelled();
        TwoRing ring(mesh);
        for (std::size_t i = begin; i < end; ++i) {
          ring.set_cell(cells[i]);
          update_farthest_node(surface, face_nodes, mesh, cells[i], exact_above, ring, farthest[i]);
        }
      });
  return farthest;
}

}  // namespace isoatlas::detail
