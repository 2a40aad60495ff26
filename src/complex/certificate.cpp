// SPDX-License-Identifier: Apache-2.0
// The certificate of a partition, and the dual of a certified one.
//
// Based on:
//   [edelsbrunner1997]  Triangulating topological spaces: the closed ball property.
//   [gavriliu2001]      sections 3.2 and 3.6.
// Ours: the property is checked by counting, so that a passed check is a proof. A cell is a disk
// iff it is connected and V - E + F = 1 for the part of the complex spanned by its c-vertices.
// The boundary of such a cell is one circle, and pairs and triples are counted by the ends
// of arcs: every dual triangle is an end of three arcs, every boundary side between two cells an
// end of one.
#include "complex/certificate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "core/cancel_poll.h"
#include "core/disjoint_sets.h"
#include "core/parallel.h"
#include "core/ranges.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kFacesPerChunk = 8192,
                      kCellsPerChunk = 16384;  // per piece of a parallel loop
constexpr std::int64_t kPieceWeight =
    std::int64_t{1} << 36;  // larger than twice the number of all c-vertices, sides or faces

// A counter per cell that several threads may add to. Consecutive additions are mostly to the same
// cell and are combined.
class CellCounts {
 public:
  explicit CellCounts(std::uint32_t cells) : count_(cells) {}
  std::int64_t operator[](CellId cell) const {
    return count_[cell].load(std::memory_order_relaxed);
  }

  class Adder {  // used by one thread
   public:
    explicit Adder(CellCounts& to) : to_(to) {}
    ~Adder() { flush(); }
    Adder(const Adder&) = delete;
    Adder& operator=(const Adder&) = delete;
    void add(CellId cell, std::int64_t amount) {
      if (cell != cell_) {
        flush();
        cell_ = cell;
      }
      sum_ += amount;
    }

   private:
    void flush() {
      if (sum_ != 0) to_.count_[cell_].fetch_add(std::exchange(sum_, 0), std::memory_order_relaxed);
    }
    CellCounts& to_;
    CellId cell_ = kNone;
    std::int64_t sum_ = 0;
  };

 private:
  std::vector<std::atomic<std::int64_t>> count_;
};

class CompleteCheck {
 public:
  CompleteCheck(const SurfaceComplex& complex, std::span<const CellId> cell_of, std::uint32_t cells,
                std::span<const CVertexId> site, std::span<const std::uint8_t> scope,
                const RunControl& control)
      : complex_(complex),
        cell_of_(cell_of),
        cells_(cells),
        site_(site),
        scope_(scope),
        control_(control),
        counts_(cells),
        cell_components_(complex.c_vertex_count()),
        boundary_ends_(cells, 0),
        touches_boundary_(cells, 0),
        first_(cells + 1, 0) {}

  PartitionCheck run() {
    check_.triangles =
        collect_chunks<DualTriangle>(complex_.faces.size(), kFacesPerChunk,
                                     [&](std::size_t begin, std::size_t end, auto& triangles) {
                                       control_.check_cancelled();
                                       CellCounts::Adder counts(counts_);
                                       for (std::size_t f = begin; f < end; ++f)
                                         count_face(complex_.faces[f], counts, triangles);
                                     });
    checked_id(3 * check_.triangles.size() + complex_.boundary.size(), "ends of arcs");
    for_each_chunk(cell_of_.size(), kCellsPerChunk, [&](std::size_t begin, std::size_t end) {
      control_.check_cancelled();
      CellCounts::Adder counts(counts_);
      for (auto v = static_cast<CVertexId>(begin); v < end; ++v)
        counts.add(cell_of_[v], cell_components_.is_root(v) ? kPieceWeight + 2 : 2);
    });
    count_boundary();
    control_.check_cancelled();
    run_both([&] { check_all_pairs(); }, [&] { check_cells(); });
    return std::move(check_);
  }

 private:
  bool in_scope(CellId c) const { return scope_.empty() || scope_[c] != 0; }

