// SPDX-License-Identifier: Apache-2.0
// Volume to surface complex.
//
// Based on:
//   [gavriliu2001]   section 3.2: surfels, nodes, c-vertices and their neighbourhood.
//   [nielson1991]    The asymptotic decider: resolving the ambiguity in marching cubes.
// Ours: everything is decided on sign bits, 64 samples at a time, so that the volume is read once
// and the rest of the cost is that of the surface; the zero-thickness layer; the splitting of
// double segments.
//
// Cells are those of the volume extended by one clamped sample on every side: cell (cx, cy, cz), 0
// <= cx <= nx, lies between extended samples cx and cx + 1, and extended sample s is sample clamp(s
// - 1). A cell of the outer layer has no thickness.
#include "isosurface/parse_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/saddle_sign.h"
#include "core/vector_math.h"
#include "field/field.h"
#include "field/upsampled_field.h"
#include "geometry/box_faces.h"
#include "isosurface/cell_loops.h"
#include "isosurface/cell_points.h"
#include "isosurface/contains_tunnel.h"
#include "isosurface/split_faces.h"

namespace isoatlas::detail {
namespace {

struct CrossedCell {         // a grid cell that the surface crosses
  std::uint32_t x;           // position in its row
  CVertexId first_c_vertex;  // relative to its slice
  FaceId first_face;  // relative to its slice; faces of the nodes on the three edges at its lowest
                      // corner
  std::uint16_t loops;  // index into CellLoopTable
};

struct DoubleFace {  // an ambiguous grid face with two segments that both connect the same two
                     // surfels
  std::uint32_t cell;
  std::uint32_t neighbour;
  int axis;
  std::size_t cy, cz;
};

struct TunnelCell {
  std::uint32_t cell;
  std::size_t cy, cz;
};

struct Slice {  // all grid cells with one cz
  CVertexId first_c_vertex = 0;
  FaceId first_face = 0;
  std::size_t c_vertices = 0, faces = 0;
  std::vector<BoundarySide> boundary;
  std::vector<VerticalNode> nodes;
  std::vector<DoubleFace> double_faces;
  std::vector<TunnelCell> tunnel_cells;
};

// The volume's own samples; UpsampledField also has those in between.
template <class T>
class VolumeField : public Field<T> {
 public:
  VolumeField(const VolumeView& volume, const InsideRule& rule)
      : Field<T>(volume, rule), size_(volume.grid.size) {}
  static constexpr bool kAnyRange = std::is_same_v<T, double>;
  const std::array<std::size_t, 3>& size() const { return size_; }
  std::array<double, 64> around(const std::array<std::size_t, 3>& low,
                                const std::array<bool, 3>& flat) const {
    const auto along = [&](std::size_t a) {
      return flat[a] ? std::array{low[a], low[a], low[a], low[a]} : cubic_samples(low[a], size_[a]);
    };
    return values_around(*this, size_, {along(0), along(1), along(2)});
  }

 private:
  std::array<std::size_t, 3> size_;
};

// Rounds coordinates within a grid cell, so that adding the cell's index is exact and a position
// does not depend on where the volume begins: blocks have the same positions on shared faces.
Vec3 rounded_in_cell(Vec3 p) {
  constexpr double kScale = 0x1p32;
  const auto round = [](double x) { return std::round(x * kScale) / kScale; };
  return {round(p.x), round(p.y), round(p.z)};
}

template <class Samples>
class Parser {
 public:
  Parser(const Samples& samples, Vec3 spacing, const ParseOptions& options,
         const RunControl& control, const SignBits& signs, std::vector<VerticalNode>* nodes)
      : size_(samples.size()),
        spacing_(spacing),
        options_(options),
        control_(control),
        signs_(signs),
        field_(samples),
        table_(CellLoopTable::get()),
        nodes_(nodes),
        outside_row_(options.closed ? signs.words : 0, 0) {}

