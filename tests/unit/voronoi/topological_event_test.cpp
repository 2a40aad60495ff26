// SPDX-License-Identifier: Apache-2.0
// Event radii that are known from geometry. Graph distances are up to 8 % longer than geodesic
// ones.
#include "voronoi/topological_event.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vector_math.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr float kFar = 1000;

CVertexId nearest_to(const SurfaceComplex& surface, Vec3 p) {
  CVertexId best = 0;
  for (CVertexId v = 1; v < surface.c_vertex_count(); ++v) {
    if (squared_length(surface.positions[v] - p) < squared_length(surface.positions[best] - p))
      best = v;
  }
  return best;
}

TEST(TopologicalEvent, FrontTouchesItselfBehindATube) {
  for (const std::uint32_t around : {8u, 16u, 31u}) {
    const SurfaceComplex t = tube(around, 4 * around + 1);
    const CVertexGraph graph = make_graph(t);
    for (const float persistence : {0.0f, 1.5f}) {
      EventFinder finder(graph, persistence, 4);
      const float radius = finder.event_radius(around * (2 * around) + 3, kFar);
      EXPECT_GT(radius, 0.45f * static_cast<float>(around)) << persistence;
      EXPECT_LT(radius, 0.55f * static_cast<float>(around) + 1) << persistence;
    }
  }
}

TEST(TopologicalEvent, TubeOfAVolume) {
  constexpr double r = 5.3;
  const SurfaceComplex surface = surface_of(sampled(
      {16, 16, 50}, [](double x, double y, double) { return r - std::hypot(x - 7.4, y - 7.6); }));
  const CVertexGraph graph = make_graph(surface);
  EventFinder finder(graph, 1.5f, 4);
  const float radius = finder.event_radius(nearest_to(surface, {7.4 + r, 7.6, 25}), kFar);
  EXPECT_GT(radius, 0.95 * M_PI * r);
  EXPECT_LT(radius, 1.12 * M_PI * r + 1);
}

TEST(TopologicalEvent, FrontTouchesItselfAroundATorus) {
  const SurfaceComplex surface =
      surface_of(sampled({44, 44, 14}, torus({21.4, 21.6, 6.55}, 15, 4.1)));
  const CVertexGraph graph = make_graph(surface);
  EventFinder finder(graph, 1.5f, 4);
  for (const Vec3 from : {Vec3{21.4 + 19.1, 21.6, 6.55}, Vec3{21.4, 21.6 - 19.1, 6.55},
                          Vec3{21.4 + 15, 21.6, 6.55 + 4.1}}) {
    const float radius = finder.event_radius(nearest_to(surface, from), kFar);
    EXPECT_GT(radius, 0.95 * M_PI * 4.1);
    EXPECT_LT(radius, 1.12 * M_PI * 4.1 + 1);
  }
}

TEST(TopologicalEvent, SphereIsSwallowedAtTheAntipode) {
  constexpr double r = 9.2;
  const SurfaceComplex surface = surface_of(sampled({24, 24, 24}, sphere({11.4, 11.6, 11.55}, r)));
  const CVertexGraph graph = make_graph(surface);
  EventFinder finder(graph, 1.5f, 4);
  for (const Vec3 from :
       {Vec3{11.4 + r, 11.6, 11.55},
        Vec3{11.4 + r / std::sqrt(3), 11.6 + r / std::sqrt(3), 11.55 + r / std::sqrt(3)}}) {
    const CVertexId v = nearest_to(surface, from);
    const float radius = finder.event_radius(v, kFar);
    EXPECT_GT(radius, 0.95 * M_PI * r);
    EXPECT_LT(radius, 1.1 * M_PI * r);
    const std::vector<double> d = slow_distances(graph, {v});
    EXPECT_LE(radius, *std::max_element(d.begin(), d.end()) * 1.0001)
        << "no event is later than the end";
  }
}

TEST(TopologicalEvent, PlaneHasNoneBelowTheLimit) {
  const SurfaceComplex grid = flat_grid(41, 41);
  const CVertexGraph graph = make_graph(grid);
  for (const float persistence : {0.0f, 1.5f}) {
    EventFinder finder(graph, persistence, 4);
    for (const float limit : {0.5f, 1.0f, 5.0f, 12.0f, 19.0f}) {
      EXPECT_EQ(finder.event_radius(20 + 41 * 20, limit), limit);
      EXPECT_EQ(finder.event_radius(0, limit), limit) << "from a corner";
      EXPECT_EQ(finder.event_radius(20, limit), limit) << "from a side";
    }
    // The farthest c-vertex ends it.
    const std::vector<double> d = slow_distances(graph, {20 + 41 * 20});
    EXPECT_NEAR(finder.event_radius(20 + 41 * 20, kFar), *std::max_element(d.begin(), d.end()),
                1e-3);
  }
}

TEST(TopologicalEvent, DoesNotDependOnTheFirstStageOrOnEarlierCalls) {
  const SurfaceComplex surface =
      surface_of(sampled({28, 28, 14}, torus({13.4, 13.6, 6.55}, 8, 3.2)));
  const CVertexGraph graph = make_graph(surface);
  EventFinder reused(graph, 1.5f, 4);
  for (CVertexId v = 0; v < surface.c_vertex_count(); v += 37) {
    for (const float limit : {3.0f, 8.0f, kFar}) {
      const float want = reused.event_radius(v, limit);
      for (const float stage : {0.5f, 1.0f, 3.0f, 16.0f, 500.0f}) {
        EventFinder fresh(graph, 1.5f, stage);
        EXPECT_EQ(fresh.event_radius(v, limit), want) << "first stage " << stage;
      }
    }
    EXPECT_EQ(reused.event_radius(v, 3.0f), std::min(3.0f, reused.event_radius(v, kFar)));
  }
}

