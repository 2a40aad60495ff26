// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "cover/repair.h"
#include "property/random_case.h"
#include "support/surfaces.h"
#include "surface/components.h"

namespace isoatlas {
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
    for (const auto& n : graph.row(v)) RC_ASSERT(covering.radius()[v] <= covering.radius()[n.id] + n.weight / 3 * 1.0001f);
  }
  const SurfaceComplex dual = dual_complex(surface, p, dual_of.triangles());
  RC_ASSERT(validate(dual) == "");
  RC_ASSERT(kinds_of(triangles_of(dual)) == kinds_of(triangles_of(surface)));
}

// A check of a scope finds there what a check of everything finds; and after a change of some c-vertices every new fault is
// within the scope that cells_near_changes() gives.
RC_GTEST_PROP(AnyPartition, ScopedCheckMissesNothing, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  const SurfaceComplex surface = surface_of(samples, c.isovalue(), c.inside());
  const std::uint32_t n = surface.c_vertex_count();
  Random random(c.seed);
  const auto cells = static_cast<std::uint32_t>(1 + random.bits() % n);
  std::vector<CellId> cell_of(n);
  // Blocks of the numbering, which runs along rows: many cells in pieces, many fine ones.
  for (CVertexId v = 0; v < n; ++v) cell_of[v] = static_cast<CellId>(static_cast<std::uint64_t>(v) * cells / n);
  if (random.bits() & 1) std::iota(cell_of.begin(), cell_of.end(), 0u);
  const std::uint32_t names = n;

  const PartitionCheck before = check_partition(surface, cell_of, names, {});
  std::vector<std::uint8_t> changed(n, 0);
  for (std::uint64_t k = 1 + random.bits() % 4; k > 0; --k) {
    const auto v = static_cast<CVertexId>(random.bits() % n);
    const CellId to = cell_of[random.bits() % n];
    changed[v] |= to != cell_of[v];
    cell_of[v] = to;
  }
  const PartitionCheck after = check_partition(surface, cell_of, names, {});
  std::vector<std::uint8_t> scope = cells_near_changes(surface, cell_of, names, changed);
  for (CellId cell = 0; cell < names; ++cell) {
    if (before.cell_fault[cell] != 0) scope[cell] = 1;
  }
  for (const PairFault& p : before.pair_faults) scope[p.a] = scope[p.b] = 1;

  const PartitionCheck scoped = check_partition(surface, cell_of, names, {}, scope);
  for (CellId cell = 0; cell < names; ++cell) {
    if (scope[cell]) {
      RC_ASSERT(scoped.cell_fault[cell] == after.cell_fault[cell]);
    } else {
      RC_ASSERT(after.cell_fault[cell] == 0);
      RC_ASSERT(scoped.cell_fault[cell] == 0);
    }
  }
  RC_ASSERT(scoped.pair_faults.size() == after.pair_faults.size());
  for (std::size_t i = 0; i < after.pair_faults.size(); ++i) {
    RC_ASSERT(scoped.pair_faults[i].a == after.pair_faults[i].a && scoped.pair_faults[i].b == after.pair_faults[i].b);
  }
  RC_ASSERT(scoped.passed() == after.passed());
}

}  // namespace
}  // namespace isoatlas
