// SPDX-License-Identifier: Apache-2.0
// Certified coarser complexes by blocks.
//
// Ours: space is cut into blocks; a region is a connected piece of the surface within one block
// (union-find over sides, no distances). Regions that fail the certificate are split by blocks of
// half the size, down to single c-vertices, until all pass. With every c-vertex its own region the
// dual is the complex itself, which is simplicial, so this ends.
#include "complex/coarsen.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "complex/area_vectors.h"
#include "complex/cell_members.h"
#include "complex/certificate.h"
#include "complex/scoped_check.h"
#include "core/cancel_poll.h"
#include "core/disjoint_sets.h"
#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "geometry/inverted_components.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kPerChunk = 16384;  // c-vertices or faces, of a parallel loop

// The region of a c-vertex is identified by its smallest c-vertex while regions are split. There
// are only as many rounds as halvings, and most regions are split in the first ones, so each round
// is a few passes over everything.
class BlockRegions {
 public:
  BlockRegions(const SurfaceComplex& complex, double block_length)
      : complex_(complex),
        sets_(complex.c_vertex_count()),
        region_(complex.c_vertex_count()),
        block_(complex.c_vertex_count()),
        level_(complex.c_vertex_count(), 0),
        members_(complex.c_vertex_count()),
        failed_(complex.c_vertex_count(), 0),
        was_split_(complex.c_vertex_count(), 0) {
    const Vec3 s = complex.spacing;
    scale_ = {s.x / block_length, s.y / block_length, s.z / block_length};
    const double smallest = std::min({s.x, s.y, s.z});
    levels_ = 1 + std::max(0, static_cast<int>(std::ceil(std::log2(block_length / smallest))));
    for_each_index(complex.c_vertex_count(), kPerChunk,
                   [&](std::size_t v) { block_[v] = block_at(static_cast<CVertexId>(v), 0); });
    for_each_index(complex.faces.size(), kPerChunk, [&](std::size_t f) {
      for_each_side(complex.faces[f], [&](CVertexId a, CVertexId b) {
        if (block_[a] == block_[b]) sets_.unite(a, b);
      });
    });
    label_regions();
  }

  std::span<const CellId> region_of() const { return region_; }

  // Splits the faulty regions; for two regions whose common arcs are faulty, the one with more
  // c-vertices.
  // @return false if there was nothing left to split
  bool split(const PartitionCheck& check) {
    std::fill(failed_.begin(), failed_.end(), std::uint8_t{0});
    for (const FaultyCell& f : check.faulty_cells) failed_[f.cell] = members_[f.cell] > 1;
    for (const PairFault& p : check.pair_faults) {
      if (failed_[p.a] || failed_[p.b]) continue;
      const CellId larger = members_[p.b] > members_[p.a] ? p.b : p.a;
      if (members_[larger] > 1) {
        failed_[larger] = 1;
      } else {
        faulty_single_pairs_.push_back(p);
      }
    }
    if (!faulty_single_pairs_.empty()) split_around_pairs();
    if (std::find(failed_.begin(), failed_.end(), std::uint8_t{1}) == failed_.end()) return false;
    split_failed(1);
    return true;
  }

  // Splits regions into single c-vertices. @return false if they all are single already
  bool split_completely(std::span<const std::uint8_t> regions) {
    for (CellId r = 0; r < regions.size(); ++r) failed_[r] = regions[r] && members_[r] > 1;
    if (std::find(failed_.begin(), failed_.end(), std::uint8_t{1}) == failed_.end()) return false;
    split_failed(levels_);
    return true;
  }

  // Per region, 1 if it shares a face with a c-vertex whose region was split last time: only these
  // may have become faulty or correct.
  std::vector<std::uint8_t> near_last_split() const {
    std::vector<std::atomic<std::uint8_t>> is_near(complex_.c_vertex_count());
    for_each_index(complex_.faces.size(), kPerChunk, [&](std::size_t f) {
      const Face& face = complex_.faces[f];
      const auto corners = std::span(face.corner).first(static_cast<std::size_t>(face.size()));
      if (ranges::none_of(corners, [&](CVertexId v) { return was_split_[v] != 0; })) return;
      for (const CVertexId v : corners) is_near[region_[v]].store(1, std::memory_order_relaxed);
    });
    return {is_near.begin(), is_near.end()};
  }

