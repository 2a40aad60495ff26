// SPDX-License-Identifier: Apache-2.0
// How the isosurface crosses one cell: which crossed edges (nodes) belong to which closed loop (surfel).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace isoatlas {

// Numbering used everywhere in the surface module, axis a = 0, 1, 2 with u = (a + 1) % 3 and v = (a + 2) % 3:
//   corner  x + 2 y + 4 z
//   edge    4 a + (bit along u) + 2 (bit along v): the four edges along axis a
//   face    2 a + side: the two faces normal to axis a

struct CellLoops {
  std::uint8_t corners = 0;                     ///< bit per corner, 1 = inside
  std::uint8_t loops = 0;                       ///< number of surfels, 0 to 4
  std::uint8_t ambiguous_faces = 0;             ///< bit per face with diagonal signs
  std::uint8_t joined_faces = 0;                ///< of those, the ones whose inside corners are joined
  std::uint16_t crossed = 0;                    ///< bit per edge that carries a node
  std::array<std::uint8_t, 12> loop_of_edge{};  ///< for crossed edges
};

/// All ways to cross a cell: 256 sign patterns times the decisions on their ambiguous faces, made by walking from node to
/// node along face segments, not by a hand-written table.
class CellLoopTable {
 public:
  static const CellLoopTable& get();

  /// `joined_faces` need only be right on the ambiguous faces.
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
  std::uint16_t first_index(std::uint8_t corners) const { return first_[corners]; }
  const CellLoops& operator[](std::uint16_t index) const { return entries_[index]; }
  const std::vector<CellLoops>& entries() const { return entries_; }

 private:
  CellLoopTable();
  std::array<std::uint16_t, 256> first_{};
  std::array<std::uint8_t, 256> ambiguous_{};
  std::vector<CellLoops> entries_;
};

/// The corner of a face (axis, side) at (bit along u, bit along v).
constexpr int face_corner(int axis, int side, int bu, int bv) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return (side << axis) | (bu << u) | (bv << v);
}
/// The edge of a face (axis, side) that runs along u at v = bv.
constexpr int face_edge_along_u(int axis, int side, int bv) { return 4 * ((axis + 1) % 3) + bv + 2 * side; }
/// The edge of a face (axis, side) that runs along v at u = bu.
constexpr int face_edge_along_v(int axis, int side, int bu) { return 4 * ((axis + 2) % 3) + side + 2 * bu; }
/// The lower and the upper corner of an edge.
constexpr std::array<int, 2> edge_corners(int edge) {
  const int a = edge / 4, u = (a + 1) % 3, v = (a + 2) % 3;
  const int low = ((edge & 1) << u) | (((edge >> 1) & 1) << v);
  return {low, low | (1 << a)};
}

}  // namespace isoatlas
