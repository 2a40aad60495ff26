// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "complex/components.h"
#include "complex/dual_triangles.h"
#include "complex/scoped_check.h"
#include "property/random_case.h"
#include "support/surfaces.h"
#include "voronoi/certified_dual.h"

namespace isoatlas::detail {
namespace {

using namespace test;

[[maybe_unused]] const bool kCases = run_cases(100);

RC_GTEST_PROP(AnyCovering, CoversAndCertifies, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  const SurfaceComplex surface = surface_of(samples, c.isovalue(), c.inside(), c.spacing);
  const CVertexGraph graph = make_graph(surface);
  CoveringOptions options;
  options.max_radius = 1 + static_cast<float>(c.seed % 9);
  options.event_persistence = static_cast<float>(c.seed % 4);
  options.first_stage = 2;
  Covering covering(graph, options);
  covering.cover({});
  CertificateReport report;
  CertifiedDual dual_of(surface, covering);
  dual_of.certify(report, {});
  RC_ASSERT(report.passed);
  const Partition& p = covering.partition();
  const std::vector<double> distance = slow_distances(graph, p.site);
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    RC_ASSERT(covering.is_covered(v));
    RC_ASSERT(std::abs(covering.distance()[v] - distance[v]) <= 1e-4 * (1 + distance[v]));
    for (const auto& n : graph.row(v))
      RC_ASSERT(covering.radius()[v] <= covering.radius()[n.id] + n.weight / 3 * 1.0001f);
  }
  const SurfaceComplex dual = dual_complex(surface, p, dual_of.triangles());
  RC_ASSERT(validate(dual) == "");
  RC_ASSERT(kinds_of(triangles_of(dual)) == kinds_of(triangles_of(surface)));
}

std::vector<std::array<CellId, 3>> sorted_corners(std::span<const DualTriangle> triangles) {
  std::vector<std::array<CellId, 3>> out;
  for (const DualTriangle& t : triangles) {
    auto corners = t.cell;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// A scoped check finds in its scope what a complete check finds. After a change of some c-vertices
// every new fault is within the scope that cells_near() returns, and the stored triangles are those
// of a complete check. Repeated with the same objects.
RC_GTEST_PROP(AnyPartition, ScopedCheckFindsAllFaults, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  const SurfaceComplex surface = surface_of(samples, c.isovalue(), c.inside());
  const std::uint32_t n = surface.c_vertex_count();
  Random random(c.seed);
  const auto cells = static_cast<std::uint32_t>(1 + random.bits() % n);
  std::vector<CellId> cell_of(n);
  // Blocks of ids, which run along rows: many cells are not connected, many are valid.
  for (CVertexId v = 0; v < n; ++v)
    cell_of[v] = static_cast<CellId>(static_cast<std::uint64_t>(v) * cells / n);
  if (random.bits() & 1) std::iota(cell_of.begin(), cell_of.end(), 0u);
  std::vector<CVertexId> site;
  if (random.bits() & 1) {
    for (CVertexId v = 0; v < n; ++v) site.push_back(static_cast<CVertexId>(random.bits() % n));
  }
  const ComplexAdjacency adjacency(surface);
  CellMembers members(cell_of, n);
  ScopedCheck scoped_check;
  PartitionCheck before = check_partition(surface, cell_of, n, site);
  DualTriangles kept(before.triangles, n);
  for (int round = 0; round < 4; ++round) {
    std::vector<CVertexId> changed;
    std::vector<CellId> scope;
    for (std::uint64_t k = 1 + random.bits() % 4; k > 0; --k) {
      const auto v = static_cast<CVertexId>(random.bits() % n);
      const CellId to = cell_of[random.bits() % n];
      if (to == cell_of[v]) continue;
      // A covering never empties a cell, since its site stays in it; so the cell that v leaves is
      // near the change. Here it may not be.
      scope.push_back(cell_of[v]);
      members.erase(v, cell_of[v]);
      members.insert(v, to);
      cell_of[v] = to;
      changed.push_back(v);
    }
    const PartitionCheck after = check_partition(surface, cell_of, n, site);
    for (const CellId cell : scoped_check.cells_near(surface, adjacency, cell_of, changed))
      scope.push_back(cell);
    for (const FaultyCell& f : before.faulty_cells) scope.push_back(f.cell);
    for (const PairFault& p : before.pair_faults) scope.insert(scope.end(), {p.a, p.b});
    std::sort(scope.begin(), scope.end());
    scope.erase(std::unique(scope.begin(), scope.end()), scope.end());

    const PartitionCheck scoped =
        scoped_check.run(surface, adjacency, cell_of, members, site, scope);
    RC_ASSERT(scoped.faulty_cells.size() == after.faulty_cells.size());
    for (std::size_t i = 0; i < after.faulty_cells.size(); ++i) {
      RC_ASSERT(scoped.faulty_cells[i].cell == after.faulty_cells[i].cell &&
                scoped.faulty_cells[i].fault == after.faulty_cells[i].fault);
    }
    RC_ASSERT(scoped.pair_faults.size() == after.pair_faults.size());
    for (std::size_t i = 0; i < after.pair_faults.size(); ++i) {
      RC_ASSERT(scoped.pair_faults[i].a == after.pair_faults[i].a &&
                scoped.pair_faults[i].b == after.pair_faults[i].b);
    }
    kept.replace(scope, scoped.triangles, n);
    RC_ASSERT(sorted_corners(kept.list()) == sorted_corners(after.triangles));
    for (CellId cell = 0; cell < n; ++cell) {
      for (const std::uint32_t t : kept.of_cell(cell))
        RC_ASSERT(std::ranges::count(kept.list()[t].cell, cell) == 1);
    }
    before = after;
  }
}

}  // namespace
}  // namespace isoatlas::detail
