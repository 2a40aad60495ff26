// SPDX-License-Identifier: Apache-2.0
// The conditions that the paper states for its disks, each checked independently; and that a
// covering can start from them.
#include "voronoi/halving_covering.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>

#include "support/reference_topology.h"
#include "support/surfaces.h"
#include "voronoi/certified_dual.h"

namespace isoatlas::detail {
namespace {

using namespace test;

CoveringOptions options(float max_radius, float persistence = 0) {
  return {max_radius, persistence, 4};
}

std::vector<std::pair<std::string, SurfaceComplex>> surfaces() {
  std::vector<std::pair<std::string, SurfaceComplex>> out{
      {"grid", flat_grid(17, 13)}, {"tube", tube(11, 20)}, {"tetrahedron", tetrahedron()}};
  for (const KnownVolume& known : known_volumes()) {
    if (known.samples.values.size() < 16000)
      out.emplace_back(known.name, surface_of(known.samples, known.isovalue));
  }
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {8, 7, 9}, seed);
    if (has_surface(s, 0))
      out.emplace_back(name(family),
                       surface_of(s, 0, Inside::above, seed % 2 ? Vec3{1, 1, 1} : Vec3{1, 2, 0.5}));
  }
  return out;
}

// A plane with a thin chimney.
SurfaceComplex chimney() {
  return surface_of(sampled({50, 46, 20}, [](double x, double y, double z) {
    return std::max(5.4 - z, std::min(1.7 - std::hypot(x - 22.4, y - 23.6), 15.4 - z));
  }));
}

// Distances in double precision, so "nearer" is only sure by a little more than rounding.
constexpr double kMore = 1.0001, kLess = 0.9999;

void expect_promises(const CVertexGraph& graph, const DiskCovering& disks,
                     const CoveringOptions& options, const std::string& what) {
  const std::size_t n = disks.sites.size();
  ASSERT_EQ(disks.radii.size(), n) << what;
  std::vector<std::uint8_t> covered(graph.c_vertex_count(), 0);
  std::vector<std::vector<std::size_t>> disks_of(graph.c_vertex_count());
  EventFinder events(graph, options.event_persistence, options.first_stage);
  for (std::size_t a = 0; a < n; ++a) {
    const float radius = disks.radii[a];
    int power = 0;
    ASSERT_EQ(std::frexp(options.max_radius / radius, &power), 0.5f)
        << what << ": not R_g / 2^i: " << radius;
    ASSERT_GE(power, 1) << what << ": larger than R_g: " << radius;
    ASSERT_EQ(events.event_radius(disks.sites[a], radius), radius)
        << what << ": an event in disk " << a;
    const std::vector<double> d = slow_distances(graph, {disks.sites[a]});
    for (std::size_t b = 0; b < n; ++b) {
      ASSERT_TRUE(a == b || d[disks.sites[b]] > radius * kLess)
          << what << ": site " << b << " is in disk " << a;
    }
    for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
      covered[v] |= d[v] < radius * kMore;
      if (d[v] < radius * kLess) disks_of[v].push_back(a);
    }
  }
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    ASSERT_TRUE(covered[v]) << what << ": " << v;
    for (const std::size_t a : disks_of[v]) {
      for (const std::size_t b : disks_of[v])
        ASSERT_LE(disks.radii[a], 2 * disks.radii[b]) << what << ": disks " << a << " and " << b;
    }
  }
}

TEST(HalvingCovering, SatisfiesThePapersConditions) {
  for (const auto& [what, surface] : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    for (const float radius : {2.5f, 8.0f, 1000.0f}) {
      for (const float persistence : {0.0f, 1.5f}) {
        const DiskCovering disks = cover_by_halving(graph, options(radius, persistence), {});
        if (disks.sites.size() > 150) continue;
        expect_promises(graph, disks, options(radius, persistence),
                        what + ", radius " + std::to_string(radius));
        if (HasFatalFailure()) return;
      }
    }
  }
}

// With whole numbers the result can be derived by hand: the first site is at one end, every other
// one at the nearest c-vertex that is not forbidden.
TEST(HalvingCovering, StripByHand) {
  const CVertexGraph graph = make_graph(flat_grid(33, 2));
  const DiskCovering disks = cover_by_halving(graph, options(4), {});
  EXPECT_EQ(disks.sites, (std::vector<CVertexId>{0, 4, 8, 12, 16, 20, 24, 28, 32}));
  EXPECT_EQ(disks.radii, std::vector<float>(9, 4));
}

