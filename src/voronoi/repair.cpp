// SPDX-License-Identifier: Apache-2.0
// Certificate and repair: where a check fails, a site is added that can mend it.
#include "voronoi/repair.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/whole_progress.h"

namespace isoatlas::detail {
namespace {

void sort_unique(std::vector<CellId>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

struct Candidate {
  float distance = 0;  // from its site; larger is better
  CVertexId c_vertex = kNone;
  void offer(float d, CVertexId v) {
    if (d > distance || (d == distance && d > 0 && v < c_vertex)) *this = {d, v};
  }
};

constexpr std::size_t kFaults = 64;  // per piece of a parallel loop

// A new site that can mend one fault, and the cells the fault is about.
struct Fix {
  float distance;
  CVertexId c_vertex;
  CellId a, b;
};

class FixFinder {
 public:
  FixFinder(const SurfaceComplex& complex, const ComplexAdjacency& adjacency, Covering& covering)
      : complex_(complex),
        adjacency_(adjacency),
        covering_(covering),
        cell_of_(covering.partition().cell_of),
        members_(covering.members()) {}

  // For every faulty cell its farthest c-vertex, on the boundary if that is what is wrong; for two cells with faulty arcs the farthest
  // c-vertex on their common border.
  std::vector<Fix> find(const PartitionCheck& check, const RunControl& control) const {
    std::vector<Fix> fixes(check.faulty_cells.size() + check.pair_faults.size());
    for_each_index(check.faulty_cells.size(), kFaults, &control, [&](std::size_t i) {
      const auto& [cell, fault] = check.faulty_cells[i];
      Candidate best;
      if (fault & kBadBoundary) best = farthest_of(cell, true);
      if (best.c_vertex == kNone) best = farthest_of(cell, false);
      fixes[i] = {best.distance, best.c_vertex, cell, cell};
    });
    for_each_index(check.pair_faults.size(), kFaults, &control, [&](std::size_t i) {
      const auto& [a, b] = check.pair_faults[i];
      Candidate best = farthest_between(a, b);
      // The whole border may be sites already. If both cells are single c-vertices, the third cell at their two arc ends is the same;
      // then arcs of it with one of them are faulty, too, and it has room for a site.
      if (best.c_vertex == kNone) {
        best = farthest_of(a, false);
        const Candidate other = farthest_of(b, false);
        best.offer(other.distance, other.c_vertex);
      }
      fixes[check.faulty_cells.size() + i] = {best.distance, best.c_vertex, a, b};
    });
    std::erase_if(fixes, [](const Fix& fix) { return fix.c_vertex == kNone; });
    return fixes;
  }

 private:
  Candidate farthest_of(CellId cell, bool on_boundary) const {
    Candidate best;
    members_.for_each(cell, [&](CVertexId v) {
      if (!on_boundary || complex_.on_boundary[v]) best.offer(covering_.distance()[v], v);
    });
    return best;
  }

  // Of the c-vertices of both cells on faces that have both.
  Candidate farthest_between(CellId a, CellId b) const {
    if (members_.count(b) < members_.count(a)) std::swap(a, b);
    Candidate best;
    members_.for_each(a, [&](CVertexId v) {
      for (const FaceId f : adjacency_.faces_of(v)) {
        const Face& face = complex_.faces[f];
        for (int k = 0; k < face.size(); ++k) {
          const CVertexId w = face.corner[k];
          if (cell_of_[w] != b) continue;
          best.offer(covering_.distance()[v], v);
          best.offer(covering_.distance()[w], w);
        }
      }
    });
    return best;
  }

  const SurfaceComplex& complex_;
  const ComplexAdjacency& adjacency_;
  const Covering& covering_;
  std::span<const CellId> cell_of_;
  const CellMembers& members_;
};

// Farthest first. Of one c-vertex, those about two cells come before those about one: they mend more.
bool comes_before(const Fix& x, const Fix& y) {
  const auto order = [](const Fix& fix) { return std::tuple(fix.c_vertex, fix.a == fix.b, fix.a, fix.b); };
  return x.distance != y.distance ? x.distance > y.distance : order(x) < order(y);
}

// One new site often mends several faults near by, so a round only makes fixes that share no cell, those farthest from all
// sites first. (All at once: dragon 434 coarse triangles instead of 294, white matter 7,138 instead of 6,752.)
std::vector<CVertexId> independent(std::vector<Fix> fixes) {
  std::sort(fixes.begin(), fixes.end(), comes_before);
  EpochSet taken;
  std::vector<CVertexId> out;
  for (const Fix& fix : fixes) {
    if (taken.contains(fix.a) || taken.contains(fix.b)) continue;
    taken.insert(fix.a);
    taken.insert(fix.b);
    out.push_back(fix.c_vertex);
  }
  return out;
}

}  // namespace

CertifiedDual::CertifiedDual(const CertifiedDual& other, Covering& covering)
    : complex_(other.complex_),
      covering_(covering),
      adjacency_(other.adjacency_),
      other_faces_(other.other_faces_),
      site_points_(other.site_points_),
      triangles_(other.triangles_),
      touched_(other.touched_),
      fresh_(other.fresh_),
      complete_(other.complete_) {}

// `scope` empty: everything.
PartitionCheck CertifiedDual::check(std::span<const CellId> scope, const RunControl& control) {
  const Partition& partition = covering_.partition();
  if (scope.empty()) {
    PartitionCheck found;
    run_both([&] { found = check_partition(complex_, partition.cell_of, partition.cell_count(), partition.site, {}, control); },
             [&] { adjacency(control); });  // for repair and later checks
    return found;
  }
  return scoped_.run(complex_, adjacency(control), partition.cell_of, covering_.members(), partition.site, scope, control);
}

// Of a scope; empty: all.
void CertifiedDual::take_triangles(std::span<const CellId> scope, PartitionCheck& check, const RunControl& control) {
  const std::uint32_t cells = covering_.partition().cell_count();
  if (triangles_.list().empty()) {
    triangles_ = DualTriangles(std::move(check.triangles), cells);
  } else if (scope.empty()) {
    std::vector<CellId> all(cells);
    std::iota(all.begin(), all.end(), 0u);
    triangles_.replace(all, check.triangles, cells, control);
  } else {
    triangles_.replace(scope, check.triangles, cells, control);
  }
}

const ComplexAdjacency& CertifiedDual::adjacency(const RunControl& control) {
  if (!adjacency_) adjacency_ = std::make_shared<const ComplexAdjacency>(complex_, control);
  return *adjacency_;
}

std::vector<CellId> CertifiedDual::cells_near_changes(const RunControl& control) {
  std::vector<CVertexId> c_vertices(covering_.changed().begin(), covering_.changed().end());
  c_vertices.insert(c_vertices.end(), other_faces_.begin(), other_faces_.end());
  other_faces_.clear();
  return scoped_.cells_near(complex_, adjacency(control), covering_.partition().cell_of, c_vertices, control);
}

void CertifiedDual::remove_cells(std::uint32_t count) {
  site_points_.resize(std::min<std::size_t>(site_points_.size(), count));
  touched_.resize(std::min<std::size_t>(touched_.size(), count));
}

void CertifiedDual::continue_on(std::span<const std::uint8_t> changed) {
  adjacency_.reset();
  for (CVertexId v = 0; v < changed.size(); ++v) {
    if (changed[v]) other_faces_.push_back(v);
  }
  const std::vector<CVertexId>& site = covering_.partition().site;
  for (CellId c = 0; c < site_points_.size(); ++c) {
    const Vec3 p = complex_.positions[site[c]];
    if (std::exchange(site_points_[c], p) == p) continue;
    // Three other cells that meet at a quad with this one may meet no more: its diagonal depends on the site. So all cells around are
    // checked.
    covering_.members().for_each(c, [&](CVertexId v) { other_faces_.push_back(v); });
  }
}

// `scope` empty: everything.
void CertifiedDual::check_and_repair(std::vector<CellId> scope, CertificateReport& report, const RunControl& control) {
  const Partition& partition = covering_.partition();
  const RunControl quiet = without_stages(control);  // what is covered on the way is not the stage that tells its progress
  std::vector<CellId> checked = scope;               // in all rounds; if the first one was of everything, so is the last
  const bool everything = scope.empty();
  bool has_triangles = !std::exchange(fresh_, false);
  for (;;) {
    report_going_on(control);
    PartitionCheck found = check(scope, control);
    ++report.repair_rounds;
    touched_.resize(partition.cell_count(), 1);
    if (scope.empty()) std::fill(touched_.begin(), touched_.end(), std::uint8_t{1});
    for (const CellId c : scope) touched_[c] = 1;
    if (found.passed()) {
      // One look at all that was checked on the way has the triangles there.
      sort_unique(checked);
      if (!everything && checked.size() > scope.size()) found = check(checked, control);
      if (everything && !scope.empty()) found = check({}, control);
      control.check_cancelled();
      if (everything) record(found, report);
      if (!everything || !has_triangles)
        take_triangles(everything ? std::span<const CellId>() : checked, found, control);
      else if (found.triangles.size() != triangles_.list().size())
        throw Error(ErrorCode::internal, "the certificate has other triangles than were kept; please report the volume and the options");
      complete_ = everything;
      report.passed = true;
      return;
    }
    report.passed = false;
    has_triangles = has_triangles && !everything;

    const std::uint32_t before = covering_.site_count();
    covering_.forget_changes();
    control.check_cancelled();
    CancelPoll poll(control);
    for (const CVertexId v : independent(FixFinder(complex_, adjacency(control), covering_).find(found, control))) {
      poll.step();
      if (covering_.distance()[v] == 0) continue;  // two fixes may agree on the same c-vertex
      covering_.lower_radius(v, covering_.distance()[v], control);
      covering_.insert(v, control);
    }
    covering_.cover(quiet);
    if (covering_.site_count() == before) {
      throw Error(ErrorCode::internal, "the certificate fails and no site is left to add; please report the volume and the options");
    }
    report.repair_sites += covering_.site_count() - before;

    scope = cells_near_changes(control);  // and faults left for the next round
    for (const FaultyCell& f : found.faulty_cells) scope.push_back(f.cell);
    for (const PairFault& p : found.pair_faults) scope.insert(scope.end(), {p.a, p.b});
    sort_unique(scope);
    if (!everything) checked.insert(checked.end(), scope.begin(), scope.end());
  }
}

void CertifiedDual::update(CertificateReport& report, const RunControl& control) {
  if (fresh_) {
    other_faces_.clear();
    check_and_repair({}, report, control);
  } else if (!covering_.changed().empty() || !other_faces_.empty()) {
    check_and_repair(cells_near_changes(control), report, control);
  } else {
    report.passed = true;
    complete_ = false;  // of this report nothing was counted yet
  }
  covering_.forget_changes();
  const std::vector<CVertexId>& site = covering_.partition().site;
  for (auto c = static_cast<CellId>(site_points_.size()); c < site.size(); ++c) site_points_.push_back(complex_.positions[site[c]]);
  assert(is_what_a_full_check_finds());
}

// For debug builds.
bool CertifiedDual::is_what_a_full_check_finds() {
  constexpr CVertexId kMost = 20000;  // c-vertices; of more it would take too long
  if (complex_.c_vertex_count() > kMost) return true;
  const auto corners = [](const std::vector<DualTriangle>& triangles) {
    std::vector<std::array<CellId, 3>> out;
    for (DualTriangle t : triangles) {
      std::rotate(t.cell.begin(), std::min_element(t.cell.begin(), t.cell.end()), t.cell.end());
      out.push_back(t.cell);
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  const PartitionCheck found = check({}, {});
  return found.passed() && corners(found.triangles) == corners(triangles());
}

void CertifiedDual::touch_near(std::span<const CVertexId> c_vertices, const RunControl& control) {
  touched_.resize(std::max<std::size_t>(touched_.size(), covering_.site_count()), 1);
  for (const CellId c : scoped_.cells_near(complex_, adjacency(control), covering_.partition().cell_of, c_vertices, control))
    touched_[c] = 1;
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

}  // namespace isoatlas::detail
