// SPDX-License-Identifier: Apache-2.0
#include "refine/error_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "mesh/closest_point.h"
#include "metrics/nearest_surfel.h"

namespace isoatlas {
namespace {

constexpr std::size_t kCellsPerPiece = 64;
constexpr std::size_t kFewCVertices = 12;  // of a cell, looked at first

// The triangles around a cell, those with a corner at it or at a neighbour of it, to be asked for closest points. Each has a ball
// around it, as seen from the cell's vertex, so that most triangles are passed over after one distance; flat arrays of float, so
// that a compiler does several at a time. Those of the cell itself come first, and often suffice.
class Ring {
 public:
  explicit Ring(const LevelMesh& mesh) : mesh_(mesh) {}

  void move_to(CellId cell) {
    const auto own = mesh_.triangles_of.row(cell);
    cell_ = cell;
    own_ = own.size();
    guess_ = 0;
    triangles_.assign(own.begin(), own.end());
    make_balls(0);
  }

  /// @param enough  a distance up to this need not be the smallest
  std::pair<std::uint32_t, TrianglePoint> closest(Vec3 p, double enough = 0) {
    // Points that follow each other are near each other: the last one's triangle is often right again.
    TrianglePoint found = look_at(guess_, p);
    const double squared_enough = enough * enough;
    if (found.squared_distance > squared_enough || enough == 0) {
      look_among(0, own_, p, found);
      if (found.squared_distance > squared_enough || enough == 0) {
        if (triangles_.size() == own_) add_neighbours();
        look_among(own_, triangles_.size(), p, found);
      }
    }
    return {triangles_[guess_], found};
  }

 private:
  static constexpr double kRounding = 1e-6;  // of float, with room to spare

  void add_neighbours() {
    for (std::size_t i = 0; i < own_; ++i) {
      for (const CellId neighbour : mesh_.triangles[triangles_[i]].cell) {
        if (neighbour == cell_) continue;
        const auto theirs = mesh_.triangles_of.row(neighbour);
        triangles_.insert(triangles_.end(), theirs.begin(), theirs.end());
      }
    }
    const auto others = triangles_.begin() + static_cast<std::ptrdiff_t>(own_);
    const auto is_own = [&](std::uint32_t t) { return std::find(triangles_.begin(), others, t) != others; };
    std::sort(others, triangles_.end());
    triangles_.erase(std::remove_if(others, std::unique(others, triangles_.end()), is_own), triangles_.end());
    make_balls(own_);
  }

  void make_balls(std::size_t from) {
    const std::size_t n = triangles_.size();
    for (auto* v : {&x_, &y_, &z_, &radius_, &gap_}) v->resize(n);
    for (std::size_t k = from; k < n; ++k) {
      const MeshTriangle& t = mesh_.triangles[triangles_[k]];
      const Vec3 centre = (1.0 / 3.0) * (t.corner[0] + t.corner[1] + t.corner[2]), seen = centre - mesh_.point[cell_];
      double squared = 0;
      for (const Vec3& p : t.corner) squared = std::max(squared, squared_length(p - centre));
      x_[k] = static_cast<float>(seen.x);
      y_[k] = static_cast<float>(seen.y);
      z_[k] = static_cast<float>(seen.z);
      radius_[k] = static_cast<float>(std::sqrt(squared) + kRounding * length(seen));
    }
  }

  // Takes a nearer one of [begin, end), if there is one.
  void look_among(std::size_t begin, std::size_t end, Vec3 p, TrianglePoint& found) {
    const Vec3 seen = p - mesh_.point[cell_];
    const auto px = static_cast<float>(seen.x), py = static_cast<float>(seen.y), pz = static_cast<float>(seen.z);
    const auto reach = [&] { return static_cast<float>(std::sqrt(found.squared_distance) + kRounding * length(seen)); };
    float within = reach();
    for (std::size_t k = begin; k < end; ++k) {
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz, far = within + radius_[k];
      gap_[k] = dx * dx + dy * dy + dz * dz - far * far;
    }
    for (std::size_t k = begin; k < end; ++k) {
      if (gap_[k] >= 0 || k == guess_) continue;
      const float dx = x_[k] - px, dy = y_[k] - py, dz = z_[k] - pz, far = within + radius_[k];
      if (dx * dx + dy * dy + dz * dz >= far * far) continue;  // nearer ones have been found since
      const TrianglePoint other = look_at(k, p);
      if (other.squared_distance >= found.squared_distance) continue;
      found = other;
      guess_ = k;
      within = reach();
    }
  }

