// SPDX-License-Identifier: Apache-2.0
#include "peer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail::bench {
namespace {

constexpr const char* kUsage =
    R"(VOLUME ISOVALUE [options]
  --refine VOXELS    bound on the distance that isoatlas refines to (default 0.5)
  --distance VOXELS  measured distance that the peer must reach (default: that of isoatlas)
  --repeats N        runs of both programs with the parameter that was found; times are medians
                     (default 3)
)";
constexpr std::size_t kSamples = 200'000;
// The search ends when the parameters of the best mesh and of the next coarser one have a smaller
// ratio.
constexpr double kSearchTolerance = 1.02;

struct Arguments {
  std::filesystem::path volume;
  double isovalue = 0, refine = 0.5, distance = 0;
  int repeats = 3;
};

bool parse_arguments(int argc, char** argv, Arguments& out) {
  std::vector<const char*> positional;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--")) {
      positional.push_back(argv[i]);
      continue;
    }
    if (i + 1 >= argc) return false;
    const double value = std::atof(argv[++i]);
    if (!(value > 0)) return false;
    if (word == "--refine") {
      out.refine = value;
    } else if (word == "--distance") {
      out.distance = value;
    } else if (word == "--repeats") {
      out.repeats = static_cast<int>(value);
    } else {
      return false;
    }
  }
  if (positional.size() != 2) return false;
  out.volume = positional[0];
  out.isovalue = std::atof(positional[1]);
  return true;
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

// Removes the vertices without triangles that decimation leaves: measure() would sample them.
TriangleMesh without_unused_vertices(const TriangleMesh& mesh) {
  constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  std::vector<std::uint32_t> index(mesh.positions.size(), kNone);
  TriangleMesh out;
  for (Triangle triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      if (index[corner] == kNone) {
        index[corner] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[corner]);
      }
      corner = index[corner];
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

// The parameter of a mesh and its measurements.
struct MeasuredMesh {
  double parameter = 0, distance = 0;  // distance: two-sided, in voxels
  std::size_t triangles = 0, components = 0, non_manifold_edges = 0;
  double share_below_third = 0;

  std::string to_json(double cpu) const {
    char text[300];
    std::snprintf(text, sizeof text,
                  R"({"parameter": %.6g, "triangles": %zu, "distance_voxels": %.6g, )"
                  R"("share_below_third": %.6g, "cpu_s": %.6g, )"
                  R"("components": %zu, "non_manifold_edges": %zu})",
                  parameter, triangles, distance, share_below_third, cpu, components,
                  non_manifold_edges);
    return text;
  }
};

// Measures meshes in coordinates of index times spacing against an isosurface.
class MeshMeasurer {
 public:
  MeshMeasurer(const VolumeView& volume, double isovalue) : volume_(volume) {
    options_.surface.isovalue = isovalue;
    options_.space = Space::voxel;
    options_.samples = kSamples;
  }

  MeasuredMesh operator()(const TriangleMesh& raw, double parameter) const {
    TriangleMesh mesh = without_unused_vertices(raw);
    const MeshQuality quality = mesh_quality(mesh);
    const MeshTopology topology = mesh_topology(mesh);
    const Vec3 spacing = volume_.grid.spacing;
    for (Vec3& p : mesh.positions) p = {p.x / spacing.x, p.y / spacing.y, p.z / spacing.z};
    const Measurement measured = measure(mesh, volume_, options_);
    return {parameter,
            measured.maximum() / measured.voxel,
            mesh.triangles.size(),
            topology.components.size(),
            topology.non_manifold_edges,
            quality.aspect_share_below_third};
  }

 private:
  const VolumeView& volume_;
  MeasureOptions options_;
};

// The mesh of isoatlas, like those of peers in coordinates of index times spacing.
TriangleMesh extract_ours(const VolumeView& volume, const Arguments& arguments) {
  ExtractOptions options;
  options.surface.isovalue = arguments.isovalue;
  options.space = Space::voxel;
  options.refine = {{{Quantity::max_distance, arguments.refine * volume.grid.smallest_spacing()}}};
  RunControl control;
  control.threads = 1;
  TriangleMesh mesh = extract(volume, options, control).mesh();
  const Vec3 spacing = volume.grid.spacing;
  for (Vec3& p : mesh.positions) p = {p.x * spacing.x, p.y * spacing.y, p.z * spacing.z};
  return mesh;
}

// Searches for the coarsest mesh within `distance`. Returns it and true, or the finest mesh and
// false if even that is not within `distance`. Doubles or halves the parameter until one mesh is
// within the distance and one is not, then bisects on a logarithmic scale.
std::pair<MeasuredMesh, bool> search(const Peer& peer, const MeshMeasurer& measured,
                                     double distance) {
  const auto at = [&](double parameter) {
    const MeasuredMesh out = measured(peer.mesh(parameter), parameter);
    std::fprintf(stderr, "%s: %s %.5g: %zu triangles, distance %.4f voxels\n", peer.name.c_str(),
                 peer.parameter.c_str(), parameter, out.triangles, out.distance);
    return out;
  };
  const double finer = peer.finest > peer.coarsest ? 2 : 0.5;
  const auto [low, high] = std::minmax(peer.coarsest, peer.finest);
  double coarse = std::clamp(peer.start, low, high), fine = coarse;
  MeasuredMesh best = at(fine);
  if (best.distance <= distance) {
    while (coarse == fine && fine != peer.coarsest) {
      coarse = std::clamp(fine / finer, low, high);
      const MeasuredMesh found = at(coarse);
      if (found.distance > distance) break;
      best = found;
      fine = coarse;
    }
  } else {
    while (best.distance > distance) {
      if (fine == peer.finest) return {best, false};
      coarse = fine;
      fine = std::clamp(fine * finer, low, high);
      best = at(fine);
    }
  }
  while (std::max(coarse / fine, fine / coarse) > kSearchTolerance) {
    const double middle = std::sqrt(coarse * fine);
    const MeasuredMesh found = at(middle);
    if (found.distance <= distance) {
      best = found;
      fine = middle;
    } else {
      coarse = middle;
    }
  }
  return {best, true};
}

}  // namespace

