// SPDX-License-Identifier: Apache-2.0
// The certificate of a partition, and the dual of a certified one.
//
// Based on:
//   [edelsbrunner1997]  Triangulating topological spaces: the closed ball property.
//   [gavriliu2001]      sections 3.2 and 3.6.
// Ours: the property is checked by counting, so that a passed check is a proof. A cell is a disk iff it is connected and
// V - E + F = 1 for the part of the complex spanned by its c-vertices. Given that, all borders of a cell form one circle, and
// pairs and triples are counted by the ends of arcs: every dual triangle is an end of three arcs, every boundary side between
// two cells an end of one.
#include "partition/certificate.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/cancel_poll.h"
#include "core/disjoint_sets.h"

namespace isoatlas {
PartitionCheck check_partition(const SurfaceComplex& complex, std::span<const CellId> cell_of, std::uint32_t cells,
                               std::span<const CVertexId> site, std::span<const std::uint8_t> scope, const RunControl& control) {
  const std::uint32_t n = complex.c_vertex_count();
  const bool all = scope.empty();
  const auto in_scope = [&](CellId c) { return all || scope[c] != 0; };
  PartitionCheck check;

  // Cells: connected through sides and chosen diagonals, and V - E + F = 1. Every side is counted half from each of its
  // faces, boundary sides get their other half below; so all counts are doubled.
  std::vector<std::int64_t> twice_euler(cells, 0);
  DisjointSets pieces(n);
  for (CVertexId v = 0; v < n; ++v) twice_euler[cell_of[v]] += 2;
  CancelPoll poll(control);
  for (const Face& face : complex.faces) {
    poll.step();
    const int size = face.size();
    std::array<CellId, 4> c;
    bool wanted = all;
    for (int k = 0; k < size; ++k) {
      c[k] = cell_of[face.corner[k]];
      wanted = wanted || scope[c[k]] != 0;
    }
    if (!wanted) continue;
    bool whole = true;
    for (int k = 0; k < size; ++k) {
      const int next = k + 1 == size ? 0 : k + 1;
      if (c[k] != c[next]) {
        whole = false;
        continue;
      }
      twice_euler[c[k]] -= 1;
      pieces.unite(face.corner[k], face.corner[next]);
    }
    if (whole) {
      twice_euler[c[0]] += 2;
      continue;
    }
    const FaceCut cut = cut_face(complex, face, c, site);
    if (cut.joined != kNone) {
      twice_euler[cut.joined] -= 2;
      pieces.unite(face.corner[cut.joined_corner], face.corner[cut.joined_corner + 2]);
    }
    for (int k = 0; k < cut.triangles; ++k) {
      const DualTriangle& t = cut.triangle[k];
      if (in_scope(t.cell[0]) || in_scope(t.cell[1]) || in_scope(t.cell[2])) check.triangles.push_back(t);
    }
  }

  control.check_cancelled();
  checked_id(3 * check.triangles.size() + complex.boundary.size(), "ends of arcs");
  std::vector<std::uint8_t> boundary_ends(cells, 0);  // boundary sides that leave the cell, up to 3 (= too many)
  std::vector<std::uint8_t> touches_boundary(cells, 0);
  std::vector<std::uint32_t> first(cells + 1, 0);  // buckets of arc ends by the smaller cell
  for (const DualTriangle& t : check.triangles) {
    for (int k = 0; k < 3; ++k) ++first[std::min(t.cell[k], t.cell[(k + 1) % 3])];
  }
  for (const BoundarySide& s : complex.boundary) {
    const CellId a = cell_of[s.from], b = cell_of[s.to];
    touches_boundary[a] = touches_boundary[b] = 1;
    if (a == b) {
      twice_euler[a] -= 1;
      continue;
    }
    ++first[std::min(a, b)];
    for (const CellId c : {a, b}) boundary_ends[c] = std::min<std::uint8_t>(3, boundary_ends[c] + 1);
  }

  std::vector<std::uint8_t> has_triangle(cells, 0), is_split(cells, 0);
  for (const DualTriangle& t : check.triangles) {
    for (const CellId c : t.cell) has_triangle[c] = 1;
  }
  std::vector<CVertexId> root(cells, kNone);
  for (CVertexId v = 0; v < n; ++v) {
    poll.step();
    const CellId c = cell_of[v];
    const CVertexId r = pieces.find(v);
    if (root[c] == kNone) root[c] = r;
    if (root[c] != r) is_split[c] = 1;
  }
  for (CellId c = 0; c < cells; ++c) {
    if (root[c] == kNone || !in_scope(c)) continue;
    ++check.cells;
    std::uint8_t fault = is_split[c] ? kNotConnected : 0;
    if (twice_euler[c] != 2) fault |= kNotADisk;
    if (!has_triangle[c]) fault |= kNoTriangle;
    if (touches_boundary[c] && (boundary_ends[c] != 2 || (!site.empty() && !complex.on_boundary[site[c]]))) fault |= kBadBoundary;
    if (fault != 0) check.faulty_cells.push_back({c, fault});
  }

  // Pairs and triples, by arc ends in buckets.
  control.check_cancelled();
  std::uint32_t total = 0;
  for (std::uint32_t& f : first) total += std::exchange(f, total);
  std::vector<ArcEnd> ends(total);
  for (const DualTriangle& t : check.triangles) {
    poll.step();
    for (int k = 0; k < 3; ++k) {
      const CellId a = t.cell[k], b = t.cell[(k + 1) % 3];
      ends[first[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), t.cell[(k + 2) % 3]};
    }
  }
  for (const BoundarySide& s : complex.boundary) {
    const CellId a = cell_of[s.from], b = cell_of[s.to];
    if (a != b) ends[first[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), kNone};
  }
  for (CellId c = 0; c < cells; ++c) {  // filling moved first[c] to the end of bucket c
    poll.step();
    const std::uint32_t from = c == 0 ? 0 : first[c - 1], to = first[c];
    if (from == to) continue;
    std::sort(ends.begin() + from, ends.begin() + to, [](const ArcEnd& a, const ArcEnd& b) { return a.high < b.high; });
  }
  judge_pairs(ends, [&](CellId a, CellId b) { return in_scope(a) || in_scope(b); }, check);
  return check;
}

std::uint8_t PartitionCheck::fault_of(CellId cell) const {
  const auto found = std::ranges::lower_bound(faulty_cells, cell, {}, &FaultyCell::cell);
  return found != faulty_cells.end() && found->cell == cell ? found->fault : 0;
}

void record(const PartitionCheck& check, CertificateReport& report) {
  report.passed = check.passed();
  report.cells_checked = check.cells;
  report.arcs_checked = check.pairs;
  report.triples_checked = check.triangles.size();
}

SurfaceComplex dual_complex(const SurfaceComplex& complex, const Partition& partition, std::span<const DualTriangle> triangles) {
  SurfaceComplex out;
  const std::uint32_t n = partition.cell_count();
  out.spacing = complex.spacing;
  out.positions.resize(n);
  out.on_boundary.assign(n, 0);
  for (CellId c = 0; c < n; ++c) out.positions[c] = complex.positions[partition.site[c]];
  out.faces.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& c = triangles[i].cell;
    out.faces[i].corner = {c[0], c[1], c[2], kNone};
  }
  for (const BoundarySide& s : complex.boundary) {
    const CellId a = partition.cell_of[s.from], b = partition.cell_of[s.to];
    if (a == b) continue;
    out.boundary.push_back({a, b});
    out.on_boundary[a] = out.on_boundary[b] = 1;
  }
  return out;
}

}  // namespace isoatlas