  TrianglePoint look_at(std::size_t k, Vec3 p) const {
    const MeshTriangle& t = mesh_.triangles[triangles_[k]];
    return closest_on_triangle(p, t.corner[0], t.corner[1], t.corner[2]);
  }

  const LevelMesh& mesh_;
  CellId cell_ = 0;
  std::size_t own_ = 0, guess_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<float> x_, y_, z_, radius_, gap_;
};

}  // namespace

void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out) {
  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) first[i + 1] = first[i] + mesh.c_vertices_of.row(cells[i]).size();
  out.resize(first.back());
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
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
void look_between(const MeasuredSurface& surface, const BetweenPoints& between, const LevelMesh& mesh, CellId cell, double enough, Ring& ring,
                  Farthest& most) {
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

std::vector<Farthest> find_farthest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, double enough,
                                    Thoroughness thoroughness, const BetweenPoints* between) {
  std::vector<Farthest> out(cells.size());
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      const auto c_vertices = mesh.c_vertices_of.row(cells[i]);
      const auto look_at = [&](CVertexId v) {
        const auto d = static_cast<float>(std::sqrt(ring.closest(surface.found[v], enough).second.squared_distance));
        if (d > out[i].distance) out[i] = {d, v};
      };
      const std::size_t step = thoroughness == Thoroughness::exact ? 1 : std::max<std::size_t>(1, c_vertices.size() / kFewCVertices);
      for (std::size_t k = 0; k < c_vertices.size(); k += step) look_at(c_vertices[k]);
      if (out[i].distance > enough) continue;
      for (std::size_t k = 0; k < c_vertices.size(); ++k) {
        if (k % step != 0) look_at(c_vertices[k]);
      }
      if (between != nullptr && !(out[i].distance > enough)) look_between(surface, *between, mesh, cells[i], enough, ring, out[i]);
    }
  });
  return out;
}

std::vector<Farthest> measure_between(const MeasuredSurface& surface, const BetweenPoints& between, const LevelMesh& mesh,
                                      std::span<const CellId> cells, double enough, std::vector<Farthest> most) {
  most.resize(cells.size());
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    Ring ring(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      ring.move_to(cells[i]);
      look_between(surface, between, mesh, cells[i], enough, ring, most[i]);
    }
  });
  return most;
}

