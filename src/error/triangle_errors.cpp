// SPDX-License-Identifier: Apache-2.0
#include "error/triangle_errors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/nearest_surfel.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kTrianglesPerPiece = 32;
constexpr std::array kFirstRadius{0.45, 1.0};  // of patches that are looked at, in voxels, per Look
constexpr double kSmallRadius = 0.05;          // of those for which the closest point is worth a search
constexpr double kLeastRadius = 5e-3;
constexpr double kFar = 2;                  // a distance, in voxels, beyond which the field along the way says nothing
constexpr std::size_t kMostGridCells = 27;  // that a patch may meet
constexpr double kRounding = 1e-6;          // of coordinates on the border, in grid cells
constexpr int kMostPieces = 64;             // of a patch's side
constexpr int kMostPiecesAgain = 4;         // once it was looked at

// A triangle a, a + u, a + v in the metric; no point of it is farther than `radius` from its centroid.
struct Patch {
  Vec3 a, u, v;
  double radius;
  Vec3 centroid() const { return a + (1.0 / 3) * (u + v); }
};

Patch whole(const std::array<Vec3, 3>& corners) {
  Patch out{corners[0], corners[1] - corners[0], corners[2] - corners[0], 0};
  for (const Vec3& corner : corners) out.radius = std::max(out.radius, length(corner - out.centroid()));
  return out;
}

// Branch and bound.
class PatchSearch {
 public:
  PatchSearch(const Isosurface& isosurface, double enough, Look look)
      : isosurface_(isosurface), spacing_(isosurface.spacing()), voxel_(isosurface.voxel()), enough_(enough), look_(look) {}

  void search(const std::array<Vec3, 3>& corners) {
    farthest_ = at_most_ = 0;
    patches_.assign(1, whole(corners));
    while (!patches_.empty()) {
      const Patch patch = patches_.back();
      patches_.pop_back();
      if (const int pieces = pieces_after_look(patch); pieces > 1) split(patch, pieces);
    }
  }

  double distance() const { return farthest_; }
  Vec3 point() const { return point_; }
  // No point that was looked at is farther. A proof ends where it fails.
  double at_most() const {
    if (look_ == Look::samples) return at_most_;
    return farthest_ > enough_ ? INFINITY : enough_;
  }

 private:
  // @return into how many pieces each side of a patch has to be cut; 1 if nothing more is to be known of it
  int pieces_after_look(const Patch& patch) {
    const double most = std::max(enough_, farthest_);
    const bool is_far = most > kFar * voxel_;
    const double first = is_far ? 0.5 * most : kFirstRadius[static_cast<std::size_t>(look_)] * voxel_;
    if (patch.radius > (1 + 1e-9) * first) return pieces_of(patch.radius / first, kMostPieces);
    // Once there is a point too far away, only larger distances at the centroids matter.
    const bool to_be_proved = look_ == Look::proof && farthest_ <= enough_;
    const Vec3 index = to_index(patch.centroid());
    if (to_be_proved && !is_far) {
      const double lacking = lacking_across(patch, most);
      if (lacking <= 1) return 1;
      if (std::isfinite(lacking) && patch.radius > kSmallRadius * voxel_) return pieces_of(lacking, kMostPiecesAgain);
    } else if (!is_far) {
      const double rough = isosurface_.rough_distance(index, cursor_);
      if (rough <= most) {
        at_most_ = std::max(at_most_, rough);
        return 1;
      }
    }
    const double d = isosurface_.distance(index, to_be_proved ? most - patch.radius : most);
    at_most_ = std::max(at_most_, d);
    if (d > farthest_) {
      farthest_ = d;
      point_ = patch.centroid();
    }
    if (!to_be_proved || d > enough_ || d + patch.radius <= enough_) return 1;
    if (patch.radius > kLeastRadius * voxel_)
      return pieces_of(patch.radius / std::max(enough_ - d, kLeastRadius * voxel_), kMostPiecesAgain);
    farthest_ = d + patch.radius;  // for all that is known
    return 1;
  }

