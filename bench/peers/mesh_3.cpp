// SPDX-License-Identifier: Apache-2.0
// CGAL Mesh_3 meshes the boundary of the solid in which the trilinear interpolant is above the
// isovalue, without features. Mesh_3 is GPL: this program is only for measurements and is never
// linked into isoatlas (README.md).
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>

#include "peer.h"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

constexpr double kFacetAngle = 30;       // degrees; Mesh_3 always ends up to this angle
constexpr double kFacetSizeVoxels = 20;  // with a larger size, Mesh_3 misses thin parts
// Error of points on the surface, relative to the extent of the volume.
constexpr double kRelativeError = 1e-6;

// The trilinear interpolant minus the isovalue, with a sign that makes it negative inside. The
// inside is the side with fewer samples on the volume boundary. The function is positive outside
// the volume, which closes the surface where it reaches the volume boundary.
template <class Sample>
class Interpolant {
 public:
  Interpolant(const isoatlas::VolumeView& volume, double isovalue)
      : grid_(volume.grid),
        samples_(static_cast<const Sample*>(volume.samples)),
        isovalue_(isovalue) {
    const auto [nx, ny, nz] = grid_.size;
    std::size_t on_boundary = 0, above = 0;
    for (std::size_t z = 0; z < nz; ++z)
      for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x) {
          if (x != 0 && x + 1 != nx && y != 0 && y + 1 != ny && z != 0 && z + 1 != nz) continue;
          ++on_boundary;
          if (static_cast<double>(samples_[x + nx * (y + ny * z)]) >= isovalue) ++above;
        }
    sign_ = 2 * above > on_boundary ? 1 : -1;
  }

  double operator()(const Kernel::Point_3& p) const {
    const double at[3] = {p.x() / grid_.spacing.x, p.y() / grid_.spacing.y,
                          p.z() / grid_.spacing.z};
    std::size_t low[3];
    double t[3];
    for (int a = 0; a < 3; ++a) {
      const auto last = static_cast<double>(grid_.size[a] - 1);
      if (!(at[a] >= 0 && at[a] <= last)) return 1;
      const double cell = std::min(std::floor(at[a]), last - 1);
      low[a] = static_cast<std::size_t>(cell);
      t[a] = at[a] - cell;
    }
    const Sample* corner = samples_ + low[0] + grid_.size[0] * (low[1] + grid_.size[1] * low[2]);
    const std::size_t dy = grid_.size[0], dz = grid_.size[0] * grid_.size[1];
    const auto along_x = [&](const Sample* s) {
      return (1 - t[0]) * static_cast<double>(s[0]) + t[0] * static_cast<double>(s[1]);
    };
    const auto along_y = [&](const Sample* s) {
      return (1 - t[1]) * along_x(s) + t[1] * along_x(s + dy);
    };
    return sign_ * ((1 - t[2]) * along_y(corner) + t[2] * along_y(corner + dz) - isovalue_);
  }

 private:
  isoatlas::Grid grid_;
  const Sample* samples_;
  double isovalue_, sign_ = 1;
};

std::function<double(const Kernel::Point_3&)> interpolant(const isoatlas::VolumeView& volume,
                                                          double isovalue) {
  using enum isoatlas::SampleType;
  switch (volume.type) {
    case int8:
      return Interpolant<std::int8_t>(volume, isovalue);
    case uint8:
      return Interpolant<std::uint8_t>(volume, isovalue);
    case int16:
      return Interpolant<std::int16_t>(volume, isovalue);
    case uint16:
      return Interpolant<std::uint16_t>(volume, isovalue);
    case int32:
      return Interpolant<std::int32_t>(volume, isovalue);
    case uint32:
      return Interpolant<std::uint32_t>(volume, isovalue);
    case int64:
      return Interpolant<std::int64_t>(volume, isovalue);
    case uint64:
      return Interpolant<std::uint64_t>(volume, isovalue);
    case float32:
      return Interpolant<float>(volume, isovalue);
    case float64:
      return Interpolant<double>(volume, isovalue);
  }
  throw std::logic_error("sample type without an interpolant");
}

isoatlas::TriangleMesh surface_of(const Complex& complex) {
  isoatlas::TriangleMesh mesh;
  std::map<Triangulation::Vertex_handle, std::uint32_t> index;
  for (auto facet = complex.facets_in_complex_begin(); facet != complex.facets_in_complex_end();
       ++facet) {
    isoatlas::Triangle triangle{};
    for (int k = 0; k < 3; ++k) {
      const auto vertex = facet->first->vertex((facet->second + 1 + k) % 4);
      const auto [entry, is_new] =
          index.try_emplace(vertex, static_cast<std::uint32_t>(mesh.positions.size()));
      if (is_new)
        mesh.positions.push_back({vertex->point().x(), vertex->point().y(), vertex->point().z()});
      triangle[static_cast<std::size_t>(k)] = entry->second;
    }
    // The triangles are not oriented: distances and shapes do not depend on the orientation.
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

isoatlas::TriangleMesh mesh_3(const isoatlas::VolumeView& volume, double isovalue,
                              double facet_distance) {
  const double voxel = volume.grid.smallest_spacing();
  namespace parameters = CGAL::parameters;
  CGAL::get_default_random() = CGAL::Random(0);  // makes all runs equal
  const auto& grid = volume.grid;
  const auto end = [](std::size_t size, double spacing) {
    return static_cast<double>(size) * spacing;
  };
  const CGAL::Bbox_3 box(-grid.spacing.x, -grid.spacing.y, -grid.spacing.z,
                         end(grid.size[0], grid.spacing.x), end(grid.size[1], grid.spacing.y),
                         end(grid.size[2], grid.spacing.z));
  const Domain domain = Domain::create_implicit_mesh_domain(
      interpolant(volume, isovalue), box, parameters::relative_error_bound = kRelativeError);
  const Criteria criteria(parameters::facet_angle = kFacetAngle,
                          parameters::facet_size = kFacetSizeVoxels * voxel,
                          parameters::facet_distance = facet_distance * voxel);
  return surface_of(CGAL::make_mesh_3<Complex>(domain, criteria, parameters::no_perturb(),
                                               parameters::no_exude(), parameters::manifold()));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace isoatlas;
  using namespace isoatlas::detail;
  return bench::run_peer(argc, argv,
                         [](const VolumeView& volume, double isovalue, const bench::Goal& goal) {
                           bench::Peer peer;
                           peer.name = "mesh_3";
                           peer.parameter = "facet_distance, voxels";
                           peer.coarsest = 4;
                           peer.finest = 0.02;
                           peer.start = goal.distance_voxels / 2;
                           peer.mesh = [volume, isovalue](double facet_distance) {
                             return mesh_3(volume, isovalue, facet_distance);
                           };
                           return peer;
                         });
}
