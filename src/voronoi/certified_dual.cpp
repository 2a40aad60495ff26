// SPDX-License-Identifier: Apache-2.0
// Certificate and repair: where a check fails, a site is inserted that repairs the fault.
#include "voronoi/certified_dual.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/whole_progress.h"

namespace isoatlas::detail {
namespace {

struct Candidate {
  float distance = 0;  // from its site; larger is better
  CVertexId c_vertex = kNone;
  void offer(float d, CVertexId v) {
    if (d > distance || (d == distance && d > 0 && v < c_vertex)) *this = {d, v};
  }
};

constexpr std::size_t kFaultsPerChunk = 64;  // per piece of a parallel loop

// A c-vertex that repairs one fault as a new site, and the cells that have the fault.
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

  // For every faulty cell: its farthest c-vertex, on the boundary if the boundary is at fault. For
  // two cells with faulty arcs: the farthest c-vertex on the boundary between them.
  std::vector<Fix> find(const PartitionCheck& check, const RunControl& control) const {
    std::vector<Fix> fixes(check.faulty_cells.size() + check.pair_faults.size());
    for_each_index(check.faulty_cells.size(), kFaultsPerChunk, &control, [&](std::size_t i) {
      const auto& [cell, fault] = check.faulty_cells[i];
      Candidate best;
      if (fault & kBadBoundary) best = farthest_of(cell, true);
      if (best.c_vertex == kNone) best = farthest_of(cell, false);
      fixes[i] = {best.distance, best.c_vertex, cell, cell};
    });
    for_each_index(check.pair_faults.size(), kFaultsPerChunk, &control, [&](std::size_t i) {
      const auto& [a, b] = check.pair_faults[i];
      Candidate best = farthest_between(a, b);
      // All c-vertices on the boundary between them may be sites already. If both cells are single
      // c-vertices, both ends of their arc are in the same third cell; then the arcs between it and
      // one of the two cells are faulty as well, and it has room for a site.
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

  // The farthest of the c-vertices of both cells, on faces that have corners in both.
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

// Farthest first. For equal c-vertices, fixes of two cells come before fixes of one, since they
// repair more.
bool comes_before(const Fix& x, const Fix& y) {
  const auto order = [](const Fix& fix) {
    return std::tuple(fix.c_vertex, fix.a == fix.b, fix.a, fix.b);
  };
  return x.distance != y.distance ? x.distance > y.distance : order(x) < order(y);
}

// One new site often repairs several faults near it. So a round only applies fixes that share no
// cell, starting with those farthest from all sites. (All fixes at once: dragon 434 coarse
// triangles instead of 294, white matter 7,138 instead of 6,752.)
std::vector<CVertexId> select_independent(std::vector<Fix> fixes) {
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
      changed_c_vertices_(other.changed_c_vertices_),
      site_positions_(other.site_positions_),
      triangles_(other.triangles_),
      touched_(other.touched_),
      nothing_checked_(other.nothing_checked_),
      all_checked_(other.all_checked_) {}

// An empty `scope` means all cells.
PartitionCheck CertifiedDual::check(std::span<const CellId> scope, const RunControl& control) {
  const Partition& partition = covering_.partition();
  if (scope.empty()) {
    PartitionCheck found;
    run_both(
        [&] {
          found = check_partition(complex_, partition.cell_of, partition.cell_count(),
                                  partition.site, {}, control);
        },
        [&] { adjacency(control); });  // needed for repair and for later local checks
    return found;
  }
  return scoped_.run(complex_, adjacency(control), partition.cell_of, covering_.members(),
                     partition.site, scope, control);
}

// An empty `scope` means all cells.
void CertifiedDual::store_triangles(std::span<const CellId> scope, PartitionCheck& check,
                                    const RunControl& control) {
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
  c_vertices.insert(c_vertices.end(), changed_c_vertices_.begin(), changed_c_vertices_.end());
  changed_c_vertices_.clear();
  return scoped_.cells_near(complex_, adjacency(control), covering_.partition().cell_of, c_vertices,
                            control);
}

void CertifiedDual::remove_cells(std::uint32_t count) {
  site_positions_.resize(std::min<std::size_t>(site_positions_.size(), count));
  touched_.resize(std::min<std::size_t>(touched_.size(), count));
}

void CertifiedDual::adapt_to(std::span<const std::uint8_t> changed) {
  adjacency_.reset();
  for (CVertexId v = 0; v < changed.size(); ++v) {
    if (changed[v]) changed_c_vertices_.push_back(v);
  }
  const std::vector<CVertexId>& site = covering_.partition().site;
  for (CellId c = 0; c < site_positions_.size(); ++c) {
    const Vec3 p = complex_.positions[site[c]];
    if (std::exchange(site_positions_[c], p) == p) continue;
    // Three other cells that are adjacent to this one at a quad may no longer be: the quad's
    // diagonal depends on the site. So all cells around it are checked.
    covering_.members().for_each(c, [&](CVertexId v) { changed_c_vertices_.push_back(v); });
  }
}

// An empty `scope` means all cells.
void CertifiedDual::check_and_repair(std::vector<CellId> scope, CertificateReport& report,
                                     const RunControl& control) {
  const Partition& partition = covering_.partition();
  const RunControl quiet =
      without_stages(control);  // covering inside a repair is not a stage that reports progress
  std::vector<CellId> checked =
      scope;  // in all rounds; if the first check was of all cells, so is the last
  const bool check_all = scope.empty();
  bool has_triangles = !std::exchange(nothing_checked_, false);
  for (;;) {
    report_continuing(control);
    PartitionCheck found = check(scope, control);
    ++report.repair_rounds;
    touched_.resize(partition.cell_count(), 1);
    if (scope.empty()) std::fill(touched_.begin(), touched_.end(), std::uint8_t{1});
    for (const CellId c : scope) touched_[c] = 1;
    if (found.passed()) {
      // One check of everything that was checked in between yields its triangles.
      ranges::sort_unique(checked);
      if (!check_all && checked.size() > scope.size()) found = check(checked, control);
      if (check_all && !scope.empty()) found = check({}, control);
      control.check_cancelled();
      if (check_all) fill_report(found, report);
      if (!check_all || !has_triangles)
        store_triangles(check_all ? std::span<const CellId>() : checked, found, control);
      else if (found.triangles.size() != triangles_.list().size())
        throw Error(ErrorCode::internal,
                    "the certificate's triangles differ from the stored ones; please report the "
                    "volume and the options");
      all_checked_ = check_all;
      report.passed = true;
      return;
    }
    report.passed = false;
    has_triangles = has_triangles && !check_all;

    const std::uint32_t before = covering_.site_count();
    covering_.clear_changes();
    control.check_cancelled();
    CancelPoll poll(control);
    for (const CVertexId v : select_independent(
             FixFinder(complex_, adjacency(control), covering_).find(found, control))) {
      poll.step();
      if (covering_.distance()[v] == 0) continue;  // two fixes may propose the same c-vertex
      covering_.lower_radius(v, covering_.distance()[v], control);
      covering_.insert(v, control);
    }
    covering_.cover(quiet);
    if (covering_.site_count() == before) {
      throw Error(ErrorCode::internal,
                  "the certificate fails and no site is left to add; please report the volume and "
                  "the options");
    }
    report.repair_sites += covering_.site_count() - before;

    scope = cells_near_changes(control);  // also the faults that are left for the next round
    for (const FaultyCell& f : found.faulty_cells) scope.push_back(f.cell);
    for (const PairFault& p : found.pair_faults) scope.insert(scope.end(), {p.a, p.b});
    ranges::sort_unique(scope);
    if (!check_all) checked.insert(checked.end(), scope.begin(), scope.end());
  }
}

void CertifiedDual::update(CertificateReport& report, const RunControl& control) {
  if (nothing_checked_) {
    changed_c_vertices_.clear();
    check_and_repair({}, report, control);
  } else if (!covering_.changed().empty() || !changed_c_vertices_.empty()) {
    check_and_repair(cells_near_changes(control), report, control);
  } else {
    report.passed = true;
    all_checked_ = false;  // the counts of this report are not complete
  }
  covering_.clear_changes();
  const std::vector<CVertexId>& site = covering_.partition().site;
  for (auto c = static_cast<CellId>(site_positions_.size()); c < site.size(); ++c)
    site_positions_.push_back(complex_.positions[site[c]]);
  assert(matches_complete_check());
}

// For debug builds.
bool CertifiedDual::matches_complete_check() {
  constexpr CVertexId kMaxCVertices = 20000;  // c-vertices; of more it would take too long
  if (complex_.c_vertex_count() > kMaxCVertices) return true;
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

void CertifiedDual::mark_touched_near(std::span<const CVertexId> c_vertices,
                                      const RunControl& control) {
  touched_.resize(std::max<std::size_t>(touched_.size(), covering_.site_count()), 1);
  for (const CellId c : scoped_.cells_near(complex_, adjacency(control),
                                           covering_.partition().cell_of, c_vertices, control))
    touched_[c] = 1;
}

void CertifiedDual::certify(CertificateReport& report, const RunControl& control) {
  update(report, control);
  while (!all_checked_) {  // runs once: a complete check finds nothing that the local checks have
                           // missed
    const std::vector<std::uint8_t> touched = touched_;
    check_and_repair({}, report, control);
    if (touched.size() == covering_.site_count())
      touched_ = touched;  // a check without repair does not change cells
  }
  covering_.clear_changes();
}

}  // namespace isoatlas::detail
