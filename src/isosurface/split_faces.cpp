// SPDX-License-Identifier: Apache-2.0
#include "isosurface/split_faces.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/cancel_poll.h"
#include "core/ranges.h"

namespace isoatlas::detail {
namespace {

// The ends of a boundary side, and the node between them.
using BoundaryNode = std::array<CVertexId, 3>;

int next_axis(int axis, int by) { return (axis + by) % 3; }
bool is_on_volume_boundary(const SplitNode& node, int axis) {
  return node.on_volume_boundary[static_cast<std::size_t>(axis)] != 0;
}
// Whether a node is on a face of the volume, but not on one of its edges.
bool is_on_volume_boundary(const SplitNode& node) {
  return is_on_volume_boundary(node, next_axis(node.axis, 1)) !=
         is_on_volume_boundary(node, next_axis(node.axis, 2));
}

// The c-vertex at the node. On an edge of the volume a boundary c-vertex is there already.
CVertexId centre_of_fan(SurfaceComplex& complex, const SplitNode& node,
                        const std::vector<CVertexId>& polygon) {
  const int u = next_axis(node.axis, 1), v = next_axis(node.axis, 2);
  if (!is_on_volume_boundary(node, u) || !is_on_volume_boundary(node, v))
    return add_c_vertex(complex, node.position);
  const auto coordinate = [](Vec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
  const auto is_at_node = [&](CVertexId id) {
    const Vec3 p = complex.positions[id];
    return coordinate(p, u) == coordinate(node.position, u) &&
           coordinate(p, v) == coordinate(node.position, v);
  };
  return *std::find_if(polygon.begin(), polygon.end(), is_at_node);
}

// The corners of a node's face with the midpoints between them.
std::vector<CVertexId> polygon_around(const SurfaceComplex& complex, const SplitNode& node,
                                      std::span<const SegmentMidpoint> midpoints) {
  const auto& quad = complex.faces[node.face].corner;
  const std::vector<CVertexId> corners =
      node.is_cut ? node.corners : std::vector<CVertexId>(quad.begin(), quad.end());
  std::vector<CVertexId> out;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const CVertexId from = corners[k], to = corners[(k + 1) % corners.size()];
    out.push_back(from);
    for (const SegmentMidpoint& m : midpoints) {
      if ((m.a == from && m.b == to) || (m.b == from && m.a == to)) out.push_back(m.id);
    }
  }
  return out;
}

void make_fan(SurfaceComplex& complex, const SplitNode& node,
              std::span<const SegmentMidpoint> midpoints,
              std::vector<BoundaryNode>& boundary_nodes) {
  const std::vector<CVertexId> polygon = polygon_around(complex, node, midpoints);
  const CVertexId centre = centre_of_fan(complex, node, polygon);
  bool first_triangle = true;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const CVertexId from = polygon[k], to = polygon[(k + 1) % polygon.size()];
    if (from == centre || to == centre) continue;
    if (is_on_volume_boundary(node) && complex.on_boundary[from] &&
        complex.on_boundary[to]) {  // on the volume boundary, on both sides of the node
      complex.on_boundary[centre] = 1;
      boundary_nodes.push_back({from, to, centre});
      continue;
    }
    const Face triangle{{centre, from, to, kNone}};
    if (std::exchange(first_triangle, false)) {
      complex.faces[node.face] = triangle;
    } else {
      complex.faces.push_back(triangle);
    }
  }
}

// Splits boundary sides at nodes.
void split_boundary_sides(SurfaceComplex& complex, std::vector<BoundaryNode> boundary_nodes) {
  if (boundary_nodes.empty()) return;
  std::sort(boundary_nodes.begin(), boundary_nodes.end());
  const std::size_t sides = complex.boundary.size();
  for (std::size_t i = 0; i < sides; ++i) {
    const BoundarySide side = complex.boundary[i];
    const auto at = std::lower_bound(boundary_nodes.begin(), boundary_nodes.end(),
                                     BoundaryNode{side.from, side.to, 0});
    if (at == boundary_nodes.end() || (*at)[0] != side.from || (*at)[1] != side.to) continue;
    complex.boundary[i].to = (*at)[2];
    complex.boundary.push_back({(*at)[2], side.to});
  }
}

}  // namespace

CVertexId add_c_vertex(SurfaceComplex& complex, Vec3 position) {
  const CVertexId id = checked_id(complex.positions.size(), "c-vertices");
  complex.positions.push_back(position);
  complex.on_boundary.push_back(0);
  return id;
}

void split_faces(SurfaceComplex& complex, std::vector<SplitNode> nodes,
                 std::vector<SegmentMidpoint> midpoints, const RunControl& control) {
  ranges::sort(nodes, [](const SplitNode& a, const SplitNode& b) {
    return a.face != b.face ? a.face < b.face : a.is_cut > b.is_cut;
  });
  nodes.erase(ranges::unique_by(nodes, &SplitNode::face), nodes.end());
  ranges::sort(midpoints, [](const SegmentMidpoint& a, const SegmentMidpoint& b) {
    return std::tie(a.face, a.id) < std::tie(b.face, b.id);
  });
  std::vector<BoundaryNode> boundary_nodes;
  CancelPoll poll(control);
  for (const SplitNode& node : nodes) {
    poll.step();
    const auto [first, last] = ranges::equal_range(midpoints, node.face, &SegmentMidpoint::face);
    make_fan(complex, node, {first, last}, boundary_nodes);
  }
  split_boundary_sides(complex, std::move(boundary_nodes));
  checked_id(complex.faces.size(), "faces");
}

}  // namespace isoatlas::detail