// A disk on a tube of circumference 12 touches itself at a distance of 6, so of 16 / 2^i the radius
// is 4 everywhere.
TEST(HalvingCovering, EventsHalveTheRadius) {
  const CVertexGraph graph = make_graph(tube(12, 41));
  const DiskCovering disks = cover_by_halving(graph, options(16), {});
  EXPECT_EQ(disks.radii, std::vector<float>(disks.radii.size(), 4));
  // Bin 0 is three radii away from all disks; in it come boundary c-vertices, then the others, in
  // the order of their ids.
  EXPECT_EQ(disks.sites[0], 0u);
  EXPECT_EQ(disks.sites[1], 12 * 40u) << "at the other end";
  const std::vector<double> d = slow_distances(graph, {0});
  EXPECT_GE(d[disks.sites[2]], 12);
  EXPECT_LT(d[disks.sites[2]], 13.5);
}

// Disks on the chimney are small, and radii of overlapping disks differ by at most a factor of two.
TEST(HalvingCovering, RadiiGrowByFactorsOfTwoAwayFromAChimney) {
  const SurfaceComplex surface = chimney();
  const CVertexGraph graph = make_graph(surface);
  const DiskCovering disks = cover_by_halving(graph, options(24), {});
  const std::set<float> radii(disks.radii.begin(), disks.radii.end());
  EXPECT_GE(radii.size(), 3u);
  EXPECT_LT(*radii.begin(), 5.5f);
  EXPECT_GE(*radii.rbegin(), 12);
  expect_promises(graph, disks, options(24), "chimney");
}

TEST(HalvingCovering, TerminatesForAnyLargestRadius) {
  const SurfaceComplex surface = surface_of(random_samples(Family::gyroid_cut, {10, 10, 10}, 3));
  const CVertexGraph graph = make_graph(surface);
  for (const float radius : {1e30f, 1e-4f, 1e-30f}) {
    const DiskCovering disks = cover_by_halving(graph, options(radius), {});
    if (radius < 1) {
      EXPECT_EQ(disks.sites.size(), graph.c_vertex_count());
    } else {
      expect_promises(graph, disks, options(radius), "radius 1e30");
    }
  }
}

TEST(HalvingCovering, SeedsACertifiedCovering) {
  for (const auto& [what, surface] : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    for (const float radius : {4.0f, 1000.0f}) {
      const DiskCovering disks = cover_by_halving(graph, options(radius), {});
      Covering covering(graph, options(radius));
      cover_from(disks, graph, covering, {});
      const Partition& p = covering.partition();
      ASSERT_GE(p.site.size(), disks.sites.size());
      ASSERT_TRUE(std::equal(disks.sites.begin(), disks.sites.end(), p.site.begin()))
          << what << ": disks keep their order";
      ASSERT_EQ(std::set<CVertexId>(p.site.begin(), p.site.end()).size(), p.site.size())
          << what << ": a site twice";
      const std::vector<double> distance = slow_distances(graph, p.site);
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
        ASSERT_NEAR(covering.distance()[v], distance[v], 1e-4 * (1 + distance[v]))
            << what << ": distance of " << v;
        ASSERT_TRUE(covering.is_covered(v)) << what << ": " << v;
        ASSERT_TRUE(!graph.on_boundary[v] || graph.on_boundary[p.site[p.cell_of[v]]])
            << what << ": boundary owned from inside";
      }
      CertificateReport report;
      CertifiedDual dual(surface, covering);
      dual.certify(report, {});
      ASSERT_TRUE(report.passed) << what;
      ASSERT_EQ(kinds_of(triangles_of(dual_complex(surface, p, dual.triangles()))),
                kinds_of(triangles_of(surface)))
          << what;
    }
  }
}

TEST(HalvingCovering, Cancelled) {
  const CVertexGraph graph = make_graph(flat_grid(30, 30));
  const std::atomic<bool> cancel{true};
  RunControl control;
  control.cancel = &cancel;
  EXPECT_THROW(cover_by_halving(graph, options(2), control), Error);
}

}  // namespace
}  // namespace isoatlas::detail