  // Whether the isosurface is within `way` of each point of a patch.
  // @return how many times the patch is too large to say so; no more than 1: proved; infinity: not even the centroid is near enough
  double lacking_across(const Patch& patch, double way) const {
    const Vec3 index = to_index(patch.centroid());
    const InterpolatedField::Value here = isosurface_.field().at(index);
    const Vec3 slope = to_index(here.gradient);
    const double steepness = length(slope);
    if (!(steepness > 0) || !is_in_volume(patch)) return INFINITY;
    const Vec3 step = to_index((1 / steepness) * slope);
    double lacking = INFINITY;
    // First not much farther than needed, since other sheets may be near.
    const double offset = here.value / steepness, margin = std::min(way - std::abs(offset), patch.radius);
    if (margin > 0) lacking = lacking_between(patch, index, std::max(0.0, margin - offset) * step, std::min(0.0, -margin - offset) * step);
    if (lacking > 1) lacking = std::min(lacking, lacking_between(patch, index, way * step, -way * step));
    return lacking <= 1 ? lacking : std::min(lacking, lacking_around(patch, index, way));
  }

  // The same, around the point of the isosurface that is near the centroid.
  double lacking_around(const Patch& patch, Vec3 index, double way) const {
    const Isosurface::Hit foot = isosurface_.nearby(index, way);
    const double margin = std::min(way - foot.distance, patch.radius);
    if (!(margin > 0)) return INFINITY;
    const Vec3 down = to_index(margin * isosurface_.normal(foot.point)), move = foot.point - index;
    return lacking_between(patch, index, move - down, move + down);
  }

  // Outside, the field is that of the nearest point of the border, and a way is longer than it looks.
  bool is_in_volume(const Patch& patch) const {
    return std::ranges::all_of(std::array{patch.a, patch.a + patch.u, patch.a + patch.v}, [&](Vec3 p) {
      const Vec3 index = to_index(p);
      return length(isosurface_.field().clamped(index) - index) <= kRounding;
    });
  }

  // A patch that is moved up has to be inside, moved down it has to be outside: then there is isosurface on the way between, for each of
  // its points.
  double lacking_between(const Patch& patch, Vec3 index, Vec3 up, Vec3 down) const {
    const Vec3 inside = index + up, outside = index + down;
    const double high = isosurface_.field().at(inside).value, low = isosurface_.field().at(outside).value;
    if (!(high > 0 && low < 0)) return INFINITY;
    const Vec3 third = (1.0 / 3) * (patch.u + patch.v);
    const std::array<Vec3, 3> corner{to_index(-1 * third), to_index(patch.u - third), to_index(patch.v - third)};
    return std::max(most_fall(inside, corner, 1) / high, most_fall(outside, corner, -1) / -low);
  }

  // How much the field can fall (side 1) or rise (side -1) from a point to the corners of a triangle around it.
  double most_fall(Vec3 at, const std::array<Vec3, 3>& corner, double side) const {
    Vec3 low = corner[0], high = corner[0];
    for (const Vec3& c : corner) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
    }
    const auto range = isosurface_.field().gradient_range(at + low, at + high, kMostGridCells);
    if (!range) return std::numeric_limits<double>::max();
    double most = 0;
    for (const Vec3& c : corner) most = std::max(most, most_along(*range, -side * c));
    return most;
  }

  static double most_along(const InterpolatedField::Range& g, Vec3 way) {
    const auto most = [](double low, double high, double w) { return std::max(low * w, high * w); };
    return most(g.low.x, g.high.x, way.x) + most(g.low.y, g.high.y, way.y) + most(g.low.z, g.high.z, way.z);
  }

  static int pieces_of(double ratio, int most) { return std::clamp(static_cast<int>(std::ceil(std::min(ratio, 1e6))), 2, most); }

  void split(const Patch& patch, int pieces) {
    const double share = 1.0 / pieces;
    const Vec3 u = share * patch.u, v = share * patch.v;
    const double radius = share * patch.radius;
    for (int i = 0; i < pieces; ++i) {
      for (int j = 0; i + j < pieces; ++j) {
        const Vec3 a = patch.a + static_cast<double>(i) * u + static_cast<double>(j) * v;
        patches_.push_back({a, u, v, radius});
        if (i + j + 1 < pieces) patches_.push_back({a + u + v, -1 * u, -1 * v, radius});
      }
    }
  }

  Vec3 to_index(Vec3 p) const { return {p.x / spacing_.x, p.y / spacing_.y, p.z / spacing_.z}; }

  const Isosurface& isosurface_;
  Vec3 spacing_;
  double voxel_, enough_, farthest_ = 0, at_most_ = 0;
  Look look_;
  Vec3 point_;
  InterpolatedField::Cursor cursor_;
  std::vector<Patch> patches_;
};

