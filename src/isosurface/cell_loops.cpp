// SPDX-License-Identifier: Apache-2.0
// Loops of cells, and the tunnels that may join two of them; the argument is in
// docs/theory/01-surface.md.
#include "isosurface/cell_loops.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

struct Segment {
  int to;    // index of an edge
  int face;  // on which the segment from node to node lies
};

using SegmentsOfEdge = std::array<std::array<Segment, 2>, 12>;

bool is_inside(const CellLoops& cell, int corner) { return (cell.corners >> corner) & 1; }
bool is_crossed(const CellLoops& cell, int edge) { return (cell.crossed >> edge) & 1; }
bool is_joined(const CellLoops& cell, int face) { return (cell.joined_faces >> face) & 1; }

// Every crossed edge has one segment on each of its two faces.
SegmentsOfEdge segments_of(const CellLoops& cell) {
  SegmentsOfEdge segments;
  std::array<std::size_t, 12> count{};
  for (int face = 0; face < 6; ++face) {
    const auto link = [&](int e, int f) {
      segments[e][count[e]++] = {f, face};
      segments[f][count[f]++] = {e, face};
    };
    const int axis = face / 2, side = face % 2;
    if ((cell.ambiguous_faces >> face) & 1) {
      // Two segments, each around one corner: around the outside corners if the inside corners are
      // joined, otherwise around the inside corners.
      for (int bu = 0; bu < 2; ++bu) {
        for (int bv = 0; bv < 2; ++bv) {
          if (is_inside(cell, face_corner(axis, side, bu, bv)) != is_joined(cell, face)) {
            link(face_edge_along_u(axis, side, bv), face_edge_along_v(axis, side, bu));
          }
        }
      }
    } else {
      int ends[2], n = 0;
      for (int b = 0; b < 2; ++b) {
        for (const int e : {face_edge_along_u(axis, side, b), face_edge_along_v(axis, side, b)}) {
          if (is_crossed(cell, e)) ends[n++] = e;
        }
      }
      if (n == 2) link(ends[0], ends[1]);
    }
  }
  return segments;
}

struct LoopNode {
  int edge;
  int face;  // of the segment to the next node
};
using Loop = std::vector<LoopNode>;

std::vector<Loop> loops_of(const CellLoops& cell) {
  const SegmentsOfEdge segments = segments_of(cell);
  std::vector<Loop> loops;
  std::uint16_t left = cell.crossed;
  while (left != 0) {
    Loop& loop = loops.emplace_back();
    const int start = std::countr_zero(left);
    int at = start, from = -1;
    do {
      left = static_cast<std::uint16_t>(left & ~(1u << at));
      // A loop may use both segments between the same two edges only if it has two nodes, which
      // cannot happen in a cube.
      const Segment next = segments[at][0].to != from ? segments[at][0] : segments[at][1];
      loop.push_back({at, next.face});
      from = at;
      at = next.to;
    } while (at != start);
  }
  return loops;
}

void find_double_faces(CellLoops& cell) {
  for (int face = 0; face < 6; ++face) {
    if (!((cell.ambiguous_faces >> face) & 1)) continue;
    const int axis = face / 2, side = face % 2;
    bool one = true;
    const auto first = cell.surfel(face_edge_along_u(axis, side, 0), axis);
    for (const int e : {face_edge_along_u(axis, side, 1), face_edge_along_v(axis, side, 0),
                        face_edge_along_v(axis, side, 1)}) {
      one &= cell.surfel(e, axis) == first;
    }
    if (one) cell.double_faces = static_cast<std::uint8_t>(cell.double_faces | (1u << face));
  }
}