  // Cells must be connected through sides and chosen diagonals and have V - E + F = 1. Every side
  // is counted half from each of its faces; boundary sides get their other half in
  // count_boundary(). So all counts are doubled.
  void count_face(const Face& face, CellCounts::Adder& counts,
                  std::vector<DualTriangle>& triangles) {
    const int size = face.size();
    std::array<CellId, 4> c;
    bool wanted = scope_.empty(), is_uniform = true;
    for (int k = 0; k < size; ++k) {
      c[k] = cell_of_[face.corner[k]];
      wanted = wanted || scope_[c[k]] != 0;
      is_uniform = is_uniform && c[k] == c[0];
    }
    if (!wanted) return;
    if (is_uniform) {
      for (int k = 1; k < size; ++k) cell_components_.unite(face.corner[k - 1], face.corner[k]);
      counts.add(c[0], 2 - size);
      return;
    }
    for (int k = 0; k < size; ++k) {
      const int next = k + 1 == size ? 0 : k + 1;
      if (c[k] != c[next]) continue;
      counts.add(c[k], -1);
      cell_components_.unite(face.corner[k], face.corner[next]);
    }
    const FaceCut cut = cut_face(complex_, face, c, site_);
    if (cut.joined != kNone) {
      counts.add(cut.joined, -2);
      cell_components_.unite(face.corner[cut.joined_corner], face.corner[cut.joined_corner + 2]);
    }
    for (int k = 0; k < cut.triangles; ++k) {
      const DualTriangle& t = cut.triangle[k];
      if (in_scope(t.cell[0]) || in_scope(t.cell[1]) || in_scope(t.cell[2])) triangles.push_back(t);
    }
  }

  // Also counts the ends of arcs, by the smaller cell.
  void count_boundary() {
    for (const DualTriangle& t : check_.triangles) {
      for (int k = 0; k < 3; ++k) ++first_[std::min(t.cell[k], t.cell[(k + 1) % 3])];
    }
    CellCounts::Adder counts(counts_);
    for (const BoundarySide& s : complex_.boundary) {
      const CellId a = cell_of_[s.from], b = cell_of_[s.to];
      touches_boundary_[a] = touches_boundary_[b] = 1;
      if (a == b) {
        counts.add(a, -1);
        continue;
      }
      ++first_[std::min(a, b)];
      for (const CellId c : {a, b})
        boundary_ends_[c] = std::min<std::uint8_t>(3, boundary_ends_[c] + 1);
    }
  }

  void check_cells() {
    std::vector<std::uint8_t> has_triangle(cells_, 0);
    for (const DualTriangle& t : check_.triangles) {
      for (const CellId c : t.cell) has_triangle[c] = 1;
    }
    std::atomic<std::size_t> checked = 0;
    check_.faulty_cells = collect_chunks<FaultyCell>(
        cells_, kCellsPerChunk, [&](std::size_t begin, std::size_t end, auto& faulty) {
          control_.check_cancelled();
          std::size_t checked_here = 0;
          for (auto c = static_cast<CellId>(begin); c < end; ++c) {
            const std::int64_t count = counts_[c];
            if (count == 0 || !in_scope(c)) continue;  // no c-vertices
            ++checked_here;
            std::uint8_t fault = 0;
            if (count != kPieceWeight + 2) {
              const std::int64_t components = (count + kPieceWeight / 2) / kPieceWeight;
              if (components != 1) fault |= kNotConnected;
              if (count != components * kPieceWeight + 2) fault |= kNotADisk;
            }
            if (!has_triangle[c]) fault |= kNoTriangle;
            if (touches_boundary_[c] &&
                (boundary_ends_[c] != 2 || (!site_.empty() && !complex_.on_boundary[site_[c]])))
              fault |= kBadBoundary;
            if (fault != 0) faulty.push_back({c, fault});
          }
          checked += checked_here;
        });
    check_.cells = checked;
  }