int run_peer(int argc, char** argv, const MakePeer& make_peer) try {
  Arguments arguments;
  if (!parse_arguments(argc, argv, arguments)) {
    std::fprintf(stderr, "usage: %s %s", std::filesystem::path(argv[0]).filename().c_str(), kUsage);
    return 2;
  }
  setenv("VTK_SMP_MAX_THREADS", "1", 1);
  const Volume volume = read_volume(arguments.volume);
  const MeshMeasurer measured(volume, arguments.isovalue);
  const MeasuredMesh ours = measured(extract_ours(volume, arguments), arguments.refine);
  const double distance = arguments.distance > 0 ? arguments.distance : ours.distance;
  const Peer peer = make_peer(volume, arguments.isovalue, {distance, ours.triangles});
  const auto [theirs, reached] = search(peer, measured, distance);

  std::vector<double> our_seconds, their_seconds;
  for (int k = 0; k < std::max(1, arguments.repeats); ++k) {
    double start = cpu_seconds();
    extract_ours(volume, arguments);
    our_seconds.push_back(cpu_seconds() - start);
    start = cpu_seconds();
    peer.mesh(theirs.parameter);
    their_seconds.push_back(cpu_seconds() - start);
  }
  std::printf(R"({"name": "%s", "parameter": "%s", "wanted_distance_voxels": %.6g, "reached": %s, )"
              R"("repeats": %zu, "isoatlas": %s, "peer": %s})"
              "\n",
              peer.name.c_str(), peer.parameter.c_str(), distance, reached ? "true" : "false",
              our_seconds.size(), ours.to_json(median(our_seconds)).c_str(),
              theirs.to_json(median(their_seconds)).c_str());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s: %s\n", std::filesystem::path(argv[0]).filename().c_str(), error.what());
  return 1;
}

}  // namespace isoatlas::detail::bench