  SurfaceComplex run() {
    find_cells();
    classify_cells();
    complex_.spacing = spacing_;
    complex_.positions.resize(c_vertices_);
    complex_.on_boundary.assign(c_vertices_, 0);
    complex_.faces.resize(faces_);
    for_each_chunk(slices_.size(), 1, [&](std::size_t z0, std::size_t z1) {
      for (std::size_t cz = z0; cz < z1; ++cz) {
        control_.check_cancelled();
        place_c_vertices(cz);
        make_faces(cz);
      }
    });
    control_.check_cancelled();
    for (const Slice& s : slices_) {
      complex_.boundary.insert(complex_.boundary.end(), s.boundary.begin(), s.boundary.end());
      if (nodes_ != nullptr) nodes_->insert(nodes_->end(), s.nodes.begin(), s.nodes.end());
    }
    split_irregular_faces();
    if (has_shared_faces()) mark_shared_c_vertices();
    complex_.positions.shrink_to_fit();
    complex_.on_boundary.shrink_to_fit();
    complex_.faces.shrink_to_fit();
    return std::move(complex_);
  }

 private:
  std::size_t sample_of(std::size_t extended, int axis) const {
    return extended == 0 ? 0 : std::min(extended - 1, size_[static_cast<std::size_t>(axis)] - 1);
  }
  // Whether a cell is in the layer around the volume and its far side counts as outside.
  bool is_cap(const std::array<std::size_t, 3>& c) const {
    return options_.closed &&
           (is_in_layer(c[0], 0) || is_in_layer(c[1], 1) || is_in_layer(c[2], 2));
  }
  bool is_in_layer(std::size_t c, int axis) const {
    return c == 0 || c == size_[static_cast<std::size_t>(axis)];
  }
  std::size_t row_of(std::size_t cy, std::size_t cz) const { return cy + (size_[1] + 1) * cz; }

  // Calls f(cx) for every crossed cell of a row, in order.
  template <class F>
  void for_each_crossed_cell(std::size_t cy, std::size_t cz, F f) const {
    const auto rows = sign_rows(cy, cz);
    const std::size_t cells = size_[0] + 1;
    std::uint64_t any = 0, all = 0;
    const auto load = [&](std::size_t w) {
      any = rows[0][w] | rows[1][w] | rows[2][w] | rows[3][w];
      all = rows[0][w] & rows[1][w] & rows[2][w] & rows[3][w];
    };
    load(0);
    for (std::size_t w = 0; 64 * w < cells; ++w) {
      const std::uint64_t any_here = any, all_here = all;
      any = all = 0;
      if (w + 1 < signs_.words) load(w + 1);
      std::uint64_t crossed =
          (any_here | any_here >> 1 | any << 63) & ~(all_here & (all_here >> 1 | all << 63));
      if (64 * (w + 1) > cells) crossed &= (std::uint64_t{1} << (cells - 64 * w)) - 1;
      for (; crossed != 0; crossed &= crossed - 1)
        f(64 * w + static_cast<std::size_t>(std::countr_zero(crossed)));
    }
  }

  // Of extended samples.
  const std::uint64_t* sign_row(std::size_t y, std::size_t z) const {
    if (options_.closed && (y == 0 || y > size_[1] || z == 0 || z > size_[2]))
      return outside_row_.data();
    return signs_.row(sample_of(y, 1), sample_of(z, 2));
  }
  std::array<const std::uint64_t*, 4> sign_rows(std::size_t cy, std::size_t cz) const {
    return {sign_row(cy, cz), sign_row(cy + 1, cz), sign_row(cy, cz + 1), sign_row(cy + 1, cz + 1)};
  }

  void find_cells() {
    const std::size_t rows_y = size_[1] + 1, slices = size_[2] + 1;
    row_first_.assign(rows_y * slices + 1, 0);
    for_each_chunk(slices, 1, [&](std::size_t z0, std::size_t z1) {
      for (std::size_t cz = z0; cz < z1; ++cz) {
        control_.check_cancelled();
        for (std::size_t cy = 0; cy < rows_y; ++cy) {
          std::uint32_t n = 0;
          for_each_crossed_cell(cy, cz, [&](std::size_t) { ++n; });
          row_first_[row_of(cy, cz) + 1] = n;
        }
      }
    });
    std::size_t total = 0;
    for (std::uint32_t& n : row_first_) {
      total += n;
      n = checked_id(total, "cells crossed by the surface");
    }
    cells_.resize(total);
    slices_.resize(slices);
  }