CellLoops cell_with(std::uint8_t corners, std::uint8_t ambiguous, std::uint8_t joined) {
  CellLoops cell;
  cell.corners = corners;
  cell.ambiguous_faces = ambiguous;
  cell.joined_faces = static_cast<std::uint8_t>(joined & ambiguous);
  for (int e = 0; e < 12; ++e) {
    const auto [low, high] = edge_corners(e);
    if (is_inside(cell, low) != is_inside(cell, high))
      cell.crossed = static_cast<std::uint16_t>(cell.crossed | (1u << e));
  }
  for (const Loop& loop : loops_of(cell)) {
    for (const LoopNode& node : loop)
      cell.surfel_of_edge[node.edge] = cell.other_surfel_of_edge[node.edge] = cell.loops;
    ++cell.loops;
  }
  cell.surfels = cell.loops;
  find_double_faces(cell);
  return cell;
}

// A cell is swept along an axis below. A "vertical" edge is one along this axis; its bits are its
// position along the other two.
struct Sweep {
  const CellLoops& cell;
  int axis;

  int corner(int vertical, int side) const {
    return face_corner(axis, side, vertical & 1, vertical >> 1);
  }
  bool changes(int vertical, int side, bool inside) const {
    return is_inside(cell, corner(vertical, side)) != inside;
  }

  // At one end (side 0: the lower one) of the heights where the corners of both diagonals have
  // opposite signs: whether the slice's saddle joins the ring there. Corners that have another sign
  // at the cell's end change it on the way, one by one; the last one to do so disappears there, and
  // its neighbours are joined.
  bool ring_is_joined(const Tunnel& t, int side) const {
    bool any_changes = false;
    for (int k = 0; k < 2; ++k)
      any_changes |= changes(t.joined[k], side, t.inside) || changes(t.ring[k], side, !t.inside);
    if (!any_changes) return is_joined(cell, 2 * axis + side) != t.inside;
    return std::any_of(t.joined.begin(), t.joined.end(), [&](int j) {
      if (!changes(j, side, t.inside)) return false;
      return std::all_of(t.ring.begin(), t.ring.end(), [&](int r) {
        if (!changes(r, side, !t.inside)) return true;
        // Then the face that contains both is ambiguous. Between the two changes it has the ring's
        // sign if j changes last.
        const int face =
            (j ^ r) == 1 ? 2 * ((axis + 2) % 3) + (j >> 1) : 2 * ((axis + 1) % 3) + (j & 1);
        return is_joined(cell, face) != t.inside;
      });
    });
  }

  bool admits(const Tunnel& t) const {
    for (int k = 0; k < 2; ++k) {  // no vertical edge changes twice
      if (changes(t.joined[k], 0, t.inside) && changes(t.joined[k], 1, t.inside)) return false;
      if (changes(t.ring[k], 0, !t.inside) && changes(t.ring[k], 1, !t.inside)) return false;
    }
    return ring_is_joined(t, 0) && ring_is_joined(t, 1);
  }
};

// Per corner, the smallest corner that it is connected with on the boundary of the cell.
std::array<int, 8> regions_of(const CellLoops& cell) {
  std::array<int, 8> region{0, 1, 2, 3, 4, 5, 6, 7};
  const auto join = [&](int a, int b) {
    const int from = std::max(region[a], region[b]), to = std::min(region[a], region[b]);
    std::replace(region.begin(), region.end(), from, to);
  };
  for (int e = 0; e < 12; ++e) {
    const auto [low, high] = edge_corners(e);
    if (!is_crossed(cell, e)) join(low, high);
  }
  for (int face = 0; face < 6; ++face) {
    if (!((cell.ambiguous_faces >> face) & 1)) continue;
    const auto corner = [&](int bu, int bv) { return face_corner(face / 2, face % 2, bu, bv); };
    if (is_inside(cell, corner(0, 0)) == is_joined(cell, face)) {
      join(corner(0, 0), corner(1, 1));
    } else {
      join(corner(1, 0), corner(0, 1));
    }
  }
  return region;
}

