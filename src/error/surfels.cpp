// SPDX-License-Identifier: Apache-2.0
#include "error/surfels.h"

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kSurfelsPerChunk = 8192;  // c-vertices, of a parallel loop

}  // namespace

Surfels make_surfels(const SurfaceComplex& complex, const RunControl* control) {
  const std::uint32_t n = complex.c_vertex_count();
  Surfels out;
  out.point.resize(n);
  out.normal.resize(n);
  out.area.assign(n, 0);
  for_each_index(n, kSurfelsPerChunk, control, [&](std::size_t v) {
    out.point[v] = to_metric(complex.positions[v], complex.spacing);
  });
  CancelPoll poll(control);
  for (const Face& face : complex.faces) {
    poll.step();
    const int size = face.size();
    const auto at = [&](int k) { return out.point[face.corner[k]]; };
    // Twice the area vector: for a quad the cross product of its diagonals, for a triangle that of
    // two sides.
    const Vec3 twice = cross(at(2) - at(0), at(size - 1) - at(1));
    const auto share = static_cast<float>(0.5 * length(twice) / size);
    for (int k = 0; k < size; ++k) {
      Vec3& sum = out.normal[face.corner[k]];
      sum = sum + twice;
      out.area[face.corner[k]] += share;
    }
  }
  for_each_index(n, kSurfelsPerChunk, control,
                 [&](std::size_t v) { out.normal[v] = normalized(out.normal[v]); });
  return out;
}

}  // namespace isoatlas::detail
