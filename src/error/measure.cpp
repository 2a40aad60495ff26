// SPDX-License-Identifier: Apache-2.0
// Measures two-sided distances: from samples of the mesh to the isosurface, and from samples of the
// isosurface to the mesh.
#include "isoatlas/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <new>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/require.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/area_samples.h"
#include "error/measure_mesh.h"
#include "field/check_volume.h"
#include "field/dense_volume.h"
#include "field/to_space.h"
#include "geometry/require_corners.h"
#include "isosurface/parse_surface.h"

namespace isoatlas::detail {
namespace {

constexpr double kMaxVoxels = 1e15;  // the bounding volume hierarchy computes squares in single
                                     // precision; this leaves a margin
constexpr std::size_t kGrain = 512;  // samples per chunk of a parallel loop
constexpr std::size_t kSamplesPerReport = 65536;  // samples between two reports of progress

void check_mesh(const MeshView& mesh, Vec3 spacing) {
  require(!mesh.triangles.empty(), "the mesh has no triangles");
  require_corners(mesh);
  const double farthest = kMaxVoxels * std::min({spacing.x, spacing.y, spacing.z});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = to_metric(mesh.positions[v], spacing);
    if (std::abs(p.x) <= farthest && std::abs(p.y) <= farthest && std::abs(p.z) <= farthest)
      continue;  // false for NaN
    throw Error(ErrorCode::bad_argument,
                "vertex " + std::to_string(v) +
                    " of the mesh is not finite or more than 1e15 voxels away from the volume");
  }
}

// Sample points in addition to those spread by area, in the mesh's sample-index coordinates.
class SpecialPoints {
 public:
  explicit SpecialPoints(const MeshView& mesh) : mesh_(mesh) {
    std::vector<std::uint8_t> used(mesh.positions.size(), 0);
    edges_.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
        edges_.push_back(static_cast<std::uint64_t>(low) << 32 | high);
        used[t[k]] = 1;
      }
    }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    for (std::uint32_t v = 0; v < used.size(); ++v) {
      if (used[v]) vertices_.push_back(v);
    }
  }
  std::size_t size() const { return mesh_.triangles.size() + edges_.size() + vertices_.size(); }
  /// Centroids of triangles come first, so that i is the triangle; then edge midpoints, then
  /// vertices.
  bool is_centroid(std::size_t i) const { return i < mesh_.triangles.size(); }
  Vec3 point(std::size_t i) const {
    if (is_centroid(i)) {
      const auto [a, b, c] = mesh_.triangles[i];
      return (1.0 / 3) * (mesh_.positions[a] + mesh_.positions[b] + mesh_.positions[c]);
    }
    i -= mesh_.triangles.size();
    if (i < edges_.size())
      return 0.5 * (mesh_.positions[edges_[i] >> 32] + mesh_.positions[edges_[i] & 0xFFFFFFFF]);
    return mesh_.positions[vertices_[i - edges_.size()]];
  }
  Triangle corners(std::size_t i) const {
    if (is_centroid(i)) return mesh_.triangles[i];
    i -= mesh_.triangles.size();
    const std::uint32_t low = i < edges_.size() ? static_cast<std::uint32_t>(edges_[i] >> 32)
                                                : vertices_[i - edges_.size()];
    const std::uint32_t high = i < edges_.size() ? static_cast<std::uint32_t>(edges_[i]) : low;
    return {low, high, high};
  }

 private:
  MeshView mesh_;
  std::vector<std::uint64_t> edges_;
  std::vector<std::uint32_t> vertices_;
};

std::vector<Triangle> triangles_in_slot_order(const TriangleBvh& bvh) {
  std::vector<Triangle> out(bvh.triangle_count());
  for (std::uint32_t s = 0; s < out.size(); ++s) out[s] = bvh.corners_in(s);
  return out;
}