// The loops at the two ends of a tunnel, the smaller index first: they separate the regions that it
// joins from that of the ring.
std::optional<std::array<std::size_t, 2>> loops_at_ends(const Sweep& sweep,
                                                        const std::vector<Loop>& loops,
                                                        const Tunnel& t) {
  const std::array<int, 8> region = regions_of(sweep.cell);
  const auto region_of = [&](int vertical, bool inside) {
    const int side = sweep.changes(vertical, 0, inside) ? 1 : 0;
    return region[static_cast<std::size_t>(sweep.corner(vertical, side))];
  };
  const int ring = region_of(t.ring[0], !t.inside);
  std::array<std::size_t, 2> out{};
  for (std::size_t end = 0; end < 2; ++end) {
    const int joined = region_of(t.joined[end], t.inside);
    out[end] = loops.size();
    for (std::size_t k = 0; k < loops.size(); ++k) {
      const auto [low, high] = edge_corners(loops[k].front().edge);
      if (std::minmax(region[low], region[high]) == std::minmax(joined, ring)) out[end] = k;
    }
  }
  std::sort(out.begin(), out.end());
  if (region_of(t.ring[1], !t.inside) != ring || out[1] == loops.size() || out[0] == out[1])
    return {};
  return out;
}

struct PossibleTunnel {
  Tunnel tunnel;
  std::array<std::size_t, 2> ends;  // loops
};

std::vector<PossibleTunnel> possible_tunnels(const Sweep& sweep, const std::vector<Loop>& loops) {
  std::vector<PossibleTunnel> out;
  for (const bool inside : {false, true}) {
    for (const bool swapped : {false, true}) {
      Tunnel t{{0, 3}, {1, 2}, inside, 0};
      if (swapped) std::swap(t.joined, t.ring);
      if (!sweep.admits(t)) continue;
      if (const auto ends = loops_at_ends(sweep, loops, t)) out.push_back({t, *ends});
    }
  }
  return out;
}

// The tunnels along z that are also found by sweeps along the other axes.
std::vector<PossibleTunnel> possible_tunnels(const CellLoops& cell,
                                             const std::vector<Loop>& loops) {
  std::vector<PossibleTunnel> out = possible_tunnels(Sweep{cell, 2}, loops);
  for (const int axis : {0, 1}) {
    const std::vector<PossibleTunnel> others = possible_tunnels(Sweep{cell, axis}, loops);
    std::erase_if(out, [&](const PossibleTunnel& a) {
      return std::none_of(others.begin(), others.end(), [&](const PossibleTunnel& b) {
        return a.tunnel.inside == b.tunnel.inside && a.ends == b.ends;
      });
    });
  }
  return out;
}

Vec3 corner_position(int corner) {
  return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1),
          static_cast<double>(corner >> 2)};
}

Vec3 midpoint(int edge) {
  const auto [low, high] = edge_corners(edge);
  return 0.5 * (corner_position(low) + corner_position(high));
}

// In reversed order, the face of a node's segment is that of the previous node.
Loop reversed(const Loop& loop) {
  Loop out;
  for (std::size_t k = loop.size(); k-- > 0;)
    out.push_back({loop[k].edge, loop[(k + loop.size() - 1) % loop.size()].face});
  return out;
}

// As seen from outside the cell.
bool has_inside_on_the_left(const CellLoops& cell, const Loop& loop) {
  const int edge = loop[0].edge, face = loop[0].face;
  Vec3 normal;
  (face / 2 == 0 ? normal.x : face / 2 == 1 ? normal.y : normal.z) = face % 2 == 0 ? -1 : 1;
  const auto [low, high] = edge_corners(edge);
  const Vec3 towards_inside = corner_position(is_inside(cell, low) ? low : high) - midpoint(edge);
  return dot(cross(normal, midpoint(loop[1].edge) - midpoint(edge)), towards_inside) > 0;
}