 private:
  // Splits every failed region by blocks whose side is halved `halvings` times.
  void split_failed(int halvings) {
    for_each_index(complex_.c_vertex_count(), kPerChunk, [&](std::size_t i) {
      const auto v = static_cast<CVertexId>(i);
      was_split_[v] = failed_[region_[v]];
      if (!was_split_[v]) return;
      sets_.reset(v);
      level_[v] = static_cast<std::uint8_t>(std::min(level_[v] + halvings, levels_));
      block_[v] = block_at(v, level_[v]);
    });
    for_each_index(complex_.faces.size(), kPerChunk, [&](std::size_t f) {
      const Face& face = complex_.faces[f];
      if (!was_split_[face.corner[0]] && !was_split_[face.corner[1]] && !was_split_[face.corner[2]])
        return;
      for_each_side(face, [&](CVertexId a, CVertexId b) {
        if (region_[a] == region_[b] && was_split_[a] && level_[a] < levels_ &&
            block_[a] == block_[b])
          sets_.unite(a, b);
      });
    });
    label_regions();
  }

  template <class F>
  static void for_each_side(const Face& face, F f) {
    f(face.corner[0], face.corner[1]);
    f(face.corner[1], face.corner[2]);
    if (face.is_triangle()) {
      f(face.corner[2], face.corner[0]);
    } else {
      f(face.corner[2], face.corner[3]);
      f(face.corner[3], face.corner[0]);
    }
  }

  std::uint64_t block_at(CVertexId v, int level) const {
    if (complex_.on_boundary[v] == kOnSharedFace) return kSingle | v;
    const Vec3 p = scaled(complex_.positions[v], scale_);
    const double halvings = std::ldexp(1.0, level);
    const auto index = [&](double x) {
      return static_cast<std::uint64_t>(x * halvings) & 0x1FFFFFu;
    };
    return index(p.x) | index(p.y) << 21 | index(p.z) << 42;
  }

  void label_regions() {
    for_each_index(complex_.c_vertex_count(), kPerChunk,
                   [&](std::size_t v) { region_[v] = sets_.find(static_cast<CVertexId>(v)); });
    std::fill(members_.begin(), members_.end(), 0u);
    for (const CellId r : region_) ++members_[r];
  }

  // If the arcs of two single c-vertices are faulty, the regions around them are the cause: splits
  // every region that they share a face with.
  void split_around_pairs() {
    std::vector<std::uint8_t> is_involved(complex_.c_vertex_count(), 0);
    for (const PairFault& p : faulty_single_pairs_) is_involved[p.a] = is_involved[p.b] = 1;
    for (const Face& face : complex_.faces) {
      const int size = face.size();
      const bool touched = std::any_of(face.corner.begin(), face.corner.begin() + size,
                                       [&](CVertexId v) { return is_involved[region_[v]]; });
      if (!touched) continue;
      for (int k = 0; k < size; ++k) {
        const CellId r = region_[face.corner[k]];
        if (members_[r] > 1) failed_[r] = 1;
      }
    }
    faulty_single_pairs_.clear();
  }

  const SurfaceComplex& complex_;
  DisjointSets sets_;
  std::vector<CellId> region_;           // per c-vertex
  std::vector<std::uint64_t> block_;     // per c-vertex, its block at its region's level
  std::vector<std::uint8_t> level_;      // per c-vertex, the number of halvings of its region
  std::vector<std::uint32_t> members_;   // per region
  std::vector<std::uint8_t> failed_;     // per region
  std::vector<std::uint8_t> was_split_;  // per c-vertex, 1 if its region was split last time
  std::vector<PairFault> faulty_single_pairs_;
  // Of a c-vertex that is always a region of its own; other block numbers have 63 bits.
  static constexpr std::uint64_t kSingle = std::uint64_t{1} << 63;
  Vec3 scale_;      // blocks per unit of the sample index
  int levels_ = 1;  // from this level on, regions are single c-vertices
};

// Numbers regions in the order of their smallest c-vertices, and chooses for each the c-vertex
// nearest its centroid, on the boundary if the region touches the boundary.
Partition with_representatives(const SurfaceComplex& complex, std::span<const CellId> region_of) {
  const std::uint32_t n = complex.c_vertex_count();
  Partition out;
  out.cell_of.resize(n);
  std::vector<Vec3> centroid;
  std::vector<std::uint32_t> members;
  std::vector<std::uint8_t> on_boundary;
  for (CVertexId v = 0; v < n; ++v) {
    if (region_of[v] == v) {
      out.cell_of[v] = static_cast<CellId>(centroid.size());
      centroid.emplace_back();
      members.push_back(0);
      on_boundary.push_back(0);
    } else {
      out.cell_of[v] = out.cell_of[region_of[v]];
    }
    const CellId c = out.cell_of[v];
    centroid[c] = centroid[c] + complex.positions[v];
    ++members[c];
    on_boundary[c] |= complex.on_boundary[v];
  }
  for (std::size_t c = 0; c < centroid.size(); ++c) centroid[c] = (1.0 / members[c]) * centroid[c];
  out.site.assign(centroid.size(), kNone);
  std::vector<double> best(centroid.size());
  for (CVertexId v = 0; v < n; ++v) {
    const CellId c = out.cell_of[v];
    if (on_boundary[c] && !complex.on_boundary[v]) continue;
    const double d = squared_distance(complex.positions[v], centroid[c], complex.spacing);
    if (out.site[c] == kNone || d < best[c]) {
      best[c] = d;
      out.site[c] = v;
    }
  }
  return out;
}

