// SPDX-License-Identifier: Apache-2.0
#include "simplify/nearby_isosurface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/sort_once.h"
#include "error/clipped_box.h"
#include "geometry/closest_point.h"
#include "geometry/triangle_bvh.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCellsPerChunk = 64;

// The triangles with a corner at a vertex of these triangles, sorted.
std::vector<std::uint32_t> one_ring(const CollapsingMesh& mesh,
                                    std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> vertices, out;
  for (const std::uint32_t t : triangles)
    vertices.insert(vertices.end(), mesh.triangle(t).begin(), mesh.triangle(t).end());
  sort_unique_ids(vertices);
  for (const std::uint32_t v : vertices)
    out.insert(out.end(), mesh.star(v).begin(), mesh.star(v).end());
  sort_unique_ids(out);
  return out;
}

double squared_distance(Vec3 p, const std::array<Vec3, 3>& triangle) {
  return closest_on_triangle(p, triangle[0], triangle[1], triangle[2]).squared_distance;
}

// A convex body that contains a part of the isosurface, metric.
struct Part {
  std::span<const Vec3> corners;
  Vec3 centre;
  double radius;

  bool is_within(double bound, const std::array<Vec3, 3>& triangle) const {
    return ranges::all_of(corners,
                          [&](Vec3 p) { return squared_distance(p, triangle) <= bound * bound; });
  }
};

// Calls is_near(part) for parts of the isosurface in a grid cell; where it is false, for eight
// smaller parts. Calls failed(part) where it is false for a smallest part, and returns if that is
// false.
template <class IsNear, class Failed>
void for_each_part(const TrilinearCell& field, Vec3 low, Vec3 spacing, Vec3 origin, IsNear is_near,
                   Failed failed) {
  std::vector<GridCellBox> boxes{{{}, 1}};
  ClippedBox clipped;
  std::vector<Vec3> corners;
  while (!boxes.empty()) {
    const GridCellBox box = boxes.back();
    boxes.pop_back();
    if (!clipped.cut(field, box)) continue;
    clipped.convert_to_metric(low, spacing);
    corners.clear();
    for (const Vec3& p : clipped.corners()) corners.push_back(p + origin);
    const Vec3 local = clipped.centre();
    const Part part{corners, local + origin, clipped.radius(local)};
    if (is_near(part)) continue;
    if (box.size > kMinBoxSize) {
      for (std::size_t k = 0; k < 8; ++k) boxes.push_back(box.part(k));
    } else if (!failed(part)) {
      return;
    }
  }
}

}  // namespace

NearbyIsosurface::NearbyIsosurface(const CollapsingMesh& mesh, const Window& window,
                                   std::span<const std::uint32_t> region, double bound,
                                   const RunControl& control)
    : mesh_(mesh),
      isosurface_(window.isosurface),
      spacing_(window.isosurface.spacing()),
      origin_(to_metric(window.first, spacing_)),
      region_(region),
      bound_(bound),
      index_(window.complex, window.isosurface.field().last(), &control),
      complex_(window.complex),
      cells_of_(region.size()),
      is_fixed_(region.size(), 0) {
  prove_all(control);
}

std::size_t NearbyIsosurface::number_of(std::uint32_t triangle) const {
  return static_cast<std::size_t>(ranges::lower_bound(region_, triangle) - region_.begin());
}

bool NearbyIsosurface::is_in_region(std::uint32_t triangle) const {
  const std::size_t i = number_of(triangle);
  return i < region_.size() && region_[i] == triangle;
}

std::array<Vec3, 3> NearbyIsosurface::corners(const Triangle& t) const {
  return {mesh_.point(t[0]), mesh_.point(t[1]), mesh_.point(t[2])};
}

