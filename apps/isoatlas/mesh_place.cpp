// SPDX-License-Identifier: Apache-2.0
#include "mesh_place.h"

#include <array>
#include <utility>
#include <vector>

#include "core/vector_math.h"
#include "geometry/bounds.h"
#include "text.h"

namespace isoatlas::detail::tool {
namespace {

constexpr std::array<std::pair<Space, const char*>, 3> kSpaces{
    {{Space::lps, "lps"}, {Space::ras, "ras"}, {Space::voxel, "voxel"}}};

Bounds volume_bounds(const Grid& grid, Space space) {
  std::vector<Vec3> corners;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto at = [&](unsigned axis) {
      return (corner >> axis & 1U) != 0 ? static_cast<double>(grid.size[axis] - 1) : 0.0;
    };
    const Vec3 index{at(0), at(1), at(2)};
    Vec3 point = space == Space::voxel ? index : grid.to_world(index);
    if (space == Space::ras) point = {-point.x, -point.y, point.z};
    corners.push_back(point);
  }
  return bounds_of(corners);
}

bool overlap(const Bounds& a, const Bounds& b) {
  const auto share = [](double low_a, double high_a, double low_b, double high_b) {
    return low_a <= high_b && low_b <= high_a;
  };
  return share(a.low.x, a.high.x, b.low.x, b.high.x) &&
         share(a.low.y, a.high.y, b.low.y, b.high.y) && share(a.low.z, a.high.z, b.low.z, b.high.z);
}

/// "0..24 0..20 -3..16"
std::string box_text(const Bounds& box) {
  const auto axis = [](double low, double high) {
    return number_text(low) + ".." + number_text(high);
  };
  return axis(box.low.x, box.high.x) + " " + axis(box.low.y, box.high.y) + " " +
         axis(box.low.z, box.high.z);
}

/// The bounds of the vertices that triangles use.
Bounds mesh_bounds(const TriangleMesh& mesh) {
  std::vector<Vec3> used;
  used.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used.push_back(mesh.positions[v]);
  return bounds_of(used);
}

}  // namespace

std::string misplacement(const TriangleMesh& mesh, const Grid& grid, Space space,
                         const Measurement& measured) {
  const Bounds of_mesh = mesh_bounds(mesh), of_volume = volume_bounds(grid, space),
               world = volume_bounds(grid, Space::lps);
  const bool is_far = measured.maximum() > length(world.high - world.low);
  if (overlap(of_mesh, of_volume) && !is_far) return "";
  std::string name, others;
  for (const auto& [other, other_name] : kSpaces) {
    if (other == space)
      name = other_name;
    else if (overlap(of_mesh, volume_bounds(grid, other)))
      others += std::string(others.empty() ? "" : " or ") + "--space " + other_name;
  }
  return "is nowhere near the volume: x, y, z of the mesh are " + box_text(of_mesh) +
         ", of the volume in " + name + " " + box_text(of_volume) + "; " +
         (others.empty() ? "use --space to state the coordinates of the mesh"
                         : "they overlap with " + others);
}

}  // namespace isoatlas::detail::tool