TriangleError error_of(const MeasuredSurface& surface, const LevelMesh& mesh, std::uint32_t triangle, double enough, PatchSearch& search) {
  const std::array<Vec3, 3> corners = mesh.corners(triangle);
  search.search(corners);
  TriangleError out;
  out.at_most = search.at_most();
  if (search.distance() <= enough) return out;
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (squared_length(search.point() - corners[k]) < squared_length(search.point() - corners[nearest])) nearest = k;
  }
  out.cell = mesh.triangles[triangle][nearest];
  const CVertexId start = mesh.c_vertices_of.row(out.cell)[0];
  out.sample = {std::nextafter(static_cast<float>(search.distance()), INFINITY),
                walk_to_nearest(surface.surfels, surface.graph, start, search.point()).id};
  return out;
}

}  // namespace

// A hash of the corners and their cells: two different triangles have the same one with a chance of 2^-64.
std::uint64_t TriangleErrors::fingerprint(const LevelMesh& mesh, std::uint32_t triangle) {
  std::uint64_t out = 0;
  const auto add = [&](std::uint64_t bits) {
    out = (out ^ bits) * 0x9e3779b97f4a7c15u;
    out ^= out >> 32;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const CellId c = mesh.triangles[triangle][k];
    add(c + 1ull);
    for (const double x : {mesh.point[c].x, mesh.point[c].y, mesh.point[c].z}) add(std::bit_cast<std::uint64_t>(x));
  }
  return out;
}

const TriangleError* TriangleErrors::find(const LevelMesh& mesh, std::uint32_t triangle, double enough) const {
  const Known& known = known_[triangle];
  if (known.fingerprint != fingerprint(mesh, triangle)) return nullptr;
  const TriangleError& error = known.error;
  return error.at_most <= enough || (error.sample.at != kNone && static_cast<double>(error.sample.distance) > enough) ? &error : nullptr;
}

void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, double enough, Look look, std::vector<Farthest>& from_mesh, TriangleErrors* known) {
  std::vector<std::uint8_t> wanted(mesh.cell_count(), 0);
  for (const CellId c : cells) wanted[c] = 1;
  from_mesh.resize(mesh.cell_count());
  std::vector<std::uint32_t> triangles;
  for (const CellId c : cells) {
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      const auto& corner = mesh.triangles[t];  // listed by the first of its cells that is wanted
      if (c == (wanted[corner[0]] ? corner[0] : wanted[corner[1]] ? corner[1] : corner[2])) triangles.push_back(t);
    }
  }
  if (known != nullptr) known->make_room(mesh.triangles.size());
  std::vector<TriangleError> errors(triangles.size());
  for_each_piece_going_on(triangles.size(), kTrianglesPerPiece, surface.control, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    PatchSearch search(*surface.isosurface, enough, look);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t t = triangles[i];
      if (look == Look::proof) surface.check_cancelled();  // one triangle takes as long as a piece of samples
      const TriangleError* found = known != nullptr ? known->find(mesh, t, enough) : nullptr;
      errors[i] = found != nullptr ? *found : error_of(surface, mesh, t, enough, search);
      if (found == nullptr && known != nullptr) known->keep(mesh, t, errors[i]);
    }
  });
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Farthest& sample = errors[i].sample;
    if (sample.at == kNone) continue;
    const auto& corners = mesh.triangles[triangles[i]];
    // That of the sample's c-vertex, if the triangle has it.
    const CellId there = cell_of[sample.at];
    const CellId cell = std::ranges::find(corners, there) != corners.end() ? there : errors[i].cell;
    Farthest& most = from_mesh[cell];
    if (wanted[cell] && (sample.distance > most.distance || (sample.distance == most.distance && sample.at < most.at))) most = sample;
  }
}

}  // namespace isoatlas::detail