  std::array<std::size_t, 8> sample_indices(std::size_t cx, std::size_t cy, std::size_t cz) const {
    const std::array<std::size_t, 2> x{sample_of(cx, 0), sample_of(cx + 1, 0)};
    const std::array<std::size_t, 2> y{sample_of(cy, 1), sample_of(cy + 1, 1)};
    const std::array<std::size_t, 2> z{sample_of(cz, 2), sample_of(cz + 1, 2)};
    std::array<std::size_t, 8> out;
    for (std::size_t c = 0; c < 8; ++c)
      out[c] = x[c & 1] + size_[0] * (y[c >> 1 & 1] + size_[1] * z[c >> 2]);
    return out;
  }

  CellValues values(const std::array<std::size_t, 3>& c) const {
    const auto in_range = [](const auto& f) { return Samples::kAnyRange ? rescaled(f) : f; };
    CellValues out;
    if (options_.interpolation == Interpolation::tricubic && !is_cap(c)) {
      // In the layer around the volume the field is constant across the layer.
      const std::array<double, 64> f = in_range(
          field_.around({sample_of(c[0], 0), sample_of(c[1], 1), sample_of(c[2], 2)},
                        {is_in_layer(c[0], 0), is_in_layer(c[1], 1), is_in_layer(c[2], 2)}));
      for (std::size_t k = 0; k < 8; ++k) out.corner[k] = f[TricubicCell::corner(k)];
      out.cubic.emplace(f);
    } else {
      const std::array<std::size_t, 8> sample = sample_indices(c[0], c[1], c[2]);
      std::array<double, 8> f;
      for (std::size_t k = 0; k < 8; ++k) f[k] = field_[sample[k]];
      out.corner = in_range(f);
    }
    return out;
  }

  // The ambiguous faces of a cell whose inside corners are joined: those where the saddle of the
  // bilinear interpolant is inside.
  std::uint8_t decide_faces(std::uint8_t corners, const std::array<std::size_t, 8>& sample) const {
    unsigned joined = 0;
    for (unsigned rest = table_.ambiguous_faces(corners); rest != 0; rest &= rest - 1) {
      const int face = std::countr_zero(rest), axis = face / 2, side = face % 2;
      const auto exact = [&](int bu, int bv) {
        return field_.exact(sample[face_corner(axis, side, bu, bv)]);
      };
      const int sign =
          saddle_sign(exact(0, 0), exact(1, 1), exact(1, 0), exact(0, 1), field_.isovalue());
      const bool first_diagonal_inside = (corners >> face_corner(axis, side, 0, 0)) & 1;
      if (first_diagonal_inside ? sign >= 0 : sign <= 0) joined |= 1u << face;
    }
    return static_cast<std::uint8_t>(joined);
  }

  // The cell's entry in the table with the tunnel between two of its loops, if it has one.
  std::uint16_t decide_tunnel(std::uint16_t loops, const std::array<std::size_t, 8>& sample) const {
    const auto inside_above = [&](const ExactSample& x) {
      return options_.rule.inside == Inside::above ? x : -x;
    };
    std::array<ExactSample, 8> f;
    for (std::size_t k = 0; k < 8; ++k) f[k] = inside_above(field_.exact(sample[k]));
    for (const Tunnel& tunnel : table_.tunnels(loops)) {
      if (contains_tunnel(tunnel, f, inside_above(field_.isovalue()))) return tunnel.entry;
    }
    return loops;
  }

  // The nodes on the three edges at a cell's lowest corner that have a face: those on edges of the
  // original grid.
  unsigned owned_nodes(const CellLoops& loops, std::size_t cx, std::size_t cy,
                       std::size_t cz) const {
    const unsigned crossed =
        (loops.crossed & 1u) | (loops.crossed >> 4 & 1u) << 1 | (loops.crossed >> 8 & 1u) << 2;
    if (options_.closed) return crossed;  // includes edges across the layer
    const unsigned possible = (cy >= 1 && cz >= 1 ? 1u : 0) | (cz >= 1 && cx >= 1 ? 2u : 0) |
                              (cx >= 1 && cy >= 1 ? 4u : 0);
    return crossed & possible;
  }