// Finds inverted components among those of few regions: only their topology has been checked so
// far. Larger components are not tested.
// @return per region (identified by a c-vertex), 1 if it belongs to an inverted component
std::vector<std::uint8_t> inverted_small_components(const SurfaceComplex& complex,
                                                    std::span<const CellId> region_of,
                                                    std::span<const DualTriangle> triangles) {
  constexpr std::uint32_t kMaxSmallRegions = 32;
  constexpr double kMinCosine = 0.5;  // well above 0, so that later stages can move vertices
  const std::uint32_t n = complex.c_vertex_count();
  DisjointSets sets(n);
  for_each_index(triangles.size(), kPerChunk, [&](std::size_t i) {
    const DualTriangle& t = triangles[i];
    sets.unite(t.cell[0], t.cell[1]);
    sets.unite(t.cell[1], t.cell[2]);
  });
  std::vector<std::uint32_t> regions(n, 0);  // per component, identified by a region
  for (CVertexId v = 0; v < n; ++v) {
    if (region_of[v] == v) ++regions[sets.find(v)];
  }
  std::vector<std::uint8_t> out(n, 0);
  const auto is_small = [&](CellId region) {
    return regions[sets.find(region)] <= kMaxSmallRegions;
  };
  if (std::none_of(region_of.begin(), region_of.end(), is_small)) return out;

  const std::vector<Vec3> outward = area_vectors(complex, region_of, n);
  const Partition partition = with_representatives(complex, region_of);
  std::vector<Vec3> position(n);
  for (const CVertexId site : partition.site) position[region_of[site]] = complex.positions[site];
  std::vector<Triangle> small_triangles;
  std::vector<std::uint32_t> component_of(n, 0);
  for (const DualTriangle& t : triangles) {
    if (!is_small(t.cell[0])) continue;
    small_triangles.push_back({t.cell[0], t.cell[1], t.cell[2]});
    for (const CellId c : t.cell) component_of[c] = sets.find(c);
  }
  const std::vector<std::uint8_t> inverted = inverted_components(
      position, small_triangles, complex.spacing, component_of, n, outward, kMinCosine);
  for (const Triangle& t : small_triangles) {
    if (!inverted[component_of[t[0]]]) continue;
    for (const CellId c : t) out[c] = 1;
  }
  return out;
}

// A hash of a set of triangles that does not depend on their order and first corners: two different
// sets have the same one with probability 2^-64.
std::uint64_t fingerprint(std::span<const DualTriangle> triangles) {
  const auto mix = [](std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
  };
  std::uint64_t sum = triangles.size();
  for (const DualTriangle& t : triangles) {
    auto c = t.cell;
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    sum += mix(mix(mix(c[0] + 0x9E3779B97F4A7C15u) + c[1]) + c[2]);
  }
  return sum;
}

}  // namespace

Coarsened coarsen(const SurfaceComplex& complex, double block_length, const RunControl& control) {
  const std::uint32_t n = complex.c_vertex_count();
  BlockRegions regions(complex, block_length);
  Coarsened out;
  bool orientation_checked = false;
  std::vector<std::uint8_t>
      scope;  // after a split, only the neighbourhood is checked again; the last check is complete
  for (;;) {
    report_continuing(control);
    PartitionCheck check = check_partition(complex, regions.region_of(), n, {}, scope, control);
    ++out.certificate.repair_rounds;
    if (!check.passed()) {
      control.check_cancelled();
      if (!regions.split(check))
        throw Error(ErrorCode::internal,
                    "the certificate fails with every c-vertex its own region");
      scope = regions.near_last_split();
      continue;
    }
    if (!scope.empty()) {
      scope.clear();
      continue;
    }
    control.check_cancelled();
    if (!orientation_checked) {  // only once: components that are still inverted are so in the
                                 // input
      orientation_checked = true;
      if (regions.split_completely(
              inverted_small_components(complex, regions.region_of(), check.triangles))) {
        scope = regions.near_last_split();
        continue;
      }
    }
    fill_report(check, out.certificate);
    control.check_cancelled();
    Partition partition = with_representatives(complex, regions.region_of());
    for (DualTriangle& t : check.triangles) {
      for (CellId& c : t.cell)
        c = partition.cell_of[c];  // a region was identified by one of its c-vertices
    }
    control.check_cancelled();
    out.complex = dual_complex(complex, partition, check.triangles);
    out.triangles = DualTriangles(std::move(check.triangles), partition.cell_count());
    out.representative = std::move(partition.site);
    out.region_of = std::move(partition.cell_of);
    return out;
  }
}