// The cell with the annulus between two of its loops cut into surfels, one per node of the shorter
// loop: each is bounded by a segment of that loop, a cut, one or more segments of the longer loop
// and a cut.
CellLoops with_annulus(CellLoops cell, const std::vector<Loop>& loops,
                       std::array<std::size_t, 2> ends) {
  cell.has_tunnel = true;
  cell.double_faces = 0;
  cell.surfels = 0;
  const auto assign = [&](const LoopNode& node, std::size_t surfel_after,
                          std::size_t surfel_before) {
    const bool first_is_after = node.face / 2 == (node.edge / 4 + 1) % 3;
    cell.surfel_of_edge[node.edge] =
        static_cast<std::uint8_t>(first_is_after ? surfel_after : surfel_before);
    cell.other_surfel_of_edge[node.edge] =
        static_cast<std::uint8_t>(first_is_after ? surfel_before : surfel_after);
  };
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (k == ends[0] || k == ends[1]) continue;
    for (const LoopNode& node : loops[k]) assign(node, cell.surfels, cell.surfels);
    ++cell.surfels;
  }

  if (loops[ends[0]].size() > loops[ends[1]].size()) std::swap(ends[0], ends[1]);
  // As boundaries of the annulus the two loops run in opposite directions.
  const Loop& a = loops[ends[0]];
  const bool same_direction =
      has_inside_on_the_left(cell, a) == has_inside_on_the_left(cell, loops[ends[1]]);
  const Loop b = same_direction ? reversed(loops[ends[1]]) : loops[ends[1]];
  const auto cut = [&](std::size_t i) {
    return i * b.size() / a.size();
  };  // node i of a is cut to this node of b, rotated by `rotation`
  std::size_t rotation = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < b.size(); ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += squared_length(midpoint(a[i].edge) - midpoint(b[(cut(i) + k) % b.size()].edge));
    if (sum < smallest) {
      smallest = sum;
      rotation = k;
    }
  }
  const std::size_t first = cell.surfels;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t surfel = first + i, before = first + (i + a.size() - 1) % a.size();
    assign(a[i], surfel, before);
    for (std::size_t k = cut(i); k < cut(i + 1); ++k) {
      const LoopNode& node = b[(k + rotation) % b.size()];
      assign(node, surfel, k == cut(i) ? before : surfel);
    }
  }
  cell.surfels = static_cast<std::uint8_t>(first + a.size());
  find_double_faces(cell);
  return cell;
}

}  // namespace

CellLoopTable::CellLoopTable() {
  for (int corners = 0; corners < 256; ++corners) {
    std::uint8_t ambiguous = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const auto bit = [&](int bu, int bv) {
          return (corners >> face_corner(axis, side, bu, bv)) & 1;
        };
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
        if ((ambiguous >> face) & 1)
          joined = static_cast<std::uint8_t>(joined | (((decisions >> bit++) & 1u) << face));
      }
      entries_.push_back(cell_with(static_cast<std::uint8_t>(corners), ambiguous, joined));
    }
  }
  const std::size_t plain_count = entries_.size();
  for (std::size_t i = 0; i < plain_count; ++i) {
    first_tunnel_.push_back(static_cast<std::uint16_t>(tunnels_.size()));
    const CellLoops cell = entries_[i];
    if (cell.ambiguous_faces != 0) needs_samples_[cell.corners] = true;
    if (cell.loops < 2) continue;
    const std::vector<Loop> loops = loops_of(cell);
    for (auto [tunnel, ends] : possible_tunnels(cell, loops)) {
      tunnel.entry = static_cast<std::uint16_t>(entries_.size());
      tunnels_.push_back(tunnel);
      needs_samples_[cell.corners] = true;
      entries_.push_back(with_annulus(cell, loops, ends));
    }
  }
  first_tunnel_.push_back(static_cast<std::uint16_t>(tunnels_.size()));
}

const CellLoopTable& CellLoopTable::get() {
  static const CellLoopTable table;
  return table;
}

}  // namespace isoatlas::detail
