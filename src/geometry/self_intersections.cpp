// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/parallel.h"
#include "geometry/close_triangles.h"
#include "geometry/require_corners.h"
#include "geometry/triangle_pair.h"
#include "isoatlas/error.h"

namespace isoatlas {
using namespace detail;
namespace {

void check_input(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  checked_id(positions.size(), "vertices");
  checked_id(triangles.size(), "triangles");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 p = positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(ErrorCode::bad_argument, "vertex " + std::to_string(v) + " is not finite");
  }
  require_corners({positions, triangles});
}

}  // namespace

std::vector<TrianglePair> self_intersections(std::span<const Vec3> positions,
                                             std::span<const Triangle> triangles,
                                             const SelfIntersectionOptions& options,
                                             const RunControl& control) try {
  const ThreadLimit threads(control.threads);
  control.report("intersect", 0);
  check_input(positions, triangles);
  std::vector<std::uint32_t> wanted;
  if (options.involving) {
    wanted.assign(options.involving->begin(), options.involving->end());
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    if (!wanted.empty() && wanted.back() >= triangles.size())
      throw Error(ErrorCode::bad_argument,
                  "the list has triangle " + std::to_string(wanted.back()) +
                      ", but there are only " + std::to_string(triangles.size()));
    if (wanted.empty()) return {};
  } else {
    wanted.resize(triangles.size());
    std::iota(wanted.begin(), wanted.end(), 0u);
  }
  const auto intersect = [&](std::uint32_t a, std::uint32_t b) {
    return !are_certainly_disjoint(positions, triangles[a], triangles[b], 0) &&
           intersect_beyond_shared_simplex(positions, triangles[a], triangles[b]);
  };
  return CloseTriangles().update(positions, triangles, wanted, intersect, control);
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory to find self-intersections");
}

Vec3 intersection_position(std::span<const Vec3> positions, const Triangle& a, const Triangle& b) {
  const auto lowest = [&](const Triangle& t, double Vec3::*x) {
    return std::min({positions[t[0]].*x, positions[t[1]].*x, positions[t[2]].*x});
  };
  const auto highest = [&](const Triangle& t, double Vec3::*x) {
    return std::max({positions[t[0]].*x, positions[t[1]].*x, positions[t[2]].*x});
  };
  const auto middle = [&](double Vec3::*x) {  // of the intersection of both boxes
    return 0.5 * std::max(lowest(a, x), lowest(b, x)) +
           0.5 * std::min(highest(a, x), highest(b, x));
  };
  return {middle(&Vec3::x), middle(&Vec3::y), middle(&Vec3::z)};
}

}  // namespace isoatlas