void split_regions(const SurfaceComplex& complex, std::span<const CVertexId> regions,
                   std::span<const CVertexId> touched, Coarsened& coarser,
                   const RunControl& control) {
  const std::uint32_t n = complex.c_vertex_count();
  std::vector<CellId>& region_of = coarser.region_of;
  std::vector<CVertexId>& representative = coarser.representative;
  ComplexAdjacency adjacency;
  CellMembers members;
  run_both(
      [&] { adjacency = ComplexAdjacency(complex, control); },
      [&] { members = CellMembers(region_of, static_cast<std::uint32_t>(representative.size())); });
  ScopedCheck scoped;
  std::vector<CVertexId> changed(touched.begin(), touched.end());
  const auto make_single = [&](CVertexId v) {
    region_of[v] = static_cast<CellId>(representative.size());
    representative.push_back(v);
    members.add_cells(1);
    members.insert(v, region_of[v]);
  };
  for (auto v = static_cast<CVertexId>(region_of.size()); v < n; ++v) {
    region_of.push_back(kNone);
    members.add_c_vertices(1);
    make_single(v);
    changed.push_back(v);
  }
  CancelPoll poll(control);
  const auto split = [&](std::vector<CellId>& failed) {
    std::vector<CVertexId> own;
    for (const CellId r : failed) members.for_each(r, [&](CVertexId v) { own.push_back(v); });
    std::sort(own.begin(), own.end());
    for (const CVertexId v : own) {
      poll.step();
      if (representative[region_of[v]] == v) continue;
      members.erase(v, region_of[v]);
      make_single(v);
    }
    changed.insert(changed.end(), own.begin(), own.end());
  };
  std::vector<CellId> failed(regions.begin(), regions.end());
  std::sort(failed.begin(), failed.end());
  failed.erase(std::unique(failed.begin(), failed.end()), failed.end());
  split(failed);
  std::vector<CellId> scope = scoped.cells_near(complex, adjacency, region_of, changed, control),
                      checked = scope;
  for (;;) {
    report_continuing(control);
    PartitionCheck check = scoped.run(complex, adjacency, region_of, members, {}, scope, control);
    ++coarser.certificate.repair_rounds;
    if (check.passed()) {
      control.check_cancelled();
      std::sort(checked.begin(), checked.end());
      checked.erase(std::unique(checked.begin(), checked.end()), checked.end());
      if (checked.size() > scope.size())
        check = scoped.run(complex, adjacency, region_of, members, {}, checked, control);
      control.check_cancelled();
      coarser.triangles.replace(checked, check.triangles,
                                static_cast<CellId>(representative.size()), control);
      control.check_cancelled();
      coarser.complex =
          dual_complex(complex, {region_of, representative}, coarser.triangles.list());
      return;
    }
    EpochSet is_failed;
    failed.clear();
    const auto fail = [&](CellId r) {
      if (members.count(r) > 1 && is_failed.insert(r)) failed.push_back(r);
    };
    for (const FaultyCell& f : check.faulty_cells) fail(f.cell);
    for (const PairFault& p : check.pair_faults)
      fail(members.count(p.b) > members.count(p.a) ? p.b : p.a);
    if (failed.empty()) {  // the arcs of two single c-vertices are faulty because of the regions
                           // around them
      std::vector<CVertexId> single;
      for (const PairFault& p : check.pair_faults)
        single.insert(single.end(), {representative[p.a], representative[p.b]});
      for (const CellId r : scoped.cells_near(complex, adjacency, region_of, single, control))
        fail(r);
    }
    if (failed.empty())
      throw Error(ErrorCode::internal, "the certificate fails with every c-vertex its own region");
    changed.clear();
    split(failed);
    scope = scoped.cells_near(complex, adjacency, region_of, changed, control);
    checked.insert(checked.end(), scope.begin(), scope.end());
  }
}

void certify_regions(const SurfaceComplex& complex, Coarsened& coarser, const RunControl& control) {
  const PartitionCheck check =
      check_partition(complex, coarser.region_of,
                      static_cast<CellId>(coarser.representative.size()), {}, {}, control);
  if (!check.passed() || fingerprint(check.triangles) != fingerprint(coarser.triangles.list()))
    throw Error(ErrorCode::internal,
                "the coarser complex is not certified; please report the volume and the options");
  fill_report(check, coarser.certificate);
}

}  // namespace isoatlas::detail
