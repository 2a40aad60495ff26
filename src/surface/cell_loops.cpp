// SPDX-License-Identifier: Apache-2.0
#include "surface/cell_loops.h"

#include <bit>

namespace isoatlas {
namespace {

// The loops of one cell: every crossed edge has one segment in each of the two faces beside it; follow them around.
CellLoops walk(std::uint8_t corners, std::uint8_t ambiguous, std::uint8_t joined) {
  CellLoops out;
  out.corners = corners;
  out.ambiguous_faces = ambiguous;
  out.joined_faces = static_cast<std::uint8_t>(joined & ambiguous);
  const auto inside = [&](int corner) { return (corners >> corner) & 1; };
  const auto crossed = [&](int edge) {
    const auto [low, high] = edge_corners(edge);
    return inside(low) != inside(high);
  };
  for (int e = 0; e < 12; ++e) {
    if (crossed(e)) out.crossed = static_cast<std::uint16_t>(out.crossed | (1u << e));
  }

  std::array<std::array<int, 2>, 12> linked;  // per crossed edge, the other ends of its two segments
  std::array<int, 12> links{};
  const auto link = [&](int e, int f) {
    linked[e][links[e]++] = f;
    linked[f][links[f]++] = e;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if ((ambiguous >> (2 * axis + side)) & 1) {
        // Two segments, each around one corner: the outside corners if the inside ones are joined, else the inside ones.
        const bool around_inside = !((joined >> (2 * axis + side)) & 1);
        for (int bu = 0; bu < 2; ++bu) {
          for (int bv = 0; bv < 2; ++bv) {
            if (inside(face_corner(axis, side, bu, bv)) == (around_inside ? 1 : 0)) {
              link(face_edge_along_u(axis, side, bv), face_edge_along_v(axis, side, bu));
            }
          }
        }
      } else {
        int ends[2], n = 0;
        for (int b = 0; b < 2; ++b) {
          for (const int e : {face_edge_along_u(axis, side, b), face_edge_along_v(axis, side, b)}) {
            if (crossed(e)) ends[n++] = e;
          }
        }
        if (n == 2) link(ends[0], ends[1]);
      }
    }
  }

  std::uint16_t left = out.crossed;
  while (left != 0) {
    const int start = std::countr_zero(left);
    int at = start, from = -1;
    do {
      out.loop_of_edge[at] = out.loops;
      left = static_cast<std::uint16_t>(left & ~(1u << at));
      // A loop may use both segments between the same two edges only if it has two nodes, which cannot happen in a cube.
      const int to = linked[at][0] != from ? linked[at][0] : linked[at][1];
      from = at;
      at = to;
    } while (at != start);
    ++out.loops;
  }
  return out;
}

}  // namespace

CellLoopTable::CellLoopTable() {
  for (int corners = 0; corners < 256; ++corners) {
    std::uint8_t ambiguous = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const auto bit = [&](int bu, int bv) { return (corners >> face_corner(axis, side, bu, bv)) & 1; };
        if (bit(0, 0) == bit(1, 1) && bit(1, 0) == bit(0, 1) && bit(0, 0) != bit(1, 0)) {
          ambiguous = static_cast<std::uint8_t>(ambiguous | (1u << (2 * axis + side)));
        }
      }
    }
    ambiguous_[corners] = ambiguous;
    first_[corners] = static_cast<std::uint16_t>(entries_.size());
    const int faces = std::popcount(ambiguous);
    for (unsigned decisions = 0; decisions < (1u << faces); ++decisions) {
      std::uint8_t joined = 0;
      int bit = 0;
      for (int face = 0; face < 6; ++face) {
        if ((ambiguous >> face) & 1) joined = static_cast<std::uint8_t>(joined | (((decisions >> bit++) & 1u) << face));
      }
      entries_.push_back(walk(static_cast<std::uint8_t>(corners), ambiguous, joined));
    }
  }
}

const CellLoopTable& CellLoopTable::get() {
  static const CellLoopTable table;
  return table;
}

}  // namespace isoatlas