// The faces of the isosurface, each split at the midpoint of its quad's diagonal, which is moved
// onto the surface. Samples are spread over these: quads cut corners and would have too few samples
// where the surface bends most.
struct RefinedFaces {
  RefinedFaces(const Isosurface& surface, const RunControl& control) {
    const TriangleBvh& faces = surface.faces();
    const std::size_t c_vertices = faces.points().size();
    points.assign(faces.points().begin(), faces.points().end());
    points.resize(c_vertices + faces.triangle_count());
    triangles.resize(2 * faces.triangle_count());
    checked_id(points.size(), "samples' triangles");
    for_each_chunk(faces.triangle_count(), kGrain, [&](std::size_t begin, std::size_t end) {
      control.check_cancelled();
      for (std::size_t s = begin; s < end; ++s) {
        const auto [a, b, c] = faces.corners_in(static_cast<std::uint32_t>(s));
        const Vec3 middle = 0.5 * (points[a] + points[b]);
        const auto moved = surface.onto_surface(to_index(middle, surface.spacing()));
        const auto m = static_cast<std::uint32_t>(c_vertices + s);
        points[m] = moved ? to_metric(*moved, surface.spacing()) : middle;
        // Where the field vanishes nearby, the point can end up anywhere.
        if (squared_length(points[m] - middle) > 0.25 * squared_length(points[b] - points[a]))
          points[m] = middle;
        triangles[2 * s] = {a, m, c};
        triangles[2 * s + 1] = {m, b, c};
      }
    });
  }
  std::vector<Vec3> points;  // metric
  std::vector<Triangle> triangles;
};

// Calls body(begin, end) on chunks of [0, n); reports the progress of `stage` and tests for
// cancellation in between.
void for_each_sample(std::size_t n, const char* stage, const RunControl& control,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  for (std::size_t done = 0; done < n; done += kSamplesPerReport) {
    control.report(stage, static_cast<double>(done) / static_cast<double>(n));
    for_each_chunk(std::min(kSamplesPerReport, n - done), kGrain,
                   [&](std::size_t begin, std::size_t end) {
                     control.check_cancelled();
                     body(done + begin, done + end);
                   });
  }
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

// @param distance  of all samples; those spread by area come first
OneSidedDistance summarize(std::vector<double> distance, std::size_t by_area, double area,
                           double voxel, const std::function<Vec3(std::size_t)>& point) {
  OneSidedDistance out;
  out.samples = distance.size();
  const double faces = area / (voxel * voxel);
  out.samples_per_voxel_face = faces > 0 ? static_cast<double>(by_area) / faces : 0;
  const auto farthest = std::max_element(distance.begin(), distance.end());
  out.maximum = *farthest;
  out.farthest = point(static_cast<std::size_t>(farthest - distance.begin()));
  distance.resize(by_area);
  double sum = 0, sum_of_squares = 0;
  for (const double d : distance) {
    sum += d;
    sum_of_squares += d * d;
  }
  out.mean = sum / static_cast<double>(by_area);
  out.root_mean_square = std::sqrt(sum_of_squares / static_cast<double>(by_area));
  out.p50 = quantile(distance, 0.5);
  out.p99 = quantile(distance, 0.99);
  return out;
}

double degrees_between(Vec3 a, Vec3 b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

void measure_mesh_to_surface(const MeshView& mesh, const TriangleBvh& bvh,
                             const Isosurface& surface, std::size_t samples, Measurement& out,
                             DistantSamples& distant, const RunControl& control) {
  const Vec3 spacing = surface.spacing();
  const std::vector<Triangle> triangles = triangles_in_slot_order(bvh);
  const AreaSamples area_samples(bvh.points(), triangles, samples);
  control.check_cancelled();
  const SpecialPoints special(mesh);
  const auto point = [&](std::size_t i) {
    return i < samples ? to_index(area_samples.point(i), spacing) : special.point(i - samples);
  };
  const std::size_t inside_triangles = samples + mesh.triangles.size();
  std::vector<double> distance(samples + special.size());
  std::vector<double> angle(inside_triangles, -1);  // -1: there is no normal
  for_each_sample(
      distance.size(), "mesh to surface", control, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Isosurface::Hit hit = surface.closest(point(i));
          distance[i] = hit.distance;
          if (i >= inside_triangles) continue;
          const auto [a, b, c] =
              mesh.triangles[i < samples ? bvh.triangle_in(area_samples.triangle(i)) : i - samples];
          const Vec3 p = bvh.points()[a],
                     face_normal = normalized(cross(bvh.points()[b] - p, bvh.points()[c] - p));
          const Vec3 normal = surface.normal(hit.point);
          if (!(face_normal == Vec3{}) && !(normal == Vec3{}))
            angle[i] = degrees_between(face_normal, normal);
        }
      });
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] <= distant.bound) continue;
    distant.corners.push_back(i < samples
                                  ? mesh.triangles[bvh.triangle_in(area_samples.triangle(i))]
                                  : special.corners(i - samples));
  }
  control.check_cancelled();
  out.mesh_area = area_samples.area();
  out.mesh_to_surface =
      summarize(std::move(distance), samples, area_samples.area(), out.voxel, point);

  out.normal_maximum = std::max(0.0, *std::max_element(angle.begin(), angle.end()));
  angle.resize(samples);
  std::erase_if(angle, [](double a) { return a < 0; });
  double sum = 0;
  for (const double a : angle) sum += a;
  out.normal_mean = angle.empty() ? 0 : sum / static_cast<double>(angle.size());
  out.normal_p99 = quantile(angle, 0.99);
}

