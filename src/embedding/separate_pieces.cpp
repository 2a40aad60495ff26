// SPDX-License-Identifier: Apache-2.0
#include "embedding/separate_pieces.h"

#include <cstdint>

#include "core/cancel_poll.h"
#include "core/ranges.h"
#include "embedding/subdivide.h"
#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

constexpr std::uint8_t kMaxSteps = 3;

// The pieces that intersect others.
std::vector<Piece> intersecting(std::span<const Piece> pieces, std::span<const Vec3> positions) {
  std::vector<std::uint8_t> any(pieces.size(), 0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      if (intersect_beyond_shared_simplex(positions, pieces[i].corners, pieces[j].corners))
        any[i] = any[j] = 1;
    }
  }
  std::vector<Piece> out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (any[i] != 0) out.push_back(pieces[i]);
  }
  return out;
}

}  // namespace

// First only the points of pieces that intersect move, and the others of their grid cell once that
// is not enough. Repeats, because a point on a wall is in two grid cells: grid cells with points
// that have moved are tested again.
void separate_pieces(std::span<const FreePoint> free, std::vector<Piece> pieces,
                     std::span<Vec3> positions, const RunControl& control) {
  ranges::stable_sort(pieces, std::less<>(), &Piece::grid_cell);
  std::vector<std::uint32_t> index(positions.size(), kNone);  // per c-vertex, in `free`
  for (std::uint32_t i = 0; i < free.size(); ++i) index[free[i].at] = i;
  std::vector<std::uint8_t> steps(free.size(), 0), has_moved(free.size(), 1);
  CancelPoll poll(control);
  for (bool any = true; any;) {
    any = false;
    std::vector<std::uint8_t> moves(free.size(), 0);
    for (std::size_t from = 0, to; from < pieces.size(); from = to) {
      poll.step();
      bool is_stale = false;
      for (to = from; to < pieces.size() && pieces[to].grid_cell == pieces[from].grid_cell; ++to) {
        for (const CVertexId v : pieces[to].corners)
          is_stale = is_stale || (index[v] != kNone && has_moved[index[v]] != 0);
      }
      const std::span<const Piece> in_grid_cell(pieces.data() + from, to - from);
      if (!is_stale) continue;
      const auto flatten = [&](std::span<const Piece> moving) {
        bool any_moves = false;
        for (const Piece& piece : moving) {
          for (const CVertexId v : piece.corners) {
            if (index[v] == kNone || steps[index[v]] == kMaxSteps) continue;
            moves[index[v]] = 1;
            any_moves = true;
          }
        }
        return any_moves;
      };
      const std::vector<Piece> left = intersecting(in_grid_cell, positions);
      if (!left.empty()) any = flatten(left) || flatten(in_grid_cell) || any;
    }
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (moves[i] == 0) continue;
      Vec3& p = positions[free[i].at];
      p = ++steps[i] == kMaxSteps ? free[i].flat : rounded(0.5 * (p + free[i].flat));
    }
    has_moved = std::move(moves);
  }
}

}  // namespace isoatlas::detail