namespace {

void look_through(const Surfels& surfels, std::span<const CVertexId> c_vertices, Vec3 p, NearestSurfel& nearest) {
  for (const CVertexId v : c_vertices) {
    const double d = squared_length(surfels.point[v] - p);
    if (d < nearest.squared_distance) nearest = {v, d};
  }
}

// How far p is from the tangent plane of a c-vertex, as far as its surfel goes.
double from_surfel(const MeasuredSurface& surface, const NearestSurfel& nearest, Vec3 p) {
  const double height = dot(p - surface.surfels.point[nearest.id], surface.surfels.normal[nearest.id]);
  const double aside = std::sqrt(std::max(0.0, nearest.squared_distance - height * height));
  return std::hypot(height, std::max(0.0, aside - 0.6 * static_cast<double>(surface.reach[nearest.id])));
}

// How far `p` is from the isosurface. What is found at once is a point of it and bounds the distance from above; only where that is
// not within `enough` is it worth to look for one that is nearer.
double to_isosurface(const Isosurface& isosurface, Vec3 p, double c_vertex, double enough) {
  const double nearby = std::min(c_vertex, isosurface.nearby(p, enough).distance);
  return nearby <= enough ? nearby : std::min(nearby, isosurface.closest(p, nearby).distance);
}

constexpr int kMostPieces = 8;
constexpr double kSampleStep = 0.4;  // between samples of a triangle, in distances to farthest neighbours

// @param least  a smaller distance is not looked for
TriangleErrors::Error farthest_sample(const MeasuredSurface& surface, const LevelMesh& mesh, const MeshTriangle& t, double look_closer,
                                      float least) {
  TriangleErrors::Error worst{{least, kNone}, t.cell[0]};
  double longest = 0, reach = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, length(t.corner[k] - t.corner[(k + 1) % 3]));
    reach = std::max(reach, static_cast<double>(surface.reach[mesh.c_vertices_of.row(t.cell[k])[0]]));
  }
  const int pieces = std::clamp(2 * static_cast<int>(std::ceil(longest / (2 * kSampleStep * reach))), 2,
                                kMostPieces);  // even: error peaks at edge midpoints
  CVertexId last = mesh.c_vertices_of.row(*std::min_element(t.cell.begin(), t.cell.end()))[0];
  for (int a = 0; a <= pieces; ++a) {
    for (int j = 0; a + j <= pieces; ++j) {
      const int b = a % 2 == 0 ? j : pieces - a - j, c = pieces - a - b;  // to and fro
      const Vec3 p = (1.0 / pieces) * (static_cast<double>(a) * t.corner[0] + static_cast<double>(b) * t.corner[1] +
                                       static_cast<double>(c) * t.corner[2]);
      NearestSurfel nearest = walk_to_nearest(surface.surfels, surface.graph, last, p);
      last = nearest.id;
      // The surface is no farther than that c-vertex.
      const double known = static_cast<double>(worst.sample.distance);
      if (nearest.squared_distance <= known * known) continue;
      if (surface.isosurface == nullptr && nearest.squared_distance > look_closer * look_closer) {
        for (const CellId cell : t.cell) look_through(surface.surfels, mesh.c_vertices_of.row(cell), p, nearest);
      }
      double d = from_surfel(surface, nearest, p);
      // Where this says too little, the tangent plane may say too little as well.
      if (surface.isosurface != nullptr && nearest.squared_distance > look_closer * look_closer) {
        const Vec3 index{p.x / surface.spacing.x, p.y / surface.spacing.y, p.z / surface.spacing.z};
        d = to_isosurface(*surface.isosurface, index, std::sqrt(nearest.squared_distance), std::max(known, look_closer));
      }
      if (d > known) worst = {{static_cast<float>(d), nearest.id}, t.cell[a >= b && a >= c ? 0 : b >= c ? 1 : 2]};
    }
  }
  return worst;
}

}  // namespace

void TriangleErrors::prepare(std::size_t triangles, double look_closer) {
  if (look_closer != look_closer_) known_.clear();
  look_closer_ = look_closer;
  known_.resize(triangles);
}

const TriangleErrors::Error* TriangleErrors::find(std::uint32_t number, const MeshTriangle& triangle) const {
  const Known& known = known_[number];
  return known.cell == triangle.cell && known.corner == triangle.corner ? &known.error : nullptr;
}

void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, double look_closer, std::vector<Farthest>& from_mesh, TriangleErrors* known) {
  std::vector<std::uint8_t> wanted(mesh.cell_count(), 0);
  for (const CellId c : cells) wanted[c] = 1;
  from_mesh.resize(mesh.cell_count());
  std::vector<std::uint32_t> triangles;
  for (const CellId c : cells) {
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      const auto& corner = mesh.triangles[t].cell;  // listed by the first of its cells that is wanted
      if (c == (wanted[corner[0]] ? corner[0] : wanted[corner[1]] ? corner[1] : corner[2])) triangles.push_back(t);
    }
  }
  if (known != nullptr) known->prepare(mesh.triangles.size(), look_closer);
  std::vector<TriangleErrors::Error> errors(triangles.size());
  for_each_piece(triangles.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const MeshTriangle& t = mesh.triangles[triangles[i]];
      const TriangleErrors::Error* found = known != nullptr ? known->find(triangles[i], t) : nullptr;
      const float least = known != nullptr ? 0 : std::min({from_mesh[t.cell[0]].distance, from_mesh[t.cell[1]].distance, from_mesh[t.cell[2]].distance});
      errors[i] = found != nullptr ? *found : farthest_sample(surface, mesh, t, look_closer, least);
      if (found == nullptr && known != nullptr) known->keep(triangles[i], t, errors[i]);
    }
  });
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Farthest& sample = errors[i].sample;
    if (sample.at == kNone) continue;
    const auto& corners = mesh.triangles[triangles[i]].cell;
    // That of the sample's c-vertex, if the triangle has it.
    const CellId there = cell_of[sample.at];
    const CellId cell = std::ranges::find(corners, there) != corners.end() ? there : errors[i].cell;
    Farthest& most = from_mesh[cell];
    if (wanted[cell] && (sample.distance > most.distance || (sample.distance == most.distance && sample.at < most.at))) most = sample;
  }
}

}  // namespace isoatlas