void measure_surface_to_mesh(const MeshView& mesh, const TriangleBvh& bvh,
                             const Isosurface& surface, std::size_t samples, Measurement& out,
                             DistantSamples& distant, const RunControl& control) {
  const Vec3 spacing = surface.spacing();
  const std::span<const Vec3> c_vertices = surface.faces().points();
  const RefinedFaces refined(surface, control);
  control.check_cancelled();
  const AreaSamples area_samples(refined.points, refined.triangles, samples);
  const auto point = [&](std::size_t i) {
    const Vec3 index =
        to_index(i < samples ? area_samples.point(i) : c_vertices[i - samples], spacing);
    return surface.onto_surface(index).value_or(index);
  };
  std::vector<double> distance(samples + c_vertices.size());
  std::vector<std::uint32_t> nearest(distance.size());  // the nearest triangle
  for_each_sample(
      distance.size(), "surface to mesh", control, [&](std::size_t begin, std::size_t end) {
        double reach = INFINITY;  // the distance of one sample bounds that of the next; the slack
                                  // is for rounding
        Vec3 last;
        for (std::size_t i = begin; i < end; ++i) {
          const Vec3 p = to_metric(point(i), spacing);
          if (i > begin)
            reach = (1 + 1e-9) * (distance[i - 1] + length(p - last)) + 1e-6 * out.voxel;
          TriangleBvh::Hit hit = bvh.closest(p, reach);
          if (!hit.found()) hit = bvh.closest(p);  // so far away that the slack was too small
          distance[i] = std::sqrt(hit.squared_distance);
          nearest[i] = hit.triangle;
          last = p;
        }
      });
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] > distant.bound) distant.corners.push_back(mesh.triangles[nearest[i]]);
  }
  control.check_cancelled();
  out.surface_area = area_samples.area();
  out.surface_to_mesh =
      summarize(std::move(distance), samples, area_samples.area(), out.voxel, point);
}

void scale(OneSidedDistance& d, double unit) {
  for (double* x : {&d.maximum, &d.mean, &d.root_mean_square, &d.p50, &d.p99}) *x *= unit;
}

}  // namespace

Measurement measure(const MeshView& mesh, const Isosurface& surface, std::size_t samples,
                    const RunControl& control) {
  DistantSamples none{INFINITY, {}};
  return measure(mesh, surface, samples, none, control);
}