  void classify_cells() {
    for_each_chunk(slices_.size(), 1, [&](std::size_t z0, std::size_t z1) {
      for (std::size_t cz = z0; cz < z1; ++cz) {
        control_.check_cancelled();
        Slice& slice = slices_[cz];
        for (std::size_t cy = 0; cy <= size_[1]; ++cy) {
          std::uint32_t i = row_first_[row_of(cy, cz)];
          const auto rows = sign_rows(cy, cz);
          for_each_crossed_cell(cy, cz, [&](std::size_t cx) {
            unsigned corners = 0;
            for (unsigned r = 0; r < 4; ++r) {
              const std::size_t w = cx >> 6, b = cx & 63;
              std::uint64_t two_bits = rows[r][w] >> b;
              if (b == 63) two_bits |= rows[r][w + 1] << 1;
              corners |= static_cast<unsigned>(two_bits & 3) << (2 * r);
            }
            const auto signs = static_cast<std::uint8_t>(corners);
            std::uint16_t loops = table_.first_index(signs);
            if (table_.needs_samples(signs)) {
              const std::array<std::size_t, 8> sample = sample_indices(cx, cy, cz);
              loops = table_.index(signs, decide_faces(signs, sample));
              if (options_.topology == Topology::trilinear && !is_cap({cx, cy, cz}) &&
                  !table_.tunnels(loops).empty()) {
                loops = decide_tunnel(loops, sample);
                if (table_[loops].has_tunnel) slice.tunnel_cells.push_back({i, cy, cz});
              }
            }
            cells_[i++] = {static_cast<std::uint32_t>(cx), static_cast<CVertexId>(slice.c_vertices),
                           static_cast<FaceId>(slice.faces), loops};
            slice.c_vertices += table_[loops].surfels;
            slice.faces +=
                static_cast<std::size_t>(std::popcount(owned_nodes(table_[loops], cx, cy, cz)));
          });
        }
      }
    });
    control_.check_cancelled();
    std::size_t c_vertices = 0, faces = 0;
    for (Slice& s : slices_) {
      s.first_c_vertex = checked_id(c_vertices, "c-vertices");
      s.first_face = checked_id(faces, "faces");
      c_vertices += s.c_vertices;
      faces += s.faces;
    }
    c_vertices_ = checked_id(c_vertices, "c-vertices");
    faces_ = checked_id(faces, "faces");
  }

  void place_c_vertices(std::size_t cz) {
    const CVertexId first = slices_[cz].first_c_vertex;
    for (std::size_t cy = 0; cy <= size_[1]; ++cy) {
      for (std::uint32_t i = row_first_[row_of(cy, cz)]; i < row_first_[row_of(cy, cz) + 1]; ++i) {
        const CrossedCell& cell = cells_[i];
        const CellLoops& loops = table_[cell.loops];
        const std::array<std::size_t, 3> c{cell.x, cy, cz};
        const CellValues f = values(c);

        std::array<Vec3, kMaxSurfels> sum{};
        std::array<int, kMaxSurfels> nodes{};
        for (unsigned rest = loops.crossed; rest != 0; rest &= rest - 1) {
          const int e = std::countr_zero(rest);
          const std::size_t surfel = loops.surfel_of_edge[e];
          sum[surfel] = sum[surfel] + node_in_cell(f, e);
          ++nodes[surfel];
        }
        if (loops.has_tunnel) {
          for (unsigned rest = cut_edges(loops); rest != 0; rest &= rest - 1) {
            const int e = std::countr_zero(rest);
            const std::size_t surfel = loops.other_surfel_of_edge[e];
            sum[surfel] = sum[surfel] + node_in_cell(f, e);
            ++nodes[surfel];
          }
        }
        std::array<double, 3> low, width;
        bool layer = false;
        for (int a = 0; a < 3; ++a) {
          low[a] = static_cast<double>(sample_of(c[a], a));
          width[a] = is_in_layer(c[a], a) ? 0 : 1;
          layer |= width[a] == 0;
        }
        // Two curves on a wall on the volume boundary are disjoint, as the samples determine them.
        // Splines may cross, so c-vertices there stay at the averages of the nodes, whose chords do
        // not.
        const bool keep_average = is_cap(c) || (f.cubic && layer && loops.surfels > 1);
        for (std::size_t surfel = 0; surfel < loops.surfels; ++surfel) {
          Vec3 p = (1.0 / nodes[surfel]) * sum[surfel];
          if (loops.has_tunnel)
            p = clamp_off_walls(p);  // all nodes of a surfel of an annulus may be on one wall
          if (options_.vertices_on_surface && !keep_average) p = onto_surface(f, p, spacing_);
          const CVertexId id = first + cell.first_c_vertex + static_cast<CVertexId>(surfel);
          p = rounded_in_cell(p);
          complex_.positions[id] = {low[0] + width[0] * p.x, low[1] + width[1] * p.y,
                                    low[2] + width[2] * p.z};
          complex_.on_boundary[id] = layer && !options_.closed;
        }
      }
    }
  }