// The first proofs, with the nearest triangles of the region and around it. Where that fails, the
// triangles of the region that are near are fixed: perhaps others prove it together with them.
void NearbyIsosurface::prove_all(const RunControl& control) {
  const std::vector<std::uint32_t> around = one_ring(mesh_, one_ring(mesh_, region_));
  std::vector<Triangle> triangles;
  std::vector<Vec3> points;
  for (const std::uint32_t t : around) {
    const auto first = static_cast<std::uint32_t>(points.size());
    triangles.push_back({first, first + 1, first + 2});
    for (const Vec3& p : corners(mesh_.triangle(t))) points.push_back(p);
  }
  const TriangleBvh bvh(std::move(points), triangles, control);
  const std::vector<GridCellIndex::Key> keys = index_.cells();
  struct Found {
    std::vector<std::uint32_t> proof, near_failure;
  };
  std::vector<Found> found(keys.size());
  const double cell_radius = 0.5 * length(spacing_);
  for_each_index(keys.size(), kCellsPerChunk, &control, [&](std::size_t i) {
    const Vec3 low = index_.low(keys[i]);
    const Vec3 centre = to_metric(low + Vec3{0.5, 0.5, 0.5}, spacing_) + origin_;
    if (!bvh.closest(centre, bound_ + cell_radius).found()) return;
    const auto field = isosurface_.field().cell(low);
    if (!field) return;
    Found& cell = found[i];
    const auto is_near = [&](const Part& part) {
      const TriangleBvh::Hit hit = bvh.closest(part.centre, bound_);
      if (!hit.found()) return false;
      const std::uint32_t t = around[hit.triangle];
      if (!part.is_within(bound_, corners(mesh_.triangle(t)))) return false;
      cell.proof.push_back(t);
      return true;
    };
    const auto failed = [&](const Part& part) {
      const double reach = bound_ + part.radius;
      std::vector<std::uint32_t> leaves;
      const Vec3 all{reach, reach, reach};
      bvh.leaves_near(part.centre - all, part.centre + all, 0, leaves);
      for (const std::uint32_t leaf : leaves) {
        for (std::uint32_t slot = TriangleBvh::kLeafSize * leaf; slot < bvh.leaf_end(leaf);
             ++slot) {
          const std::uint32_t t = around[bvh.triangle_in(slot)];
          if (is_in_region(t) &&
              squared_distance(part.centre, corners(mesh_.triangle(t))) <= reach * reach)
            cell.near_failure.push_back(t);
        }
      }
      return true;
    };
    for_each_part(*field, low, spacing_, origin_, is_near, failed);
    sort_unique_ids(cell.proof);
    sort_unique_ids(cell.near_failure);
  });
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Found& cell = found[i];
    const auto in_region = [&](std::uint32_t t) { return is_in_region(t); };
    if (!cell.near_failure.empty()) {
      for (const auto* fixed : {&cell.near_failure, &cell.proof}) {
        for (const std::uint32_t t : *fixed) {
          if (in_region(t)) is_fixed_[number_of(t)] = 1;
        }
      }
    } else if (ranges::any_of(cell.proof, in_region)) {
      keys_.push_back(keys[i]);
      proof_.emplace_back();
      set_proof(static_cast<std::uint32_t>(proof_.size() - 1), std::move(cell.proof));
    }
  }
}

void NearbyIsosurface::set_proof(std::uint32_t cell, std::vector<std::uint32_t> proof) {
  for (const std::uint32_t t : proof_[cell]) {
    if (is_in_region(t)) std::erase(cells_of_[number_of(t)], cell);
  }
  for (const std::uint32_t t : proof) {
    if (is_in_region(t)) cells_of_[number_of(t)].push_back(cell);
  }
  proof_[cell] = std::move(proof);
}

std::vector<std::uint32_t> NearbyIsosurface::cells_that_need(
    std::span<const std::uint32_t> triangles) const {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t t : triangles) {
    const std::vector<std::uint32_t>& cells = cells_of_[number_of(t)];
    out.insert(out.end(), cells.begin(), cells.end());
  }
  sort_unique_ids(out);
  return out;
}

bool NearbyIsosurface::prove(std::uint32_t cell, std::span<const std::uint32_t> triangles,
                             std::vector<std::uint32_t>& proof) const {
  const Vec3 low = index_.low(keys_[cell]);
  std::vector<std::array<Vec3, 3>> corners_of;
  std::vector<std::uint32_t> ids;
  for (const std::uint32_t t : triangles) {
    if (CollapsingMesh::is_removed(mesh_.triangle(t))) continue;
    ids.push_back(t);
    corners_of.push_back(corners(mesh_.triangle(t)));
  }
  proof.clear();
  bool is_proved = true;
  std::size_t last = 0;  // the triangle that proved the previous part: often proves the next one
  const auto is_near = [&](const Part& part) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const std::size_t k = i == 0 ? last : i <= last ? i - 1 : i;
      if (!part.is_within(bound_, corners_of[k])) continue;
      last = k;
      proof.push_back(ids[k]);
      return true;
    }
    return false;
  };
  const auto failed = [&](const Part&) {
    is_proved = false;
    return false;
  };
  for_each_part(*isosurface_.field().cell(low), low, spacing_, origin_, is_near, failed);
  sort_unique_ids(proof);
  return is_proved;
}

bool NearbyIsosurface::is_near(std::uint32_t triangle) const {
  std::array<Vec3, 3> at = corners(mesh_.triangle(triangle));
  for (Vec3& p : at) p = p - origin_;
  const TriangleDistance distance = triangle_distance(isosurface_, at, bound_, Evidence::proof);
  return distance.upper_bound <= bound_;
}

NearbyIsosurface::Sample NearbyIsosurface::farthest_c_vertex(std::uint32_t cell) const {
  Sample out;
  for (const CVertexId c : index_.c_vertices(keys_[cell])) {
    const Vec3 p = to_metric(complex_.positions[c], spacing_) + origin_;
    double nearest = INFINITY;
    std::uint32_t vertex = kNone;
    for (const std::uint32_t t : proof_[cell]) {
      const Triangle& triangle = mesh_.triangle(t);
      const auto [a, b, d] = corners(triangle);
      const TrianglePoint point = closest_on_triangle(p, a, b, d);
      if (!(point.squared_distance < nearest)) continue;
      nearest = point.squared_distance;
      const auto largest = std::max_element(point.weight.begin(), point.weight.end());
      vertex = triangle[static_cast<std::size_t>(largest - point.weight.begin())];
    }
    // A c-vertex that is farther is not on the isosurface, which is proved to be within the bound.
    const double distance = std::min(std::sqrt(nearest), bound_);
    if (vertex != kNone && distance > out.distance) out = {distance, vertex};
  }
  return out;
}

}  // namespace isoatlas::detail