Measurement measure(const MeshView& mesh, const Isosurface& surface, std::size_t samples,
                    DistantSamples& distant, const RunControl& control) {
  require(samples > 0, "no samples are wanted");
  const Vec3 spacing = surface.spacing();
  check_mesh(mesh, spacing);
  control.check_cancelled();
  std::vector<Vec3> positions;
  positions.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) positions.push_back(to_metric(p, spacing));
  const TriangleBvh bvh(std::move(positions), mesh.triangles, control);

  Measurement out;
  out.voxel = surface.voxel();
  measure_mesh_to_surface(mesh, bvh, surface, samples, out, distant, control);
  measure_surface_to_mesh(mesh, bvh, surface, samples, out, distant, control);
  return out;
}

void transform_to(Measurement& measurement, const Grid& grid, Space space) {
  const double voxel = grid.smallest_spacing();
  measurement.voxel = voxel;
  measurement.surface_area *= voxel * voxel;
  measurement.mesh_area *= voxel * voxel;
  for (OneSidedDistance* d : {&measurement.mesh_to_surface, &measurement.surface_to_mesh}) {
    scale(*d, voxel);
    d->farthest = to_space(grid, space, d->farthest);
  }
}

}  // namespace isoatlas::detail

namespace isoatlas {
using namespace detail;

double Measurement::maximum() const {
  return std::max(mesh_to_surface.maximum, surface_to_mesh.maximum);
}
double Measurement::p99() const { return std::max(mesh_to_surface.p99, surface_to_mesh.p99); }
double Measurement::mean() const { return std::max(mesh_to_surface.mean, surface_to_mesh.mean); }

Measurement measure(const MeshView& mesh, const VolumeView& any_volume,
                    const MeasureOptions& options, const RunControl& caller_control) try {
  const SurfaceOptions& wanted = options.surface;
  constexpr std::array<StageShare, 3> kStages{
      {{"surface", 1}, {"mesh to surface", 5}, {"surface to mesh", 3}}};
  const RunControl control = with_whole_progress(caller_control, kStages);
  check_volume(any_volume, wanted.isovalue);
  const Volume dense = dense_volume(any_volume);
  const VolumeView& volume = dense.view;
  require_orthonormal(volume.grid);
  require(options.samples > 0, "no samples are wanted");
  const ThreadLimit threads(control.threads);
  const Grid& grid = volume.grid;
  const double voxel = grid.smallest_spacing();

  // To sample-index coordinates; as in extract(), the unit of length is the smallest spacing.
  TriangleMesh index{{mesh.positions.begin(), mesh.positions.end()},
                     {mesh.triangles.begin(), mesh.triangles.end()}};
  for (Vec3& p : index.positions) p = from_space(grid, options.space, p);
  if (options.space != Space::voxel && grid.mirrored()) {
    for (Triangle& t : index.triangles) std::swap(t[1], t[2]);
  }
  VolumeView in_voxels = volume;
  in_voxels.grid.spacing = {grid.spacing.x / voxel, grid.spacing.y / voxel, grid.spacing.z / voxel};
  check_mesh(index, in_voxels.grid.spacing);  // fails before the surface is parsed

  control.report("surface", 0);
  ParseOptions parse;
  parse.rule = {wanted.isovalue, wanted.inside, wanted.non_finite};
  parse.topology = wanted.topology;
  parse.interpolation = wanted.interpolation;
  SurfaceComplex complex = parse_surface(in_voxels, parse, control);
  if (complex.faces.empty()) throw_empty_surface(volume, wanted.isovalue);
  const Isosurface surface(in_voxels, parse.rule, complex, wanted.interpolation, 1, control);
  complex = {};

  Measurement out = measure(index, surface, options.samples, control);
  transform_to(out, grid, options.space);
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory to measure this mesh");
} catch (const std::length_error&) {
  throw Error(ErrorCode::out_of_memory, "this mesh is too large for memory");
}

}  // namespace isoatlas
