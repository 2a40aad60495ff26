// SPDX-License-Identifier: Apache-2.0
#include "error/triangle_errors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/nearest_surfel.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kTrianglesPerChunk = 32;
constexpr std::array kFirstRadius{
    0.45, 1.0};  // largest radius of patches that are tested, in voxels, per kind of evidence
constexpr double kSmallRadius =
    0.05;  // below this radius a search for the closest point is worth its cost
constexpr double kMinRadius = 5e-3;
constexpr double kFarVoxels =
    2;  // in voxels; beyond this distance the field between has no significance
constexpr std::size_t kMaxGridCells = 27;   // that a patch may intersect
constexpr double kBoundaryRounding = 1e-6;  // of coordinates on the volume boundary, in grid cells
constexpr int kMaxParts = 64;               // of a patch's side, for the first subdivision
constexpr int kMaxPartsAfterTest = 4;       // once the patch was tested

// A metric triangle a, a + u, a + v; no point of it is farther than `radius` from its centroid.
struct Patch {
  Vec3 a, u, v;
  double radius;
  Vec3 centroid() const { return a + (1.0 / 3) * (u + v); }
};

Patch whole_triangle(const std::array<Vec3, 3>& corners) {
  Patch out{corners[0], corners[1] - corners[0], corners[2] - corners[0], 0};
  for (const Vec3& corner : corners)
    out.radius = std::max(out.radius, length(corner - out.centroid()));
  return out;
}

// Finds the largest distance of a triangle by branch and bound.
class PatchSearch {
 public:
  PatchSearch(const Isosurface& isosurface, double exact_above, Evidence evidence)
      : isosurface_(isosurface),
        spacing_(isosurface.spacing()),
        voxel_(isosurface.voxel()),
        exact_above_(exact_above),
        evidence_(evidence) {}

  void search(const std::array<Vec3, 3>& corners) {
    farthest_ = upper_bound_ = 0;
    patches_.assign(1, whole_triangle(corners));
    while (!patches_.empty()) {
      const Patch patch = patches_.back();
      patches_.pop_back();
      if (const int parts = measure_and_count_parts(patch); parts > 1) split(patch, parts);
    }
  }

  double distance() const { return farthest_; }
  Vec3 point() const { return point_; }
  // Upper bound for all tested points. A proof stops where it fails.
  double upper_bound() const {
    if (evidence_ == Evidence::samples) return upper_bound_;
    return farthest_ > exact_above_ ? INFINITY : exact_above_;
  }

 private:
  // @return into how many parts each side of a patch must be split; 1 if nothing more is needed
  int measure_and_count_parts(const Patch& patch) {
    const double largest = std::max(exact_above_, farthest_);
    const bool is_far = largest > kFarVoxels * voxel_;
    const double first =
        is_far ? 0.5 * largest : kFirstRadius[static_cast<std::size_t>(evidence_)] * voxel_;
    if (patch.radius > (1 + 1e-9) * first) return parts_of(patch.radius / first, kMaxParts);
    // Once a point is too far away, only larger distances at the centroids matter.
    const bool needs_proof = evidence_ == Evidence::proof && farthest_ <= exact_above_;
    const Vec3 index = to_index(patch.centroid());
    if (needs_proof && !is_far) {
      const double ratio = proof_ratio(patch, largest);
      if (ratio <= 1) return 1;
      if (std::isfinite(ratio) && patch.radius > kSmallRadius * voxel_)
        return parts_of(ratio, kMaxPartsAfterTest);
    } else if (!is_far) {
      const double rough = isosurface_.distance_upper_bound(index, cursor_);
      if (rough <= largest) {
        upper_bound_ = std::max(upper_bound_, rough);
        return 1;
      }
    }
    const double d = isosurface_.distance(index, needs_proof ? largest - patch.radius : largest);
    upper_bound_ = std::max(upper_bound_, d);
    if (d > farthest_) {
      farthest_ = d;
      point_ = patch.centroid();
    }
    if (!needs_proof || d > exact_above_ || d + patch.radius <= exact_above_) return 1;
    if (patch.radius > kMinRadius * voxel_)
      return parts_of(patch.radius / std::max(exact_above_ - d, kMinRadius * voxel_),
                      kMaxPartsAfterTest);
    farthest_ = d + patch.radius;  // an upper bound, since the exact value is not known
    return 1;
  }

