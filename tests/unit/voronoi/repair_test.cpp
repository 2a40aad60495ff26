// SPDX-License-Identifier: Apache-2.0
#include "voronoi/certified_dual.h"

#include <gtest/gtest.h>

#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

void expect_certified(const SurfaceComplex& surface, float radius, float persistence,
                      const std::string& what) {
  const CVertexGraph graph = make_graph(surface);
  CoveringOptions options;
  options.max_radius = radius;
  options.event_persistence = persistence;
  options.first_stage = 4;
  Covering covering(graph, options);
  covering.cover({});
  const std::uint32_t covered = covering.site_count();
  CertificateReport report;
  CertifiedDual dual_of(surface, covering);
  dual_of.certify(report, {});
  ASSERT_TRUE(report.passed) << what;
  ASSERT_EQ(report.repair_sites, covering.site_count() - covered) << what;
  ASSERT_EQ(report.cells_checked, covering.site_count()) << what;
  ASSERT_EQ(report.triples_checked, dual_of.triangles().size()) << what;
  const Partition& p = covering.partition();
  // A complete check, independent of the local ones.
  const PartitionCheck again = check_partition(surface, p.cell_of, p.cell_count(), p.site);
  ASSERT_TRUE(again.passed()) << what;
  ASSERT_EQ(again.triangles.size(), dual_of.triangles().size()) << what;
  ASSERT_EQ(again.cells, p.cell_count());
  for (CVertexId v = 0; v < surface.c_vertex_count(); ++v)
    ASSERT_TRUE(covering.is_covered(v)) << what;
  const SurfaceComplex dual = dual_complex(surface, p, dual_of.triangles());
  ASSERT_EQ(validate(dual), "") << what;
  ASSERT_EQ(kinds_of(triangles_of(dual)), kinds_of(triangles_of(surface))) << what;
  const MeshCounts before = count_manifold(surface), after = count_manifold(dual);
  ASSERT_EQ(after.components.size(), before.components.size()) << what;
  for (CellId c = 0; c < p.cell_count(); ++c) {
    ASSERT_EQ(after.components[after.component_of_vertex[c]],
              before.components[before.component_of_vertex[p.site[c]]])
        << what;
  }
}

TEST(Repair, KnownShapes) {
  for (const KnownVolume& known : known_volumes()) {
    for (const float radius : {3.0f, 12.0f, 1000.0f}) {
      expect_certified(surface_of(known.samples, known.isovalue), radius, 1.5f,
                       known.name + ", radius " + std::to_string(radius));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Repair, RandomVolumes) {
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {2 + seed % 9, 8, 7}, seed);
    if (!has_surface(s, 0)) continue;
    expect_certified(surface_of(s), seed % 2 ? 3.0f : 100.0f, 1.5f,
                     std::string(name(family)) + " seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
  }
}

// Without events to limit the disks, repair has to do all the work.
TEST(Repair, WithoutTopologicalEvents) {
  for (const KnownVolume& known : known_volumes()) {
    expect_certified(surface_of(known.samples, known.isovalue), 1000, 500, known.name);
    if (HasFatalFailure()) return;
  }
}

TEST(Repair, TinyComplexes) {
  expect_certified(tetrahedron(), 100, 1.5f, "tetrahedron");
  expect_certified(flat_grid(2, 2), 100, 1.5f, "one quad");
  expect_certified(tube(5, 2), 100, 1.5f, "ring");
}

TEST(Repair, NothingToRepair) {
  const SurfaceComplex grid = flat_grid(8, 8);
  const CVertexGraph graph = make_graph(grid);
  CoveringOptions options;
  options.max_radius = 0.1f;  // every c-vertex a site
  options.event_persistence = 0;
  options.first_stage = 1;
  Covering covering(graph, options);
  covering.cover({});
  EXPECT_EQ(covering.site_count(), 64u);
  CertificateReport report;
  CertifiedDual(grid, covering).certify(report, {});
  EXPECT_TRUE(report.passed);
  EXPECT_EQ(report.repair_sites, 0u);
}

}  // namespace
}  // namespace isoatlas::detail