  CVertexId c_vertex(const CrossedCell& cell, std::size_t cz, int edge) const {
    return slices_[cz].first_c_vertex + cell.first_c_vertex +
           table_[cell.loops].surfel_of_edge[edge];
  }
  // The c-vertex of the surfel with the node's segment on the cell's face normal to face_axis.
  CVertexId c_vertex(const CrossedCell& cell, std::size_t cz, int edge, int face_axis) const {
    return slices_[cz].first_c_vertex + cell.first_c_vertex +
           table_[cell.loops].surfel(edge, face_axis);
  }

  // Makes one face per node. A node is handled by the cell at whose lowest corner its grid edge
  // starts; the three other cells around it are earlier in scan order and are found by cursors that
  // advance with this row.
  void make_faces(std::size_t cz) {
    Slice& slice = slices_[cz];
    FaceId next = slice.first_face;
    for (std::size_t cy = 0; cy <= size_[1]; ++cy) {
      // Cursors: first cell at or after cx in the rows (cy-1, cz), (cy, cz-1), (cy-1, cz-1).
      std::array<const CrossedCell*, 3> cursor{}, end{};
      const auto set_cursor = [&](int k, bool exists, std::size_t y, std::size_t z) {
        if (!exists) return;
        cursor[k] = cells_.data() + row_first_[row_of(y, z)];
        end[k] = cells_.data() + row_first_[row_of(y, z) + 1];
      };
      set_cursor(0, cy > 0, cy - 1, cz);
      set_cursor(1, cz > 0, cy, cz - 1);
      set_cursor(2, cy > 0 && cz > 0, cy - 1, cz - 1);

      for (std::uint32_t i = row_first_[row_of(cy, cz)]; i < row_first_[row_of(cy, cz) + 1]; ++i) {
        const CrossedCell& cell = cells_[i];
        for (int k = 0; k < 3; ++k) {
          while (cursor[k] != end[k] && cursor[k]->x < cell.x) ++cursor[k];
        }
        const CellLoops& loops = table_[cell.loops];
        const std::array<std::size_t, 3> c{cell.x, cy, cz};
        const unsigned owned = owned_nodes(loops, cell.x, cy, cz);
        // The neighbour in -x; it exists whenever a shared node refers to it.
        const auto previous_in_row = [&] { return cells_.data() + (i - 1); };
        if (owned & 1) {  // x-edge: u = y, v = z
          make_face(next++, 0, c, loops,
                    {c_vertex(*cursor[2], cz - 1, 3), c_vertex(*cursor[1], cz - 1, 2),
                     c_vertex(cell, cz, 0), c_vertex(*cursor[0], cz, 1)},
                    slice);
        }
        if (owned & 2) {  // y-edge: u = z, v = x
          make_face(next++, 1, c, loops,
                    {c_vertex(*(cursor[1] - 1), cz - 1, 7), c_vertex(*previous_in_row(), cz, 6),
                     c_vertex(cell, cz, 4), c_vertex(*cursor[1], cz - 1, 5)},
                    slice);
        }
        if (owned & 4) {  // z-edge: u = x, v = y
          make_face(next++, 2, c, loops,
                    {c_vertex(*(cursor[0] - 1), cz, 11), c_vertex(*cursor[0], cz, 10),
                     c_vertex(cell, cz, 8), c_vertex(*previous_in_row(), cz, 9)},
                    slice);
        }
        if (loops.double_faces & 0b010101) {
          for (int axis = 0; axis < 3; ++axis) {
            // In a cell of the outer layer the two segments of a face are on two loops; so the
            // lower neighbour exists.
            if (!((loops.double_faces >> (2 * axis)) & 1)) continue;
            const CrossedCell* const lower =
                axis == 0 ? previous_in_row() : cursor[static_cast<std::size_t>(axis - 1)];
            if ((table_[lower->loops].double_faces >> (2 * axis + 1)) & 1) {
              slice.double_faces.push_back(
                  {i, static_cast<std::uint32_t>(lower - cells_.data()), axis, cy, cz});
            }
          }
        }
      }
    }
  }