  // Whether the isosurface is within `reach` of each point of a patch.
  // @return the size of the patch relative to the largest one that could be proved; at most 1:
  //         proved; infinity: not even the centroid is near enough
  double proof_ratio(const Patch& patch, double reach) const {
    const Vec3 index = to_index(patch.centroid());
    const InterpolatedField::Value here = isosurface_.field().at(index);
    const Vec3 slope = to_index(here.gradient);
    const double steepness = length(slope);
    if (!(steepness > 0) || !is_in_volume(patch)) return INFINITY;
    const Vec3 step = to_index((1 / steepness) * slope);
    double ratio = INFINITY;
    // First try a distance little larger than necessary, since other sheets may be near.
    const double normal_offset = here.value / steepness,
                 margin = std::min(reach - std::abs(normal_offset), patch.radius);
    if (margin > 0)
      ratio = proof_ratio_between(patch, index, std::max(0.0, margin - normal_offset) * step,
                                  std::min(0.0, -margin - normal_offset) * step);
    if (ratio > 1)
      ratio = std::min(ratio, proof_ratio_between(patch, index, reach * step, -reach * step));
    return ratio <= 1 ? ratio : std::min(ratio, proof_ratio_near_surface(patch, index, reach));
  }

  // The same, relative to the point of the isosurface that is near the centroid.
  double proof_ratio_near_surface(const Patch& patch, Vec3 index, double reach) const {
    const Isosurface::Hit foot = isosurface_.find_nearby(index, reach);
    const double margin = std::min(reach - foot.distance, patch.radius);
    if (!(margin > 0)) return INFINITY;
    const Vec3 down = to_index(margin * isosurface_.normal(foot.point)), move = foot.point - index;
    return proof_ratio_between(patch, index, move - down, move + down);
  }

  // Outside the volume the field is that of the nearest point on the volume boundary, so
  // that distances would be underestimated.
  bool is_in_volume(const Patch& patch) const {
    return ranges::all_of(std::array{patch.a, patch.a + patch.u, patch.a + patch.v}, [&](Vec3 p) {
      const Vec3 index = to_index(p);
      return length(isosurface_.field().clamped(index) - index) <= kBoundaryRounding;
    });
  }

  // If the patch moved up is inside and the patch moved down is outside, then the isosurface lies
  // between for each of its points.
  double proof_ratio_between(const Patch& patch, Vec3 index, Vec3 up, Vec3 down) const {
    const Vec3 inside = index + up, outside = index + down;
    const double high = isosurface_.field().at(inside).value,
                 low = isosurface_.field().at(outside).value;
    if (!(high > 0 && low < 0)) return INFINITY;
    const Vec3 third = (1.0 / 3) * (patch.u + patch.v);
    const std::array<Vec3, 3> corner{to_index(-1 * third), to_index(patch.u - third),
                                     to_index(patch.v - third)};
    return std::max(max_decrease(inside, corner, 1) / high,
                    max_decrease(outside, corner, -1) / -low);
  }

  // How much the field can decrease (side 1) or increase (side -1) from a point to the corners of a
  // triangle around it.
  double max_decrease(Vec3 at, const std::array<Vec3, 3>& corner, double side) const {
    Vec3 low = corner[0], high = corner[0];
    for (const Vec3& c : corner) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
    }
    const auto range = isosurface_.field().gradient_range(at + low, at + high, kMaxGridCells);
    if (!range) return std::numeric_limits<double>::max();
    double largest = 0;
    for (const Vec3& c : corner) largest = std::max(largest, max_along(*range, -side * c));
    return largest;
  }

  static double max_along(const InterpolatedField::Range& g, Vec3 reach) {
    const auto largest = [](double low, double high, double w) {
      return std::max(low * w, high * w);
    };
    return largest(g.low.x, g.high.x, reach.x) + largest(g.low.y, g.high.y, reach.y) +
           largest(g.low.z, g.high.z, reach.z);
  }

  static int parts_of(double ratio, int largest) {
    return std::clamp(static_cast<int>(std::ceil(std::min(ratio, 1e6))), 2, largest);
  }

  void split(const Patch& patch, int parts) {
    const double share = 1.0 / parts;
    const Vec3 u = share * patch.u, v = share * patch.v;
    const double radius = share * patch.radius;
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        const Vec3 a = patch.a + static_cast<double>(i) * u + static_cast<double>(j) * v;
        patches_.push_back({a, u, v, radius});
        if (i + j + 1 < parts) patches_.push_back({a + u + v, -1 * u, -1 * v, radius});
      }
    }
  }

  Vec3 to_index(Vec3 p) const { return {p.x / spacing_.x, p.y / spacing_.y, p.z / spacing_.z}; }

  const Isosurface& isosurface_;
  Vec3 spacing_;
  double voxel_, exact_above_, farthest_ = 0, upper_bound_ = 0;
  Evidence evidence_;
  Vec3 point_;
  InterpolatedField::Cursor cursor_;
  std::vector<Patch> patches_;
};

