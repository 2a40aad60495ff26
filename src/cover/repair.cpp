// SPDX-License-Identifier: Apache-2.0
// Certificate and repair: where a check fails, a site is added that can mend it.
#include "cover/repair.h"

#include <algorithm>

namespace isoatlas {
namespace {

struct Candidate {
  float distance = 0;      // from its site; larger is better
  CVertexId c_vertex = kNone;
  void offer(float d, CVertexId v) {
    if (d > distance || (d == distance && d > 0 && v < c_vertex)) *this = {d, v};
  }
};

// Farthest c-vertex of every faulty cell, on the boundary if that is what is wrong; for two cells that meet badly the farthest
// c-vertex on their common border. One pass over c-vertices and one over faces.
std::vector<CVertexId> choose_candidates(const SurfaceComplex& complex, const Covering& covering, const PartitionCheck& check) {
  const Partition& partition = covering.partition();
  const std::vector<float>& distance = covering.distance();
  const std::uint32_t cells = partition.cell_count();

  std::vector<std::uint8_t> in_pair(cells, 0);
  for (const PairFault& p : check.pair_faults) in_pair[p.a] = in_pair[p.b] = 1;

  std::vector<Candidate> of_cell(cells), of_boundary(cells);
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    const CellId c = partition.cell_of[v];
    if (check.cell_fault[c] == 0 && !in_pair[c]) continue;
    of_cell[c].offer(distance[v], v);
    if (complex.on_boundary[v]) of_boundary[c].offer(distance[v], v);
  }

  std::vector<Candidate> of_pair(check.pair_faults.size());
  if (!check.pair_faults.empty()) {
    const auto less = [](const PairFault& p, const PairFault& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; };
    for (const Face& face : complex.faces) {
      const int size = face.size();
      for (int i = 0; i < size; ++i) {
        const CellId a = partition.cell_of[face.corner[i]];
        if (!in_pair[a]) continue;
        for (int j = i + 1; j < size; ++j) {
          const CellId b = partition.cell_of[face.corner[j]];
          if (a == b || !in_pair[b]) continue;
          const PairFault pair{std::min(a, b), std::max(a, b)};
          const auto it = std::lower_bound(check.pair_faults.begin(), check.pair_faults.end(), pair, less);
          if (it == check.pair_faults.end() || it->a != pair.a || it->b != pair.b) continue;
          Candidate& best = of_pair[static_cast<std::size_t>(it - check.pair_faults.begin())];
          for (const int k : {i, j}) best.offer(distance[face.corner[k]], face.corner[k]);
        }
      }
    }
  }

  std::vector<CVertexId> out;
  for (CellId c = 0; c < cells; ++c) {
    if (check.cell_fault[c] == 0) continue;
    const bool boundary = (check.cell_fault[c] & kBadBoundary) && of_boundary[c].c_vertex != kNone;
    const CVertexId v = (boundary ? of_boundary : of_cell)[c].c_vertex;
    if (v != kNone) out.push_back(v);
  }
  for (std::size_t i = 0; i < of_pair.size(); ++i) {
    CVertexId v = of_pair[i].c_vertex;
    if (v == kNone) {  // the whole border is sites already
      Candidate either = of_cell[check.pair_faults[i].a];
      const Candidate& other = of_cell[check.pair_faults[i].b];
      if (other.c_vertex != kNone) either.offer(other.distance, other.c_vertex);
      v = either.c_vertex;
    }
    if (v != kNone) out.push_back(v);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

PartitionCheck certify_and_repair(const SurfaceComplex& complex, Covering& covering, CertificateReport& report, const RunControl& control) {
  for (;;) {
    control.check_cancelled();
    const Partition& partition = covering.partition();
    PartitionCheck check = check_partition(complex, partition.cell_of, partition.cell_count(), partition.site);
    ++report.repair_rounds;
    if (check.passed()) {
      add_to(report, check);
      return check;
    }
    std::vector<CVertexId> candidates = choose_candidates(complex, covering, check);
    std::vector<float> seen;
    for (const CVertexId v : candidates) seen.push_back(covering.distance()[v]);
    const std::uint32_t before = covering.site_count();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const CVertexId v = candidates[i];
      const float d = covering.distance()[v];
      if (d < seen[i]) continue;  // an earlier repair of this round came near: look again first
      covering.lower_radius(v, d);
      covering.insert(v);
    }
    covering.cover(control);
    if (covering.site_count() == before) {
      throw Error(ErrorCode::internal, "the certificate fails and no site is left to add; please report the volume and the options");
    }
    report.repair_sites += covering.site_count() - before;
  }
}

}  // namespace isoatlas
