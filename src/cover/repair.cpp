// SPDX-License-Identifier: Apache-2.0
// Certificate and repair: where a check fails, a site is added that can mend it.
#include "cover/repair.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace isoatlas {
namespace {

struct Candidate {
  float distance = 0;  // from its site; larger is better
  CVertexId c_vertex = kNone;
  void offer(float d, CVertexId v) {
    if (d > distance || (d == distance && d > 0 && v < c_vertex)) *this = {d, v};
  }
};

// A new site that can mend one fault, and the cells the fault is about.
struct Fix {
  float distance;
  CVertexId c_vertex;
  CellId a, b;
};

// For every faulty cell its farthest c-vertex, on the boundary if that is what is wrong; for two cells that meet badly the
// farthest c-vertex on their common border. One pass over c-vertices and one over faces.
std::vector<Fix> find_fixes(const SurfaceComplex& complex, const Covering& covering, const PartitionCheck& check) {
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

  std::vector<Fix> fixes;
  const auto add = [&](const Candidate& candidate, CellId a, CellId b) {
    if (candidate.c_vertex != kNone) fixes.push_back({candidate.distance, candidate.c_vertex, a, b});
  };
  for (CellId c = 0; c < cells; ++c) {
    if (check.cell_fault[c] == 0) continue;
    const bool boundary = (check.cell_fault[c] & kBadBoundary) && of_boundary[c].c_vertex != kNone;
    add(boundary ? of_boundary[c] : of_cell[c], c, c);
  }
  for (std::size_t i = 0; i < of_pair.size(); ++i) {
    const auto [a, b] = check.pair_faults[i];
    Candidate best = of_pair[i];
    // The whole border may be sites already. If both cells are single c-vertices, the third cell at their two arc ends is the same;
    // then it also meets one of them badly, and has room for a site.
    if (best.c_vertex == kNone) {
      best = of_cell[a];
      best.offer(of_cell[b].distance, of_cell[b].c_vertex);
    }
    add(best, a, b);
  }
  return fixes;
}

// Farthest first. Of one c-vertex, those about two cells come before those about one: they mend more.
bool comes_before(const Fix& x, const Fix& y) {
  const auto order = [](const Fix& fix) { return std::tuple(fix.c_vertex, fix.a == fix.b, fix.a, fix.b); };
  return x.distance != y.distance ? x.distance > y.distance : order(x) < order(y);
}

// One new site often mends several faults near by, so a round only makes fixes that share no cell, those farthest from all
// sites first. (All at once: dragon 434 coarse triangles instead of 294, white matter 7,138 instead of 6,752.)
std::vector<CVertexId> independent(std::vector<Fix> fixes, std::uint32_t cells) {
  std::sort(fixes.begin(), fixes.end(), comes_before);
  std::vector<std::uint8_t> taken(cells, 0);
  std::vector<CVertexId> out;
  for (const Fix& fix : fixes) {
    if (taken[fix.a] || taken[fix.b]) continue;
    taken[fix.a] = taken[fix.b] = 1;
    out.push_back(fix.c_vertex);
  }
  return out;
}

// Triangles with a corner in scope are replaced by those the check found there.
void replace_triangles(std::vector<DualTriangle>& triangles, const std::vector<std::uint8_t>& scope, std::vector<DualTriangle>& found) {
  const auto in_scope = [&](const DualTriangle& t) { return scope[t.cell[0]] || scope[t.cell[1]] || scope[t.cell[2]]; };
  if (scope.empty()) {
    triangles = std::move(found);
    return;
  }
  std::erase_if(triangles, in_scope);
  std::copy_if(found.begin(), found.end(), std::back_inserter(triangles), in_scope);  // a quad's other half may lie outside
}

}  // namespace

// `scope` empty: everything.
void CertifiedDual::check_and_repair(std::vector<std::uint8_t> scope, CertificateReport& report, const RunControl& control) {
  const Partition& partition = covering_.partition();
  RunControl quiet = control;  // what is covered on the way is not the stage that tells its progress
  quiet.progress = nullptr;
  for (;;) {
    control.check_cancelled();
    PartitionCheck check = check_partition(complex_, partition.cell_of, partition.cell_count(), partition.site, scope);
    ++report.repair_rounds;
    touched_.resize(partition.cell_count(), 1);
    for (CellId c = 0; c < partition.cell_count(); ++c) touched_[c] |= scope.empty() || scope[c];
    if (check.passed() && scope.empty()) record(check, report);
    replace_triangles(triangles_, scope, check.triangles);
    if (check.passed()) {
      complete_ = scope.empty();
      report.passed = true;
      return;
    }
    report.passed = false;

    const std::uint32_t before = covering_.site_count();
    covering_.forget_changes();
    for (const CVertexId v : independent(find_fixes(complex_, covering_, check), partition.cell_count())) {
      if (covering_.distance()[v] == 0) continue;  // two fixes may agree on the same c-vertex
      covering_.lower_radius(v, covering_.distance()[v]);
      covering_.insert(v);
    }
    covering_.cover(quiet);
    if (covering_.site_count() == before) {
      throw Error(ErrorCode::internal, "the certificate fails and no site is left to add; please report the volume and the options");
    }
    report.repair_sites += covering_.site_count() - before;

    scope = cells_near_changes(complex_, partition.cell_of, partition.cell_count(), covering_.changed());
    for (CellId c = 0; c < before; ++c) {  // faults left for the next round
      if (check.cell_fault[c] != 0) scope[c] = 1;
    }
    for (const PairFault& p : check.pair_faults) scope[p.a] = scope[p.b] = 1;
  }
}

void CertifiedDual::update(CertificateReport& report, const RunControl& control) {
  const Partition& partition = covering_.partition();
  std::vector<std::uint8_t> scope;
  if (!fresh_) scope = cells_near_changes(complex_, partition.cell_of, partition.cell_count(), covering_.changed());
  fresh_ = false;
  check_and_repair(std::move(scope), report, control);
  covering_.forget_changes();
}

void CertifiedDual::certify(CertificateReport& report, const RunControl& control) {
  update(report, control);
  while (!complete_) {  // once: the look at everything finds nothing that the looks at what changed have missed
    const std::vector<std::uint8_t> touched = touched_;
    check_and_repair({}, report, control);
    if (touched.size() == covering_.site_count()) touched_ = touched;  // looking touches nothing
  }
  covering_.forget_changes();
}

}  // namespace isoatlas