TriangleError measure_triangle(const MeasuredSurface& surface, const LevelMesh& mesh,
                               std::uint32_t triangle, double exact_above, PatchSearch& search) {
  const std::array<Vec3, 3> corners = mesh.corners(triangle);
  search.search(corners);
  TriangleError out;
  out.upper_bound = search.upper_bound();
  if (search.distance() <= exact_above) return out;
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (squared_length(search.point() - corners[k]) <
        squared_length(search.point() - corners[nearest]))
      nearest = k;
  }
  out.cell = mesh.triangles[triangle][nearest];
  const CVertexId start = mesh.c_vertices_of.row(out.cell)[0];
  out.sample = {std::nextafter(static_cast<float>(search.distance()), INFINITY),
                walk_to_nearest(surface.surfels, surface.graph, start, search.point()).id};
  return out;
}

}  // namespace

TriangleDistance triangle_distance(const Isosurface& isosurface, const std::array<Vec3, 3>& corners,
                                   double exact_above, Evidence evidence) {
  PatchSearch search(isosurface, exact_above, evidence);
  search.search(corners);
  return {search.distance(), search.upper_bound()};
}

// A hash of the corners and their cells: two different triangles have the same one with probability
// 2^-64.
std::uint64_t TriangleErrorCache::fingerprint(const LevelMesh& mesh, std::uint32_t triangle) {
  std::uint64_t out = 0;
  const auto add = [&](std::uint64_t bits) {
    out = (out ^ bits) * 0x9e3779b97f4a7c15u;
    out ^= out >> 32;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const CellId c = mesh.triangles[triangle][k];
    add(c + 1ull);
    for (const double x : {mesh.point[c].x, mesh.point[c].y, mesh.point[c].z})
      add(std::bit_cast<std::uint64_t>(x));
  }
  return out;
}

const TriangleError* TriangleErrorCache::find(const LevelMesh& mesh, std::uint32_t triangle,
                                              double exact_above) const {
  const Entry& cache = entries_[triangle];
  if (cache.fingerprint != fingerprint(mesh, triangle)) return nullptr;
  const TriangleError& error = cache.error;
  return error.upper_bound <= exact_above ||
                 (error.sample.at != kNone &&
                  static_cast<double>(error.sample.distance) > exact_above)
             ? &error
             : nullptr;
}

void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh,
                       std::span<const CellId> cell_of, std::span<const CellId> cells,
                       double exact_above, Evidence evidence, std::vector<Farthest>& from_mesh,
                       TriangleErrorCache* cache) {
  std::vector<std::uint8_t> wanted(mesh.cell_count(), 0);
  for (const CellId c : cells) wanted[c] = 1;
  from_mesh.resize(mesh.cell_count());
  std::vector<std::uint32_t> triangles;
  for (const CellId c : cells) {
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      const auto& corner =
          mesh.triangles[t];  // each triangle is listed once, by its first corner that is wanted
      if (c == (wanted[corner[0]] ? corner[0] : wanted[corner[1]] ? corner[1] : corner[2]))
        triangles.push_back(t);
    }
  }
  if (cache != nullptr) cache->resize(mesh.triangles.size());
  std::vector<TriangleError> errors(triangles.size());
  for_each_chunk_reporting(
      triangles.size(), kTrianglesPerChunk, surface.control,
      [&](std::size_t begin, std::size_t end) {
        surface.check_cancelled();
        PatchSearch search(*surface.isosurface, exact_above, evidence);
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t t = triangles[i];
          if (evidence == Evidence::proof)
            surface
                .check_cancelled();  // proving one triangle takes as long as sampling a whole chunk
          const TriangleError* found =
              cache != nullptr ? cache->find(mesh, t, exact_above) : nullptr;
          errors[i] =
              found != nullptr ? *found : measure_triangle(surface, mesh, t, exact_above, search);
          if (found == nullptr && cache != nullptr) cache->store(mesh, t, errors[i]);
        }
      });
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Farthest& sample = errors[i].sample;
    if (sample.at == kNone) continue;
    const auto& corners = mesh.triangles[triangles[i]];
    // The cell of the sample's c-vertex, if the triangle has a corner there.
    const CellId there = cell_of[sample.at];
    const CellId cell = ranges::find(corners, there) != corners.end() ? there : errors[i].cell;
    Farthest& largest = from_mesh[cell];
    if (wanted[cell] && (sample.distance > largest.distance ||
                         (sample.distance == largest.distance && sample.at < largest.at)))
      largest = sample;
  }
}

}  // namespace isoatlas::detail
