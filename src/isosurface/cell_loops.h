// SPDX-License-Identifier: Apache-2.0
// How the isosurface crosses one cell: which crossed edges (nodes) belong to which surfel
// (surfel).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace isoatlas::detail {

// In this module a cell is always a grid cell. Numbering used everywhere in it, axis a = 0, 1, 2
// with u = (a + 1) % 3 and v = (a + 2) % 3:
//   corner  x + 2 y + 4 z
//   edge    4 a + (bit along u) + 2 (bit along v): the four edges along axis a
//   face    2 a + side: the two faces normal to axis a

/// Largest number of surfels of an entry.
inline constexpr std::size_t kMaxSurfels = 4;

struct CellLoops {
  std::uint8_t corners = 0;  ///< bit per corner, 1 = inside
  std::uint8_t loops = 0;    ///< number of closed loops of nodes, 0 to 4
  std::uint8_t surfels =
      0;  ///< one per loop; with a tunnel, the parts of the annulus instead of its two loops
  std::uint8_t ambiguous_faces = 0;  ///< bit per face with diagonal signs
  std::uint8_t joined_faces = 0;     ///< those of them whose inside corners are joined
  std::uint8_t double_faces =
      0;  ///< those of the ambiguous faces whose two segments are sides of the same surfel
  bool has_tunnel = false;
  std::uint16_t crossed = 0;  ///< bit per edge that carries a node
  /// Per crossed edge along axis a, the surfel of the node's segment on the face of the cell normal
  /// to (a + 1) % 3, and that of the segment on the face normal to (a + 2) % 3. They differ only
  /// where an annulus is cut at the node.
  std::array<std::uint8_t, 12> surfel_of_edge{}, other_surfel_of_edge{};

  std::uint8_t surfel(int edge, int face_axis) const {
    return face_axis == (edge / 4 + 1) % 3 ? surfel_of_edge[edge] : other_surfel_of_edge[edge];
  }
};

/// A possible tunnel of the trilinear interpolant through a cell: in the slices normal to z at some
/// height, the corners of one diagonal are joined, while above and below those of the other one
/// are. Corners here are vertical edges: (x, y) = x + 2 y.
struct Tunnel {
  std::array<std::uint8_t, 2> joined,
      ring;  ///< the vertical edges that it joins, and those of the ring around it
  bool
      inside;  ///< whether the ends of the tunnel are inside and the ring is outside, or vice versa
  std::uint16_t entry;  ///< the cell's entry in the table if it has the tunnel
};

/// All ways in which the surface can cross a cell: 256 sign patterns times the decisions on their
/// ambiguous faces, computed by following face segments from node to node instead of from a
/// hand-written table; and one more entry for each possible tunnel.
class CellLoopTable {
 public:
  static const CellLoopTable& get();

  /// `joined_faces` needs to be correct only for the ambiguous faces.
  std::uint16_t index(std::uint8_t corners, std::uint8_t joined_faces) const {
    std::uint16_t decisions = 0;
    int bit = 0;
    for (unsigned rest = ambiguous_[corners]; rest != 0; rest &= rest - 1) {
      const unsigned face = static_cast<unsigned>(std::countr_zero(rest));
      decisions = static_cast<std::uint16_t>(decisions | (((joined_faces >> face) & 1u) << bit++));
    }
    return static_cast<std::uint16_t>(first_[corners] + decisions);
  }
  std::uint8_t ambiguous_faces(std::uint8_t corners) const { return ambiguous_[corners]; }
  /// Whether the signs of the corners do not determine the entry.
  bool needs_samples(std::uint8_t corners) const { return needs_samples_[corners]; }
  std::uint16_t first_index(std::uint8_t corners) const { return first_[corners]; }
  const CellLoops& operator[](std::uint16_t index) const { return entries_[index]; }
  const std::vector<CellLoops>& entries() const { return entries_; }

  /// The tunnels that an entry of index() admits: at most two, of which at most one exists
  /// (docs/theory/01-surface.md).
  std::span<const Tunnel> tunnels(std::uint16_t index) const {
    return {tunnels_.data() + first_tunnel_[index], tunnels_.data() + first_tunnel_[index + 1]};
  }

 private:
  CellLoopTable();
  std::array<std::uint16_t, 256> first_{};
  std::array<std::uint8_t, 256> ambiguous_{};
  std::array<bool, 256> needs_samples_{};
  std::vector<CellLoops> entries_;
  std::vector<std::uint16_t> first_tunnel_;  // per entry without a tunnel; one more at the end
  std::vector<Tunnel> tunnels_;
};

/// The corner of a face (axis, side) at (bit along u, bit along v).
constexpr int face_corner(int axis, int side, int bu, int bv) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return (side << axis) | (bu << u) | (bv << v);
}
/// The edge of a face (axis, side) that runs along u at v = bv.
constexpr int face_edge_along_u(int axis, int side, int bv) {
  return 4 * ((axis + 1) % 3) + bv + 2 * side;
}
/// The edge of a face (axis, side) that runs along v at u = bu.
constexpr int face_edge_along_v(int axis, int side, int bu) {
  return 4 * ((axis + 2) % 3) + side + 2 * bu;
}
/// The lower and the upper corner of an edge.
constexpr std::array<int, 2> edge_corners(int edge) {
  const int a = edge / 4, u = (a + 1) % 3, v = (a + 2) % 3;
  const int low = ((edge & 1) << u) | (((edge >> 1) & 1) << v);
  return {low, low | (1 << a)};
}

}  // namespace isoatlas::detail
