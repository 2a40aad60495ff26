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
#include "error/ring.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCellsPerPiece = 64;
constexpr std::size_t kFewCVertices = 12;  // of a cell, looked at first

}  // namespace

void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out) {
  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) first[i + 1] = first[i] + mesh.c_vertices_of.row(cells[i]).size();
  out.resize(first.back());
  for_each_piece_going_on(cells.size(), kCellsPerPiece, surface.control, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      std::size_t at = first[i];
      for (const CVertexId v : mesh.c_vertices_of.row(cells[i])) {
        const auto [triangle, p] = ring.closest(surface.found[v]);
        out[at++] = {triangle,
                     {static_cast<float>(p.weight[0]), static_cast<float>(p.weight[1]), static_cast<float>(p.weight[2])},
                     static_cast<float>(std::sqrt(p.squared_distance))};
      }
    }
  });
}

BetweenPoints::BetweenPoints(const SurfaceComplex& complex, const Isosurface& isosurface)
    : complex_(complex),
      isosurface_(isosurface),
      faces_of_(make_buckets(complex.c_vertex_count(),
                             [&](auto add) {
                               for (FaceId f = 0; f < complex.face_count(); ++f) add(complex.faces[f].corner[0], f);
                             })),
      points_(complex.face_count()),
      known_(complex.face_count(), 0) {}

namespace {

// The node of a face is on the grid edge around which the face's corners are, one in each of four cells.
std::optional<Vec3> node_of(const Face& face, const SurfaceComplex& complex, const Isosurface& isosurface) {
  std::array<double, 3> lowest, highest;
  lowest.fill(std::numeric_limits<double>::infinity());
  highest.fill(-std::numeric_limits<double>::infinity());
  for (int k = 0; k < face.size(); ++k) {
    const Vec3& p = complex.positions[face.corner[k]];
    const std::array<double, 3> at{p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      const double cell = at[a] == 0 ? -1 : std::floor(at[a]);  // on the border: in the layer around the volume
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

Vec3 BetweenPoints::point(FaceId f) const {
  if (!known_[f]) {
    const Face& face = complex_.faces[f];
    std::optional<Vec3> found = node_of(face, complex_, isosurface_);
    // What is in pieces has c-vertices where it stands out; looked for between them, the surface found could be another sheet.
    if (!found && !face.is_triangle()) {
      Vec3 sum;
      for (int k = 0; k < face.size(); ++k) sum = sum + complex_.positions[face.corner[k]];
      found = isosurface_.onto_surface((1.0 / face.size()) * sum);
    }
    points_[f] = scaled(found.value_or(complex_.positions[face.corner[0]]), complex_.spacing);
    known_[f] = 1;
  }
  return points_[f];
}

namespace {

// Points between the c-vertices of a cell that are farther than what is known.
// @param ring  at the cell
void look_between(const MeasuredSurface& surface, const BetweenPoints& between, const LevelMesh& mesh, CellId cell, double enough,
                  Ring& ring, Farthest& most) {
  for (const CVertexId v : mesh.c_vertices_of.row(cell)) {
    between.for_each_at(v, [&](Vec3 p, const Face& face) {
      const auto known = std::max(enough, static_cast<double>(most.distance));
      const auto d = static_cast<float>(std::sqrt(ring.closest(p, known).second.squared_distance));
      if (d <= most.distance) return;
      const auto from_vertex = [&](CVertexId c) { return squared_length(surface.surfels.point[c] - mesh.point[cell]); };
      const auto farther = [&](CVertexId a, CVertexId b) { return from_vertex(a) < from_vertex(b); };
      most = {d, *std::max_element(face.corner.begin(), face.corner.begin() + face.size(), farther)};
    });
  }
}

}  // namespace

std::vector<CellDistance> find_farthest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, double enough,
                                        Thoroughness thoroughness, const BetweenPoints* between) {
  std::vector<CellDistance> out(cells.size());
  for_each_piece_going_on(cells.size(), kCellsPerPiece, surface.control, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      Farthest most;
      const auto c_vertices = mesh.c_vertices_of.row(cells[i]);
      const auto look_at = [&](CVertexId v) {
        const auto d = static_cast<float>(std::sqrt(ring.closest(surface.found[v], enough).second.squared_distance));
        if (d > most.distance) most = {d, v};
      };
      const std::size_t step = thoroughness == Thoroughness::exact ? 1 : std::max<std::size_t>(1, c_vertices.size() / kFewCVertices);
      for (std::size_t k = 0; k < c_vertices.size(); k += step) look_at(c_vertices[k]);
      if (!(most.distance > enough)) {
        for (std::size_t k = 0; k < c_vertices.size(); ++k) {
          if (k % step != 0) look_at(c_vertices[k]);
        }
      }
      if (between != nullptr && !(most.distance > enough)) look_between(surface, *between, mesh, cells[i], enough, ring, most);
      out[i] = {most, !ring.has_neighbours()};
    }
  });
  return out;
}

std::vector<Farthest> measure_between(const MeasuredSurface& surface, const BetweenPoints& between, const LevelMesh& mesh,
                                      std::span<const CellId> cells, double enough, std::vector<Farthest> most) {
  most.resize(cells.size());
  for_each_piece_going_on(cells.size(), kCellsPerPiece, surface.control, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      look_between(surface, between, mesh, cells[i], enough, ring, most[i]);
    }
  });
  return most;
}

}  // namespace isoatlas::detail
