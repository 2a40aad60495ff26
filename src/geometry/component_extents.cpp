// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/component_extents.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <tuple>

#include "core/cancel_poll.h"
#include "core/compensated_sum.h"
#include "core/ids.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "geometry/require_corners.h"
#include "isoatlas/error.h"

namespace isoatlas {
using namespace detail;
namespace {

void extend(BoundingBox& box, Vec3 low, Vec3 high) {
  box.low = {std::min(box.low.x, low.x), std::min(box.low.y, low.y), std::min(box.low.z, low.z)};
  box.high = {std::max(box.high.x, high.x), std::max(box.high.y, high.y),
              std::max(box.high.z, high.z)};
}

// The components with their bounds and numbers of triangles.
std::vector<ComponentExtent> bounded_components(const MeshView& mesh,
                                                const MeshTopology& topology) {
  std::vector<ComponentExtent> out(topology.components.size());
  std::vector<std::uint8_t> has_bounds(out.size(), 0);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::uint32_t c = topology.component_of_vertex[v];
    if (c == kNone) continue;
    const Vec3 p = mesh.positions[v];
    if (has_bounds[c] == 0) out[c].bounds = {p, p};
    has_bounds[c] = 1;
    extend(out[c].bounds, p, p);
  }
  for (std::uint32_t c = 0; c < out.size(); ++c) {
    out[c].component = c;
    out[c].topology = topology.components[c];
  }
  for (const Triangle& t : mesh.triangles) ++out[topology.component_of_vertex[t[0]]].triangles;
  return out;
}

// Per component, 1 if its triangles enclose a volume: they run along every edge equally often in
// both directions.
std::vector<std::uint8_t> closed_flags(const MeshView& mesh, const MeshTopology& topology,
                                       const RunControl& control) {
  std::vector<std::uint8_t> is_closed(topology.components.size(), 1);
  if (topology.is_manifold() && topology.is_oriented()) {
    for (std::size_t c = 0; c < is_closed.size(); ++c)
      is_closed[c] = topology.components[c].boundary_loops == 0 ? 1 : 0;
    return is_closed;
  }
  struct Side {
    std::uint32_t low, high;
    int direction;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      if (from != to) sides.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  control.check_cancelled();
  ranges::sort(sides, [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.direction) < std::tie(b.low, b.high, b.direction);
  });
  CancelPoll poll(control);
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    poll.step();
    std::int64_t sum = 0;
    for (; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j)
      sum += sides[j].direction;
    if (sum != 0) is_closed[topology.component_of_vertex[sides[i].low]] = 0;
  }
  return is_closed;
}

// The coordinates in which a component is summed up: relative to the middle of its bounds, scaled
// by a power of two. Products of its lengths then neither overflow nor underflow, and the scaling
// rounds nothing.
struct Frame {
  Vec3 middle;
  int exponent = 0;

  explicit Frame(const BoundingBox& bounds) : middle(0.5 * bounds.low + 0.5 * bounds.high) {
    const double longest = largest_coordinate(bounds.high - bounds.low);
    if (longest > 0 && std::isfinite(longest)) exponent = std::ilogb(longest);
  }
  Vec3 operator()(Vec3 p) const {
    const Vec3 q = p - middle;
    return {std::ldexp(q.x, -exponent), std::ldexp(q.y, -exponent), std::ldexp(q.z, -exponent)};
  }
};

}  // namespace

std::vector<ComponentExtent> component_extents(const MeshView& mesh, const MeshTopology& topology,
                                               const RunControl& control) try {
  require_corners(mesh);
  if (topology.component_of_vertex.size() != mesh.positions.size() ||
      topology.triangles != mesh.triangles.size())
    throw Error(ErrorCode::bad_argument, "the topology is that of another mesh");
  std::vector<ComponentExtent> out = bounded_components(mesh, topology);
  const std::vector<std::uint8_t> is_closed = closed_flags(mesh, topology, control);
  std::vector<Frame> frames;
  frames.reserve(out.size());
  for (const ComponentExtent& component : out) frames.emplace_back(component.bounds);
  struct Sums {
    CompensatedSum twice_area, six_volumes;
  };
  std::vector<Sums> sums(out.size());
  CancelPoll poll(control);
  for (const Triangle& t : mesh.triangles) {
    poll.step();
    const std::uint32_t c = topology.component_of_vertex[t[0]];
    const Frame& frame = frames[c];
    const Vec3 p = frame(mesh.positions[t[0]]), q = frame(mesh.positions[t[1]]),
               r = frame(mesh.positions[t[2]]);
    const Vec3 twice_area = cross(q - p, r - p);
    sums[c].twice_area.add(length(twice_area));
    sums[c].six_volumes.add(dot(p, twice_area));
  }
  for (std::size_t c = 0; c < out.size(); ++c) {
    const int exponent = frames[c].exponent;
    out[c].area = std::ldexp(sums[c].twice_area.value() / 2, 2 * exponent);
    if (is_closed[c] != 0)
      out[c].volume = std::ldexp(sums[c].six_volumes.value() / 6, 3 * exponent);
  }
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for the extent of this mesh");
}

std::vector<ComponentExtent> component_extents(const MeshView& mesh, const RunControl& control) {
  return component_extents(mesh, mesh_topology(mesh, control), control);
}

MeshExtent summarize(const std::vector<ComponentExtent>& components, std::size_t listed) {
  MeshExtent out;
  out.components = components.size();
  if (components.empty()) return out;
  out.bounds = components.front().bounds;
  CompensatedSum area, volume;
  for (const ComponentExtent& component : components) {
    extend(out.bounds, component.bounds.low, component.bounds.high);
    area.add(component.area);
    if (component.volume)
      volume.add(*component.volume);
    else
      ++out.open_components;
  }
  out.area = area.value();
  if (out.open_components < out.components) out.volume = volume.value();

  std::vector<std::uint32_t> order(components.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(listed, order.size()));
  const auto rank = [&](std::uint32_t i) {  // a total order, with positions that are NaN as well
    return std::isnan(components[i].area) ? -1.0 : components[i].area;
  };
  std::partial_sort(order.begin(), end, order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rank(a) != rank(b) ? rank(a) > rank(b) : a < b;
  });
  for (auto it = order.begin(); it != end; ++it) out.largest.push_back(components[*it]);
  return out;
}

}  // namespace isoatlas