  // @param corner  the c-vertices around the node in the cells (u-,v-), (u+,v-), (u+,v+), (u-,v+)
  void make_face(FaceId id, int axis, const std::array<std::size_t, 3>& c, const CellLoops& loops,
                 std::array<CVertexId, 4> corner, Slice& slice) {
    const bool outside_is_up =
        loops.corners & 1;  // the edge starts inside, so the surface faces its upper end
    const std::size_t u = static_cast<std::size_t>((axis + 1) % 3),
                      v = static_cast<std::size_t>((axis + 2) % 3);
    const auto side = [&](int from, int to) {
      slice.boundary.push_back(outside_is_up ? BoundarySide{corner[from], corner[to]}
                                             : BoundarySide{corner[to], corner[from]});
    };
    if (!options_.closed) {
      if (c[v] == 1) side(0, 1);
      if (c[u] == size_[u]) side(1, 2);
      if (c[v] == size_[v]) side(2, 3);
      if (c[u] == 1) side(3, 0);
    }
    if (axis == 2 && nodes_ != nullptr) {
      const auto sample = [&](int a) {
        return static_cast<std::uint32_t>(c[static_cast<std::size_t>(a)] - 1);
      };
      slice.nodes.push_back({sample(0), sample(1), sample(2), corner[0], outside_is_up});
    }
    if (!outside_is_up) std::swap(corner[1], corner[3]);
    complex_.faces[id].corner = corner;
  }

  const CrossedCell& find_cell(std::size_t cx, std::size_t cy, std::size_t cz) const {
    const auto first = cells_.begin() + row_first_[row_of(cy, cz)],
               last = cells_.begin() + row_first_[row_of(cy, cz) + 1];
    return *std::lower_bound(first, last, cx,
                             [](const CrossedCell& cell, std::size_t x) { return cell.x < x; });
  }

  void split_irregular_faces() {
    std::vector<SplitNode> nodes;
    std::vector<SegmentMidpoint> midpoints;
    for (const Slice& slice : slices_) {
      control_.check_cancelled();
      for (const DoubleFace& d : slice.double_faces) split_double_segments(d, nodes, midpoints);
      for (const TunnelCell& t : slice.tunnel_cells) {
        const std::array<std::size_t, 3> c{cells_[t.cell].x, t.cy, t.cz};
        const CellValues f = values(c);
        for (unsigned rest = cut_edges(table_[cells_[t.cell].loops]); rest != 0; rest &= rest - 1) {
          nodes.push_back(node_on(c, f, std::countr_zero(rest), true));
        }
        ++complex_.tunnels;
      }
    }
    if (has_shared_faces()) split_at_shared_nodes(nodes);
    split_faces(complex_, std::move(nodes), std::move(midpoints), control_);
  }

  bool has_shared_faces() const {
    return ranges::any_of(options_.shared, [](const auto& s) { return s[0] || s[1]; });
  }
  void mark_shared_c_vertices() {
    const auto last = [&](std::size_t a) { return static_cast<double>(size_[a] - 1); };
    const BoxFaces box{{last(0), last(1), last(2)}};
    const unsigned shared = bits_of(options_.shared);
    for (CVertexId v = 0; v < complex_.c_vertex_count(); ++v) {
      if (complex_.on_boundary[v] != kInterior &&
          (box.containing(complex_.positions[v]) & shared) != 0)
        complex_.on_boundary[v] = kOnSharedFace;
    }
  }

