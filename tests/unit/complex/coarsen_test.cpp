// SPDX-License-Identifier: Apache-2.0
#include "complex/coarsen.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>

#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// The coarser complex is valid, has its c-vertices at those of the finer one, and has its topology
// component by component.
void expect_coarser(const SurfaceComplex& fine, double block, const std::string& what) {
  const Coarsened out = coarsen(fine, block);
  ASSERT_TRUE(out.certificate.passed) << what;
  ASSERT_EQ(validate(out.complex), "") << what;
  ASSERT_LE(out.complex.c_vertex_count(), fine.c_vertex_count()) << what;
  ASSERT_EQ(out.representative.size(), out.complex.c_vertex_count()) << what;
  ASSERT_EQ(out.complex.spacing, fine.spacing) << what;
  std::set<CVertexId> seen;
  for (CVertexId v = 0; v < out.complex.c_vertex_count(); ++v) {
    const CVertexId r = out.representative[v];
    ASSERT_TRUE(seen.insert(r).second) << what << ": a representative twice";
    ASSERT_EQ(out.complex.positions[v], fine.positions[r]) << what;
    ASSERT_EQ(out.complex.on_boundary[v], fine.on_boundary[r]) << what;
  }
  for (const Face& f : out.complex.faces) ASSERT_TRUE(f.is_triangle()) << what;
  const MeshCounts before = count_manifold(fine), after = count_manifold(out.complex);
  ASSERT_EQ(after.components.size(), before.components.size()) << what;
  for (CVertexId v = 0; v < out.complex.c_vertex_count(); ++v) {
    const std::uint32_t c = before.component_of_vertex[out.representative[v]];
    ASSERT_EQ(after.components[after.component_of_vertex[v]], before.components[c]) << what;
  }
  ASSERT_EQ(kinds_of(triangles_of(out.complex)), kinds_of(triangles_of(fine))) << what;
}

TEST(Coarsen, KnownShapes) {
  for (const KnownVolume& known : known_volumes()) {
    for (const double block : {2.0, 4.0, 8.0}) {
      expect_coarser(surface_of(known.samples, known.isovalue), block, known.name);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Coarsen, RandomVolumes) {
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {3 + seed % 7, 8, 9}, seed);
    if (!has_surface(s, 0)) continue;
    for (const double block : {2.0, 4.0, 8.0}) {
      expect_coarser(surface_of(s), block,
                     std::string(name(family)) + " seed " + std::to_string(seed));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Coarsen, AnisotropicSpacing) {
  const Samples s = sampled({20, 20, 20}, gyroid(9.5, 0.1));
  for (const Vec3 spacing : {Vec3{1, 1, 5}, Vec3{0.2, 1, 3}}) {
    for (const double block : {0.3, 1.0, 4.0, 100.0}) {
      expect_coarser(surface_of(s, 0, Inside::above, spacing), block,
                     "block " + std::to_string(block));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Coarsen, ReducesASmoothSurface) {
  const SurfaceComplex fine = surface_of(sampled({50, 50, 50}, sphere({24.4, 24.6, 24.55}, 20)));
  EXPECT_LT(coarsen(fine, 2).complex.c_vertex_count(), fine.c_vertex_count() / 2);
  EXPECT_LT(coarsen(fine, 4).complex.c_vertex_count(), fine.c_vertex_count() / 8);
  EXPECT_LT(coarsen(fine, 8).complex.c_vertex_count(), fine.c_vertex_count() / 30);
}

TEST(Coarsen, TwiceInARow) {
  const SurfaceComplex fine = surface_of(sampled({40, 40, 40}, gyroid(13.1, 0.2)));
  const Coarsened once = coarsen(fine, 2);
  expect_coarser(once.complex, 4, "second step");
  EXPECT_EQ(kinds_of(triangles_of(coarsen(once.complex, 4).complex)), kinds_of(triangles_of(fine)));
}

TEST(Coarsen, TinyComplexes) {
  expect_coarser(tetrahedron(), 8, "tetrahedron");
  expect_coarser(flat_grid(2, 2), 8, "one quad");
  expect_coarser(tube(5, 2), 50, "ring");
}

TEST(Coarsen, CancelledBeforehand) {
  const std::atomic<bool> cancel{true};
  RunControl control;
  control.cancel = &cancel;
  EXPECT_THROW(coarsen(flat_grid(4, 4), 2, control), Error);
}

}  // namespace
}  // namespace isoatlas::detail
