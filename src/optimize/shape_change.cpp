// SPDX-License-Identifier: Apache-2.0
#include "optimize/shape_change.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/ranges.h"
#include "core/vector_math.h"
#include "optimize/face_direction.h"

namespace isoatlas::detail {
namespace {

constexpr double kMinNormalCosine =
    0.3;  // smallest cosine between normals before and after a change

// The score required after a change.
double required_score(double before, std::optional<double> min_gain) {
  return min_gain ? before + *min_gain : std::min(1.0, before);
}

Vec3 normal_of(Vec3 a, Vec3 b, Vec3 c) { return normalized(cross(b - a, c - a)); }

}  // namespace

double ShapeChanges::score(std::uint32_t triangle) const {
  const auto [a, b, c] = mesh_.mesh().corners(triangle);
  return goal_.score(a, b, c);
}

bool ShapeChanges::is_at_shared_face(std::uint32_t triangle) const {
  return ranges::any_of(mesh_.mesh().triangles[triangle], [&](CellId c) {
    return mesh_.surface_data().is_on_shared_face(mesh_.placement().anchor[c]);
  });
}

Vec3 ShapeChanges::face_direction_of(std::uint32_t triangle) const {
  const LevelMesh& mesh = mesh_.mesh();
  return face_direction(
      triangle, [&](std::uint32_t t) { return mesh.corners(t); },
      [&](auto add) {
        for (const CellId c : mesh.triangles[triangle]) {
          for (const std::uint32_t t : mesh.triangles_of.row(c)) add(t);
        }
      });
}

// The triangle across the edge from a to b, and its third corner.
std::pair<std::uint32_t, CellId> ShapeChanges::opposite(CellId a, CellId b) const {
  std::pair<std::uint32_t, CellId> out{kNone, kNone};
  for (const std::uint32_t t : mesh_.mesh().triangles_of.row(a)) {
    const auto& cell = mesh_.mesh().triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (cell[k] == b && cell[(k + 1) % 3] == a) out = {t, cell[(k + 2) % 3]};
    }
  }
  return out;
}

bool ShapeChanges::are_neighbours(CellId a, CellId b) const {
  return ranges::any_of(mesh_.mesh().triangles_of.row(a), [&](std::uint32_t t) {
    const auto& cell = mesh_.mesh().triangles[t];
    return cell[0] == b || cell[1] == b || cell[2] == b;
  });
}

bool ShapeChanges::could_be_on_closed_face(CellId a, CellId b) const {
  const AdaptiveSurface* const surface = mesh_.surface_data().adaptive_surface;
  const std::vector<CVertexId>& anchor = mesh_.placement().anchor;
  return surface != nullptr && surface->could_be_on_closed_face(anchor[a], anchor[b]);
}

void ShapeChanges::find_best_flip(std::uint32_t i, std::optional<double> min_gain,
                                  ShapeChange& best) const {
  const LevelMesh& mesh = mesh_.mesh();
  const Triangle& t = mesh.triangles[i];
  for (std::size_t k = 0; k < 3; ++k) {
    const CellId a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const auto [j, d] = opposite(a, b);
    if (j == kNone || !is_flippable(a) || !is_flippable(b) || !is_flippable(c) || !is_flippable(d))
      continue;
    if (mesh.triangles_of.row(a).size() <= 3 || mesh.triangles_of.row(b).size() <= 3 ||
        are_neighbours(c, d) || could_be_on_closed_face(c, d))
      continue;
    const Vec3 pa = mesh.point[a], pb = mesh.point[b], pc = mesh.point[c], pd = mesh.point[d];
    const double after = std::min(goal_.score(pa, pd, pc), goal_.score(pd, pb, pc));
    if (after < required_score(std::min(score(i), score(j)), min_gain) || after <= best.score)
      continue;
    const Vec3 n = normalized(face_direction_of(i) + face_direction_of(j));
    if (dot(n, normal_of(pa, pd, pc)) < kMinNormalCosine ||
        dot(n, normal_of(pd, pb, pc)) < kMinNormalCosine)
      continue;
    ShapeChange change;
    change.score = after;
    change.i = i;
    change.j = j;
    change.first = {{d, c, a}, mesh_.triangle(i).at};
    change.second = {{c, d, b}, mesh_.triangle(j).at};
    if (!is_rejected(change)) best = change;
  }
}

void ShapeChanges::find_best_move(CellId cell, std::optional<double> min_gain,
                                  ShapeChange& best) const {
  const LevelMesh& mesh = mesh_.mesh();
  const SurfaceData& surface_data = mesh_.surface_data();
  const CVertexId from = mesh_.placement().anchor[cell];
  if (mesh_.measured().has_fixed_anchor(cell) || !is_movable(cell) ||
      surface_data.graph.on_boundary[from])
    return;
  // A vertex near a shared face can have hundreds of triangles.
  if (ranges::any_of(mesh.triangles_of.row(cell),
                     [&](std::uint32_t t) { return is_at_shared_face(t); }))
    return;
  double before = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : mesh.triangles_of.row(cell)) before = std::min(before, score(t));
  const auto consider = [&](CVertexId to) {
    if (mesh_.is_occupied(to) || surface_data.graph.on_boundary[to] ||
        mesh_.measured().partition().cell_of[to] != cell)
      return;
    const Vec3 p = mesh.point[cell] + (surface_data.surfels.point[to] -
                                       mesh_.placement().base_point(surface_data.surfels, cell));
    double after = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : mesh.triangles_of.row(cell)) {
      std::array<Vec3, 3> q = mesh.corners(t);
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.triangles[t][k] == cell) q[k] = p;
      }
      if (dot(normal_of(q[0], q[1], q[2]), normalized(face_direction_of(t))) < kMinNormalCosine)
        return;
      after = std::min(after, goal_.score(q[0], q[1], q[2]));
    }
    if (after < required_score(before, min_gain) || after <= best.score) return;
    ShapeChange change;
    change.score = after;
    change.cell = cell;
    change.to = to;
    if (!is_rejected(change)) best = change;
  };
  for (const CVertexId v : mesh.c_vertices_of.row(cell)) consider(v);
}

ShapeChanges::Key ShapeChanges::key(const ShapeChange& c) {
  if (!c.is_flip()) return {static_cast<std::uint64_t>(c.cell) << 32 | kNone, c.to};
  return {static_cast<std::uint64_t>(std::min(c.first.cell[0], c.first.cell[1])) << 32 |
              std::max(c.first.cell[0], c.first.cell[1]),
          1ull << 40};
}

bool ShapeChanges::is_rejected(const ShapeChange& change) const {
  return std::binary_search(rejected_.begin(), rejected_.end(), key(change));
}

void ShapeChanges::sort_rejected() { std::sort(rejected_.begin(), rejected_.end()); }

}  // namespace isoatlas::detail