  // Groups the ends by the smaller cell. Filling moves first_[c] to the end of the group of c.
  void sort_ends() {
    CancelPoll poll(control_);
    std::uint32_t total = 0;
    for (std::uint32_t& f : first_) total += std::exchange(f, total);
    ends_.resize(total);
    for (const DualTriangle& t : check_.triangles) {
      poll.step();
      for (int k = 0; k < 3; ++k) {
        const CellId a = t.cell[k], b = t.cell[(k + 1) % 3];
        ends_[first_[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), t.cell[(k + 2) % 3]};
      }
    }
    for (const BoundarySide& s : complex_.boundary) {
      const CellId a = cell_of_[s.from], b = cell_of_[s.to];
      if (a != b) ends_[first_[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), kNone};
    }
  }

  void check_all_pairs() {
    sort_ends();
    std::vector<PartitionCheck> parts((cells_ + kCellsPerChunk - 1) / kCellsPerChunk);
    for_each_index(parts.size(), 1, &control_, [&](std::size_t i) {
      const std::size_t last = std::min<std::size_t>(cells_, (i + 1) * kCellsPerChunk);
      const std::uint32_t start = i == 0 ? 0 : first_[i * kCellsPerChunk - 1];
      std::uint32_t from = start;
      for (std::size_t c = i * kCellsPerChunk; c < last; from = first_[c++]) {
        if (from != first_[c])
          std::sort(ends_.begin() + from, ends_.begin() + first_[c],
                    [](const ArcEnd& a, const ArcEnd& b) { return a.high < b.high; });
      }
      check_pairs(
          std::span(ends_).subspan(start, from - start),
          [&](CellId a, CellId b) { return in_scope(a) || in_scope(b); }, parts[i]);
    });
    for (const PartitionCheck& part : parts) {
      check_.pairs += part.pairs;
      check_.pair_faults.insert(check_.pair_faults.end(), part.pair_faults.begin(),
                                part.pair_faults.end());
    }
  }

  const SurfaceComplex& complex_;
  std::span<const CellId> cell_of_;
  std::uint32_t cells_;
  std::span<const CVertexId> site_;
  std::span<const std::uint8_t> scope_;
  const RunControl& control_;
  CellCounts
      counts_;  // per cell, twice V - E + F, plus kPieceWeight times the number of its components
  DisjointSets cell_components_;  // joins the c-vertices of each component of a cell
  std::vector<std::uint8_t>
      boundary_ends_;  // per cell, number of boundary sides that leave it; 3 stands for more
  std::vector<std::uint8_t> touches_boundary_;
  std::vector<std::uint32_t> first_;  // per cell, index of its ends of arcs
  std::vector<ArcEnd> ends_;
  PartitionCheck check_;
};

}  // namespace

PartitionCheck check_partition(const SurfaceComplex& complex, std::span<const CellId> cell_of,
                               std::uint32_t cells, std::span<const CVertexId> site,
                               std::span<const std::uint8_t> scope, const RunControl& control) {
  return CompleteCheck(complex, cell_of, cells, site, scope, control).run();
}

std::uint8_t PartitionCheck::fault_of(CellId cell) const {
  const auto found = ranges::lower_bound(faulty_cells, cell, {}, &FaultyCell::cell);
  return found != faulty_cells.end() && found->cell == cell ? found->fault : 0;
}

void fill_report(const PartitionCheck& check, CertificateReport& report) {
  report.passed = check.passed();
  report.cells_checked = check.cells;
  report.arcs_checked = check.pairs;
  report.triples_checked = check.triangles.size();
}

SurfaceComplex dual_complex(const SurfaceComplex& complex, const Partition& partition,
                            std::span<const DualTriangle> triangles) {
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
    for (const CellId c : {a, b})
      out.on_boundary[c] =
          std::max<std::uint8_t>(kOnBoundary, complex.on_boundary[partition.site[c]]);
  }
  return out;
}

}  // namespace isoatlas::detail
