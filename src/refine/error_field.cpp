// SPDX-License-Identifier: Apache-2.0
#include "refine/error_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "mesh/closest_point.h"

namespace isoatlas {
namespace {

constexpr std::size_t kCellsPerPiece = 64;

// A ball around a triangle: lets most triangles be passed over with one distance.
struct Ball {
  Vec3 centre;
  double radius;
  std::uint32_t triangle;
};

Ball ball_around(const MeshTriangle& t, std::uint32_t id) {
  const Vec3 centre = (1.0 / 3.0) * (t.corner[0] + t.corner[1] + t.corner[2]);
  double squared = 0;
  for (const Vec3& p : t.corner) squared = std::max(squared, squared_length(p - centre));
  return {centre, std::sqrt(squared), id};
}

// The triangles with a corner at a cell or at a neighbour of it, those of the cell itself first.
void gather_ring(const LevelMesh& mesh, CellId cell, std::vector<std::uint32_t>& ids, std::vector<Ball>& ring) {
  ids.clear();
  const auto own = mesh.triangles_of.of(cell);
  ids.assign(own.begin(), own.end());
  for (const std::uint32_t t : own) {
    for (const CellId neighbour : mesh.triangles[t].cell) {
      if (neighbour == cell) continue;
      const auto theirs = mesh.triangles_of.of(neighbour);
      ids.insert(ids.end(), theirs.begin(), theirs.end());
    }
  }
  std::sort(ids.begin() + static_cast<std::ptrdiff_t>(own.size()), ids.end());
  ring.clear();
  const auto is_own = [&](std::uint32_t t) { return std::find(own.begin(), own.end(), t) != own.end(); };
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i >= own.size() && ((i > own.size() && ids[i] == ids[i - 1]) || is_own(ids[i]))) continue;
    ring.push_back(ball_around(mesh.triangles[ids[i]], ids[i]));
  }
}

// The triangles around a cell, to be asked for closest points.
class Ring {
 public:
  Ring(const LevelMesh& mesh) : mesh_(mesh) {}
  void move_to(CellId cell) {
    gather_ring(mesh_, cell, ids_, balls_);
    guess_ = 0;
  }
  // Points that follow each other are near each other: the last one's triangle is often right again.
  std::pair<std::uint32_t, TrianglePoint> closest(Vec3 p) {
    std::size_t best = guess_;
    TrianglePoint found = look_at(guess_, p);
    double within = std::sqrt(found.squared_distance);
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      const double far = within + balls_[k].radius;
      if (k == guess_ || squared_length(p - balls_[k].centre) >= far * far) continue;
      const TrianglePoint other = look_at(k, p);
      if (other.squared_distance >= found.squared_distance) continue;
      found = other;
      best = k;
      within = std::sqrt(found.squared_distance);
    }
    guess_ = best;
    return {balls_[best].triangle, found};
  }

 private:
  TrianglePoint look_at(std::size_t k, Vec3 p) const {
    const MeshTriangle& t = mesh_.triangles[balls_[k].triangle];
    return closest_on_triangle(p, t.corner[0], t.corner[1], t.corner[2]);
  }
  const LevelMesh& mesh_;
  std::vector<std::uint32_t> ids_;
  std::vector<Ball> balls_;
  std::size_t guess_ = 0;
};

}  // namespace

void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out) {
  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) first[i + 1] = first[i] + mesh.c_vertices_of.of(cells[i]).size();
  out.resize(first.back());
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      std::size_t at = first[i];
      for (const CVertexId v : mesh.c_vertices_of.of(cells[i])) {
        const auto [triangle, p] = ring.closest(surface.surfels.point[v]);
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

Vec3 BetweenPoints::point(std::uint32_t f) const {
  if (!known_[f]) {
    const Face& face = complex_.faces[f];
    Vec3 sum;
    for (int k = 0; k < face.size(); ++k) sum = sum + complex_.positions[face.corner[k]];
    const Vec3 middle = (1.0 / face.size()) * sum;
    points_[f] = scaled(isosurface_.onto_surface(middle).value_or(complex_.positions[face.corner[0]]), complex_.spacing);
    known_[f] = 1;
  }
  return points_[f];
}

std::vector<float> measure_between(const BetweenPoints& between, const LevelMesh& mesh, std::span<const CellId> cells) {
  std::vector<float> out(cells.size(), 0);
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      for (const CVertexId v : mesh.c_vertices_of.of(cells[i])) {
        between.for_each_at(
            v, [&](Vec3 p) { out[i] = std::max(out[i], static_cast<float>(std::sqrt(ring.closest(p).second.squared_distance))); });
      }
    }
  });
  return out;
}