// A plane with a chimney: the front closes behind the chimney and leaves its top as an island that
// closes at the tip.
TEST(TopologicalEvent, ChimneyCountsOnlyBelowItsPersistence) {
  constexpr double height = 14;
  const SurfaceComplex surface = surface_of(sampled({90, 80, 26}, [](double x, double y, double z) {
    const double plane = 5.4 - z,
                 chimney = std::min(3.2 - std::hypot(x - 44.4, y - 39.6), 5.4 + height - z);
    return std::max(plane, chimney);
  }));
  const CVertexGraph graph = make_graph(surface);
  const CVertexId v = nearest_to(surface, {44.4 - 12, 39.6, 5.4});
  const std::vector<double> d = slow_distances(graph, {v});
  const double behind = d[nearest_to(surface, {44.4 + 5, 39.6, 5.4})],
               tip = d[nearest_to(surface, {44.4, 39.6, 5.4 + height})];
  constexpr float limit = 30;  // less than the distance to the volume's faces
  ASSERT_LT(behind, limit - 4);
  ASSERT_GT(tip, behind + 4);
  for (const float persistence : {0.0f, 1.5f, 4.0f}) {
    EventFinder finder(graph, persistence, 4);
    const float radius = finder.event_radius(v, limit);
    EXPECT_GT(radius, 9) << "before the chimney is reached, persistence " << persistence;
    EXPECT_LT(radius, behind + 2) << "persistence " << persistence;
  }
  EventFinder patient(graph, static_cast<float>(tip - behind + 8), 4);
  EXPECT_EQ(patient.event_radius(v, limit), limit);
}

// The same with a low bump: no event at the default persistence.
TEST(TopologicalEvent, LowBumpIsNoEvent) {
  const SurfaceComplex surface = surface_of(sampled({64, 64, 16}, [](double x, double y, double z) {
    return 5.4 + 1.2 * std::exp(-(std::pow(x - 31.4, 2) + std::pow(y - 31.6, 2)) / 4) - z;
  }));
  const CVertexGraph graph = make_graph(surface);
  EventFinder finder(graph, 1.5f, 4);
  EXPECT_EQ(finder.event_radius(nearest_to(surface, {31.4 - 10, 31.6, 5.4}), 18), 18);
}

// A handle never closes: it limits the disk for any persistence.
TEST(TopologicalEvent, HandleHasInfinitePersistence) {
  const SurfaceComplex t = tube(12, 121);
  const CVertexGraph graph = make_graph(t);
  EventFinder finder(graph, 25, 4);
  const float radius = finder.event_radius(12 * 60, kFar);
  EXPECT_GT(radius, 5);
  EXPECT_LT(radius, 8);
}

// On a sphere or a disk every island closes again, so with an unlimited persistence only the end of
// the component stops the disk; on any other surface a loop that never closes must stop it earlier.
TEST(TopologicalEvent, OnlyHandlesAndHolesNeverClose) {
  std::vector<std::pair<std::string, SurfaceComplex>> surfaces;
  for (const KnownVolume& known : known_volumes())
    surfaces.emplace_back(known.name, surface_of(known.samples, known.isovalue));
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {11, 12, 13}, seed);
    if (has_surface(s, 0))
      surfaces.emplace_back(std::string(name(family)) + " seed " + std::to_string(seed),
                            surface_of(s));
  }
  Random random(1);
  int closing = 0, never = 0;
  for (const auto& [what, surface] : surfaces) {
    const CVertexGraph graph = make_graph(surface);
    const MeshCounts counts = count_manifold(surface);
    EventFinder finder(graph, 1e6f, 4);
    for (int k = 0; k < 12; ++k) {
      const auto v = static_cast<CVertexId>(random.bits() % graph.c_vertex_count());
      double end = 0;
      for (const double d : slow_distances(graph, {v}))
        end = std::isinf(d) ? end : std::max(end, d);
      const ComponentTopology& kind = counts.components[counts.component_of_vertex[v]];
      const float radius = finder.event_radius(v, kFar);
      if (kind.genus() == 0 && kind.boundary_loops <= 1) {
        ++closing;
        EXPECT_NEAR(radius, end, 1e-3 * end) << what << ", from c-vertex " << v;
      } else {
        ++never;
        EXPECT_LT(radius, end * 0.9999) << what << ", from c-vertex " << v << ", genus "
                                        << kind.genus() << ", " << kind.boundary_loops << " loops";
      }
    }
  }
  EXPECT_GT(closing, 200);
  EXPECT_GT(never, 100);
}

// Scaling all lengths scales the radius.
TEST(TopologicalEvent, ScalesWithTheWorld) {
  const Samples s = sampled({28, 28, 14}, torus({13.4, 13.6, 6.55}, 8, 3.2));
  const SurfaceComplex one = surface_of(s), four = surface_of(s, 0, Inside::above, {4, 4, 4});
  const CVertexGraph g1 = make_graph(one), g4 = make_graph(four);
  EventFinder f1(g1, 1.5f, 4), f4(g4, 6, 16);
  for (CVertexId v = 0; v < one.c_vertex_count(); v += 53) {
    EXPECT_NEAR(4 * f1.event_radius(v, kFar), f4.event_radius(v, kFar), 1e-3);
  }
}

}  // namespace
}  // namespace isoatlas::detail