  // Whether the lower corner of a cell is a sample of a face that another block has, too, which is
  // normal to the axis.
  bool is_on_shared_face(std::size_t at, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return (options_.shared[a][0] && at == 1) || (options_.shared[a][1] && at == size_[a]);
  }

  void split_at_shared_nodes(std::vector<SplitNode>& nodes) const {
    for (std::size_t cz = 0; cz <= size_[2]; ++cz) {
      control_.check_cancelled();
      for (std::size_t cy = 0; cy <= size_[1]; ++cy) {
        const bool in_row = is_on_shared_face(cy, 1), in_slice = is_on_shared_face(cz, 2);
        for (std::uint32_t i = row_first_[row_of(cy, cz)]; i < row_first_[row_of(cy, cz) + 1];
             ++i) {
          const CrossedCell& cell = cells_[i];
          const std::array<bool, 3> on{is_on_shared_face(cell.x, 0), in_row, in_slice};
          const std::array<std::size_t, 3> c{cell.x, cy, cz};
          const unsigned owned = owned_nodes(table_[cell.loops], cell.x, cy, cz);
          for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            if (((owned >> axis) & 1) != 0 && (on[(a + 1) % 3] || on[(a + 2) % 3]))
              nodes.push_back(node_on(c, values(c), 4 * axis, false));
          }
        }
      }
    }
  }

  void split_double_segments(const DoubleFace& d, std::vector<SplitNode>& nodes,
                             std::vector<SegmentMidpoint>& midpoints) {
    const CrossedCell& cell = cells_[d.cell];
    const CellLoops& loops = table_[cell.loops];
    const int axis = d.axis;
    const std::array<std::size_t, 3> c{cell.x, d.cy, d.cz};
    const CVertexId a = c_vertex(cell, d.cz, face_edge_along_u(axis, 0, 0), axis);
    const CVertexId b = c_vertex(cells_[d.neighbour], axis == 2 ? d.cz - 1 : d.cz,
                                 face_edge_along_u(axis, 1, 0), axis);
    const CellValues f = values(c);
    const bool around_inside = !((loops.joined_faces >> (2 * axis)) & 1);
    for (int bu = 0; bu < 2; ++bu) {
      for (int bv = 0; bv < 2; ++bv) {
        if (((loops.corners >> face_corner(axis, 0, bu, bv)) & 1) != (around_inside ? 1 : 0))
          continue;
        const SplitNode on_u = node_on(c, f, face_edge_along_u(axis, 0, bv), false),
                        on_v = node_on(c, f, face_edge_along_v(axis, 0, bu), false);
        const CVertexId id = add_c_vertex(complex_, 0.5 * (on_u.position + on_v.position));
        for (const SplitNode& node : {on_u, on_v}) {
          nodes.push_back(node);
          midpoints.push_back({node.face, a, b, id});
        }
      }
    }
    ++complex_.double_segments;
  }

  // The node on an edge of cell c with the values f.
  SplitNode node_on(std::array<std::size_t, 3> c, const CellValues& f, int edge,
                    bool is_cut) const {
    const Vec3 p = rounded_in_cell(node_in_cell(f, edge));
    const auto along = [&](int axis, double x) {
      const std::size_t at = c[static_cast<std::size_t>(axis)];
      const double low = static_cast<double>(sample_of(at, axis));
      return is_in_layer(at, axis) ? low : low + x;
    };
    const Vec3 position{along(0, p.x), along(1, p.y), along(2, p.z)};
    const int axis = edge / 4;
    c[static_cast<std::size_t>((axis + 1) % 3)] += edge & 1;
    c[static_cast<std::size_t>((axis + 2) % 3)] += edge >> 1 & 1;
    const CrossedCell& cell = find_cell(c[0], c[1], c[2]);
    const unsigned owned = owned_nodes(table_[cell.loops], c[0], c[1], c[2]);
    const auto before = static_cast<FaceId>(std::popcount(owned & ((1u << axis) - 1)));
    const auto on_volume_boundary = [&](std::size_t a) {
      return static_cast<std::uint8_t>(!options_.closed && (c[a] == 1 || c[a] == size_[a]));
    };
    const std::vector<CVertexId> corners =
        is_cut ? corners_around(axis, c) : std::vector<CVertexId>();
    return {slices_[c[2]].first_face + cell.first_face + before,
            is_cut,
            {on_volume_boundary(0), on_volume_boundary(1), on_volume_boundary(2)},
            axis,
            position,
            corners};
  }