namespace {

// How far p is from the surface near the c-vertices of some cells: from the tangent plane of the nearest one, as far as its
// surfel goes.
struct NearestSurfel {
  CVertexId at = kNone;
  double squared = std::numeric_limits<double>::infinity();
  void offer(const Surfels& surfels, std::span<const CVertexId> c_vertices, Vec3 p) {
    for (const CVertexId v : c_vertices) {
      const double d = squared_length(surfels.point[v] - p);
      if (d < squared) {
        squared = d;
        at = v;
      }
    }
  }
  // The nearest one may be of another cell than those asked: where cells are of few c-vertices, triangles reach beyond them.
  void walk(const MeasuredSurface& surface, Vec3 p) {
    for (CVertexId from = kNone; from != at;) {
      from = at;
      for (const CVertexGraph::Neighbour& n : surface.graph.row(from)) offer(surface.surfels, {&n.id, 1}, p);
    }
  }
  double distance(const MeasuredSurface& surface, Vec3 p) const {
    const double height = dot(p - surface.surfels.point[at], surface.surfels.normal[at]);
    const double aside = std::sqrt(std::max(0.0, squared - height * height));
    return std::hypot(height, std::max(0.0, aside - 0.6 * static_cast<double>(surface.reach[at])));
  }
};

constexpr int kMostPieces = 8;
constexpr double kSampleStep = 0.8;          // between samples of a triangle, in distances to farthest neighbours
constexpr std::size_t kManyCVertices = 400;  // more than these are slower to look through than the isosurface's tree

}  // namespace

void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, double look_closer, std::vector<float>& from_mesh) {
  std::vector<std::uint8_t> wanted(mesh.cell_count(), 0);
  for (const CellId c : cells) wanted[c] = 1;
  from_mesh.resize(mesh.cell_count(), 0);
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t].cell;
    if (wanted[c[0]] || wanted[c[1]] || wanted[c[2]]) triangles.push_back(t);
  }
  struct Worst {
    float distance;
    CellId cell;
  };
  std::vector<Worst> worst(triangles.size());
  for_each_piece(triangles.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const MeshTriangle& t = mesh.triangles[triangles[i]];
      worst[i] = {0, t.cell[0]};
      double longest = 0, reach = 0;
      std::size_t c_vertices = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, length(t.corner[k] - t.corner[(k + 1) % 3]));
        c_vertices += mesh.c_vertices_of.of(t.cell[k]).size();
        reach = std::max(reach, static_cast<double>(surface.reach[mesh.c_vertices_of.of(t.cell[k])[0]]));
      }
      const int pieces = std::clamp(2 * static_cast<int>(std::ceil(longest / (2 * kSampleStep * reach))), 2,
                                    kMostPieces);  // even: error peaks at edge midpoints
      for (int a = 0; a <= pieces; ++a) {
        for (int b = 0; a + b <= pieces; ++b) {
          const int c = pieces - a - b;
          const Vec3 p = (1.0 / pieces) * (static_cast<double>(a) * t.corner[0] + static_cast<double>(b) * t.corner[1] +
                                           static_cast<double>(c) * t.corner[2]);
          const double known = static_cast<double>(worst[i].distance);
          const Vec3 index{p.x / surface.spacing.x, p.y / surface.spacing.y, p.z / surface.spacing.z};
          double d;
          CellId cell;
          if (surface.isosurface != nullptr && c_vertices > kManyCVertices) {
            d = surface.isosurface->closest(index).distance;
            cell = t.cell[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
          } else {
            NearestSurfel nearest;
            for (const CellId corner : t.cell) nearest.offer(surface.surfels, mesh.c_vertices_of.of(corner), p);
            cell = cell_of[nearest.at];
            nearest.walk(surface, p);
            d = nearest.distance(surface, p);
            // No farther than that c-vertex; where this says too little, the tangent plane may say too little as well.
            if (surface.isosurface != nullptr && nearest.squared > look_closer * look_closer)
              d = surface.isosurface->closest(index).distance;
          }
          if (d > known) worst[i] = {static_cast<float>(d), cell};
        }
      }
    }
  });
  for (const CellId c : cells) from_mesh[c] = 0;
  for (const Worst& w : worst) {
    if (wanted[w.cell]) from_mesh[w.cell] = std::max(from_mesh[w.cell], w.distance);
  }
}

}  // namespace isoatlas