  // The c-vertices around the node on the grid edge along `axis` at the lower corner of cell `at`,
  // counter-clockwise as seen from outside: one for each of the four cells in the order of
  // make_face(), two for a cell whose annulus is cut at the node.
  std::vector<CVertexId> corners_around(int axis, const std::array<std::size_t, 3>& at) const {
    const auto u = static_cast<std::size_t>((axis + 1) % 3),
               v = static_cast<std::size_t>((axis + 2) % 3);
    std::vector<CVertexId> corners;
    bool outside_is_up = false;
    for (const int k : {0, 1, 2, 3}) {
      const std::size_t du = k == 0 || k == 3, dv = k == 0 || k == 1;
      std::array<std::size_t, 3> c = at;
      c[u] -= du;
      c[v] -= dv;
      const CrossedCell& cell = find_cell(c[0], c[1], c[2]);
      const int edge = 4 * axis + static_cast<int>(du + 2 * dv);
      outside_is_up = (table_[cell.loops].corners >> edge_corners(edge)[0]) & 1;
      // Goes from cell 0 to cell 1 across the face normal to u, to cell 2 across the one normal to
      // v, and so on.
      const auto into = static_cast<int>(k % 2 == 0 ? v : u),
                 out_of = static_cast<int>(k % 2 == 0 ? u : v);
      const CVertexId first = c_vertex(cell, c[2], edge, into),
                      second = c_vertex(cell, c[2], edge, out_of);
      corners.push_back(first);
      if (second != first) corners.push_back(second);
    }
    if (!outside_is_up) std::reverse(corners.begin() + 1, corners.end());
    return corners;
  }

  std::array<std::size_t, 3> size_;
  Vec3 spacing_;
  const ParseOptions& options_;
  const RunControl& control_;
  const SignBits& signs_;
  const Samples& field_;
  const CellLoopTable& table_;
  std::vector<VerticalNode>* nodes_;  // none: nodes are not collected
  std::vector<std::uint64_t>
      outside_row_;  // the signs of a row beyond the volume boundary, for a closed surface

  std::vector<std::uint32_t> row_first_;  // per row (cy, cz), its first cell; one more at the end
  std::vector<CrossedCell> cells_;        // crossed cells in scan order
  std::vector<Slice> slices_;
  CVertexId c_vertices_ = 0;
  FaceId faces_ = 0;
  SurfaceComplex complex_;
};

// Sets the repeated samples at both ends of every row to outside.
void clear_row_ends(SignBits& signs, std::size_t row_samples) {
  const std::size_t last = row_samples + 1;
  for (std::size_t first = 0; first < signs.bits.size(); first += signs.words) {
    signs.bits[first] &= ~std::uint64_t{1};
    signs.bits[first + last / 64] &= ~(std::uint64_t{1} << last % 64);
  }
}

}  // namespace

SurfaceComplex parse_surface(const VolumeView& volume, const ParseOptions& options,
                             const RunControl& control, std::vector<VerticalNode>* nodes) {
  SurfaceComplex empty;
  empty.spacing = (1.0 / options.supersample) * volume.grid.spacing;
  const auto parse = [&](const auto& samples, SignBits& signs) {
    if (options.closed) clear_row_ends(signs, samples.size()[0]);
    return Parser(samples, empty.spacing, options, control, signs, nodes).run();
  };
  const auto has_surface = [&](const SignBits& signs) {
    return signs.any_inside && (signs.any_outside || options.closed);
  };
  if (options.supersample > 1) {
    const UpsampledField samples(volume, options.rule, options.interpolation, options.supersample);
    SignBits signs = samples.classify(control);
    return has_surface(signs) ? parse(samples, signs) : empty;
  }
  SignBits signs = classify(volume, options.rule, control);
  if (!has_surface(signs)) return empty;
  return visit_sample_type(volume.type, [&]<class T>(const T*) {
    return parse(VolumeField<T>(volume, options.rule), signs);
  });
}

}  // namespace isoatlas::detail
