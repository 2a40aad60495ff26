// SPDX-License-Identifier: Apache-2.0
#include "levels/rounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "isoatlas/error.h"
#include "support/levels.h"
#include "support/reference_topology.h"

namespace isoatlas::detail {
namespace {

using namespace test;

SurfaceComplex ball() {
  return surface_of(sampled({22, 22, 22}, sphere({10.4, 10.6, 10.55}, 8.3)));
}

struct Refined {
  explicit Refined(const SurfaceData& surface_data, float max_radius = 6)
      : measured(surface_data, disks(max_radius), {}, {}, {}) {
    measured.set_bounds(relaxed_bounds({}), Placement::surface);
    measured.update(level.certificate, {});
    first_sites = measured.partition().site;
  }
  void refine(const RefinementTask& task, const RunControl& control = {}) {
    RefinementRounds().refine(measured, task, level, control);
  }
  std::uint32_t sites() const { return measured.partition().cell_count(); }
  double worst() const {
    double out = 0;
    for (const CellError& e : measured.errors()) out = std::max(out, e.excess);
    return out;
  }
  float smallest_radius() const {
    const std::vector<float>& radius = measured.covering().radius();
    return *std::min_element(radius.begin(), radius.end());
  }

  MeasuredCovering measured;
  RefinedLevel level;
  std::vector<CVertexId> first_sites;
};

RefinementTask within_distance(double bound) {
  RefinementTask task;
  task.metrics = {{Quantity::max_distance, bound}};
  return task;
}

// What holds after every refinement: nested sites, every c-vertex covered, a certified partition,
// and errors that are up to date.
void expect_sound(const Refined& refined) {
  const MeasuredCovering& measured = refined.measured;
  const Partition& p = measured.partition();
  ASSERT_GE(p.site.size(), refined.first_sites.size());
  ASSERT_TRUE(std::equal(refined.first_sites.begin(), refined.first_sites.end(), p.site.begin()));
  for (CVertexId v = 0; v < p.cell_of.size(); ++v) ASSERT_TRUE(measured.covering().is_covered(v));
  ASSERT_TRUE(measured.covering().is_lipschitz());
  ASSERT_TRUE(refined.level.certificate.passed);
  const PartitionCheck full =
      check_partition(measured.surface_data().complex, p.cell_of, p.cell_count(), p.site);
  ASSERT_TRUE(full.passed());
  ASSERT_EQ(measured.triangles().size(), full.triangles.size());
  MeasuredCovering fresh(measured);
  CertificateReport report;
  fresh.update_all(report, {});
  for (CellId c = 0; c < p.cell_count(); ++c) {
    const double x = measured.errors()[c].excess, y = fresh.errors()[c].excess;
    ASSERT_TRUE((x > 1) == (y > 1) || std::abs(x - y) <= 1e-5) << x << " and " << y;
  }
}

// A cell that violates a bound cannot become smaller.
void expect_finished(const Refined& refined, const RefinementTask& task) {
  const MeasuredCovering& measured = refined.measured;
  const Covering& covering = measured.covering();
  for (CellId c = 0; c < refined.sites(); ++c) {
    if (measured.errors()[c].excess <= 1) continue;
    const CVertexId site = measured.partition().site[c], worst = measured.errors()[c].worst;
    ASSERT_LE(covering.radius()[site], min_useful_radius(task, measured.surface_data(), site));
    if (worst != kNone) {
      ASSERT_LT(covering.distance()[worst],
                min_useful_radius(task, measured.surface_data(), worst));
    }
  }
}

TEST(RelaxedBounds, ScalesEachBound) {
  const std::vector<Constraint> metrics{{Quantity::max_distance, 0.25},
                                        {Quantity::area_curvature, 1.5},
                                        {Quantity::normal_angle, 30, true}};
  EXPECT_EQ(relaxed_bounds(metrics), metrics);
  const std::vector<Constraint> want{{Quantity::max_distance, 1},
                                     {Quantity::area_curvature, 3},
                                     {Quantity::normal_angle, 120, true}};
  EXPECT_EQ(relaxed_bounds(metrics, 4), want);
  const std::vector<Constraint> none = relaxed_bounds({}, 4);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_EQ(none[0].quantity, Quantity::max_distance);
  EXPECT_EQ(none[0].bound, std::numeric_limits<double>::max());
}

TEST(MinRadius, IsTheLargestOfTheLimits) {
  const SurfaceComplex grid = flat_grid(5, 5);
  const SurfaceData surface_data(grid);
  const float farthest = surface_data.farthest_neighbour[12];
  ASSERT_NEAR(farthest, std::sqrt(2.0), 1e-6) << "across a face";
  RefinementTask task;
  EXPECT_EQ(min_radius(task, surface_data, 12), kLimitShare * farthest);
  EXPECT_EQ(min_useful_radius(task, surface_data, 12), kLimitShare * farthest);
  task.useful_radius = 1;
  EXPECT_EQ(min_radius(task, surface_data, 12), kLimitShare * farthest);
  EXPECT_EQ(min_useful_radius(task, surface_data, 12), 1);
  task.min_edge = 2;
  EXPECT_EQ(min_radius(task, surface_data, 12), 2.5f);
  EXPECT_EQ(min_useful_radius(task, surface_data, 12), 2.5f);
}

TEST(RefinementRounds, ChangesNothingWithoutConstraints) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined refined(surface_data);
  refined.refine({});
  EXPECT_EQ(refined.sites(), refined.first_sites.size());
  EXPECT_EQ(refined.level.rounds, 0u);
  EXPECT_FALSE(refined.level.vertex_limit_reached);
}

// Every c-vertex is compared with every triangle.
TEST(RefinementRounds, SatisfiesABoundOnTheDistance) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  std::size_t sites_before = 0;
  for (const double bound : {0.5, 0.15}) {
    Refined refined(surface_data);
    refined.refine(within_distance(bound));
    expect_sound(refined);
    EXPECT_LE(refined.worst(), 1);
    EXPECT_FALSE(refined.level.vertex_limit_reached);
    EXPECT_GT(refined.sites(), sites_before);
    sites_before = refined.sites();
    EXPECT_GT(refined.level.rounds, 0u);
    const LevelMesh& mesh = refined.measured.mesh();
    for (const Vec3 p : surface_data.surfels.point) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = mesh.corners(t);
        nearest = std::min(nearest, closest_on_triangle(p, a, b, c).squared_distance);
      }
      ASSERT_LE(std::sqrt(nearest), bound * (1 + 1e-6));
    }
  }
}

TEST(RefinementRounds, RefinesUntilCellsCannotBecomeSmaller) {
  const std::vector<std::vector<Constraint>> bounds{
      {{Quantity::max_distance, 0.3}},
      {{Quantity::normal_angle, 40}, {Quantity::mean_distance, 0.05}},
      {{Quantity::geodesic_ratio, 1.02}, {Quantity::area_curvature, 1.05}}};
  std::size_t at_limit = 0, violated = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    const Samples samples = random_samples(static_cast<Family>(seed % kFamilies), {6, 7, 5}, seed);
    if (!has_surface(samples, 0)) continue;
    const SurfaceComplex surface = surface_of(samples);
    const SurfaceData surface_data(surface);
    Refined refined(surface_data, 4);
    RefinementTask task;
    task.metrics = bounds[seed % bounds.size()];
    task.useful_radius = seed % 2 == 0 ? 0 : 1.5f;
    const double before = (refined.measured.set_bounds(task.metrics, task.placement),
                           refined.measured.update(refined.level.certificate, {}), refined.worst());
    violated += before > 1;
    refined.refine(task);
    expect_sound(refined);
    expect_finished(refined, task);
    at_limit += refined.worst() > 1;
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(violated, 8u);
  EXPECT_GT(at_limit, 2u);
}

TEST(RefinementRounds, NeverExceedsTheLimitOnVertices) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  const auto start = static_cast<std::uint32_t>(Refined(surface_data).sites());
  std::vector<double> errors;
  for (const std::uint32_t most :
       {0u, 1u, start - 1, start, start + 1, start + 2, start + 7, 100u, 200u, 400u}) {
    SCOPED_TRACE(most);
    Refined refined(surface_data);
    RefinementTask task = within_distance(0.01);
    task.max_sites = most;
    refined.refine(task);
    expect_sound(refined);
    if (most <= start) {
      EXPECT_EQ(refined.sites(), start) << "too few: nothing changes";
    } else {
      EXPECT_LE(refined.sites(), most);
    }
    if (most >= 100) {
      EXPECT_GE(refined.sites(), most - most / 10) << "nearly all are used";
    }
    EXPECT_TRUE(refined.level.vertex_limit_reached);
    refined.measured.set_bounds(task.metrics, task.placement);
    refined.measured.update_all(refined.level.certificate, {});
    if (most >= start) errors.push_back(refined.worst());
  }
  EXPECT_LE(errors[1], errors[0]) << "the last vertex does not increase the largest error";
  EXPECT_LT(errors.back(), 0.5 * errors.front());
}

// In noise one step may need many vertices, because the topology of the dual is repaired. Steps
// that exceed the limit are reverted, and so is one that uses the last vertex in vain.
TEST(RefinementRounds, RevertsStepsThatNeedTooManyVertices) {
  std::size_t more = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const SurfaceComplex surface = surface_of(random_samples(Family::white_noise, {9, 9, 9}, seed));
    const SurfaceData surface_data(surface);
    const Refined start(surface_data, 8);
    for (std::uint32_t room = 1; room < 5; ++room) {
      Refined refined(start);
      RefinementTask task = within_distance(0.05);
      task.max_sites = start.sites() + room;
      refined.measured.set_bounds(task.metrics, task.placement);
      refined.measured.update_all(refined.level.certificate, {});
      const double before = refined.worst();
      refined.refine(task);
      ASSERT_LE(refined.sites(), task.max_sites);
      expect_sound(refined);
      if (HasFatalFailure()) return;
      refined.measured.set_bounds(task.metrics, task.placement);
      refined.measured.update_all(refined.level.certificate, {});
      if (room == 1) {
        EXPECT_LE(refined.worst(), before);
      }
      more += refined.sites() > start.sites();
    }
  }
  EXPECT_GT(more, 3u);
}

// A limit on vertices that suffices does not matter.
TEST(RefinementRounds, SatisfiesBoundsBelowTheLimitOnVertices) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined refined(surface_data);
  RefinementTask task = within_distance(0.3);
  task.max_sites = 2000;
  refined.refine(task);
  expect_sound(refined);
  EXPECT_LE(refined.worst(), 1);
  EXPECT_FALSE(refined.level.vertex_limit_reached);
}

// More vertices than bounds need. Cells become smaller evenly, until there are just enough.
TEST(RefinementRounds, ReachesTheMinimumNumberOfVertices) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  for (const std::uint32_t fewest : {60u, 150u, 301u}) {
    for (const std::uint32_t most : {kNone, fewest}) {
      for (const bool has_bound : {false, true}) {
        SCOPED_TRACE(fewest);
        Refined refined(surface_data);
        RefinementTask task;
        if (has_bound) task.metrics = within_distance(2).metrics;
        task.min_sites = fewest;
        task.max_sites = most;
        refined.refine(task);
        expect_sound(refined);
        EXPECT_GE(refined.sites(), fewest - (most == kNone ? 0 : fewest / 10));
        EXPECT_LE(refined.sites(), most == kNone ? fewest + 4 : fewest);
        EXPECT_TRUE(!has_bound || refined.worst() <= 1);
      }
    }
  }
}

// Limits on radii have priority: bounds stay violated.
TEST(RefinementRounds, KeepsRadiiAboveTheirLimit) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined free(surface_data), limited(surface_data);
  RefinementTask task = within_distance(0.02);
  free.refine(task);
  task.min_edge = 2;
  limited.refine(task);
  expect_sound(limited);
  expect_finished(limited, task);
  EXPECT_GT(limited.worst(), 1);
  EXPECT_LT(free.smallest_radius(), 1.5f);
  EXPECT_GE(limited.smallest_radius(), 2.5f * (1 - 1e-5f));
  task.min_edge = 0;
  task.useful_radius = 2;
  Refined useful(surface_data);
  useful.refine(task);
  expect_finished(useful, task);
  EXPECT_GE(useful.smallest_radius(), 2 * (1 - 1e-5f));
  EXPECT_GT(useful.sites(), limited.sites());
}

std::size_t count_bad(const Refined& refined, const ShapeGoal& goal) {
  std::size_t out = 0;
  const LevelMesh& mesh = refined.measured.mesh();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    out += goal.score(a, b, c) < 1;
  }
  return out;
}

// Where a badly shaped triangle is left, no site can be inserted.
TEST(RefinementRounds, InsertsSitesAtBadlyShapedTriangles) {
  const SurfaceComplex surface = exact_surface({24, 24, 24}, torus({11.4, 11.6, 11.55}, 6.5, 3));
  const SurfaceData surface_data(surface);
  const ShapeGoal goal = ShapeGoal::of(0.45);
  RefinementTask task = within_distance(0.3);
  Refined without(surface_data), with(surface_data);
  without.refine(task);
  task.shape = goal;
  with.refine(task);
  expect_sound(with);
  EXPECT_LE(with.worst(), 1);
  EXPECT_GT(with.sites(), without.sites());
  const std::size_t bad = count_bad(without, goal);
  EXPECT_GT(bad, 5u);
  EXPECT_LT(static_cast<double>(count_bad(with, goal)) / with.sites(),
            static_cast<double>(bad) / without.sites());
  const MeasuredCovering& measured = with.measured;
  for (std::uint32_t t = 0; t < measured.mesh().triangles.size(); ++t) {
    const auto [a, b, c] = measured.mesh().corners(t);
    if (goal.score(a, b, c) >= 1) continue;
    const CVertexId v = measured.triangles()[t].at;
    EXPECT_LT(measured.covering().distance()[v], min_radius(task, surface_data, v));
  }
  Refined limited(surface_data);
  task.max_sites = without.sites() + 10;
  limited.refine(task);
  expect_sound(limited);
  EXPECT_LE(limited.sites(), task.max_sites);
}

// The new radii are the old ones, lowered at the corners of bad triangles and, 1/3-Lipschitz,
// around these.
TEST(ShrinkCellsAtBadTriangles, LowersTheRadiiOfTheirCorners) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined refined(surface_data);
  MeasuredCovering& measured = refined.measured;
  const std::vector<float> before = measured.covering().radius();
  RefinementTask task;
  task.shape = ShapeGoal{1e-9, 1e-9};
  EXPECT_FALSE(shrink_cells_at_bad_triangles(measured, task, measured.triangles()));
  EXPECT_EQ(measured.covering().radius(), before);
  task.shape = ShapeGoal{0.75, 0.3};
  task.limit_share = 1e6f;
  EXPECT_FALSE(shrink_cells_at_bad_triangles(measured, task, measured.triangles()));
  EXPECT_EQ(measured.covering().radius(), before) << "at their limits";
  task.limit_share = kLimitShare;
  task.min_edge = 0.9f * before[measured.partition().site[0]] / kChordSlack;
  std::vector<float> want = before;
  std::size_t bad = 0, good = 0;
  for (std::uint32_t t = 0; t < measured.mesh().triangles.size(); ++t) {
    const auto [a, b, c] = measured.mesh().corners(t);
    (task.shape->score(a, b, c) < 1 ? bad : good) += 1;
    if (task.shape->score(a, b, c) >= 1) continue;
    for (const CellId cell : measured.mesh().triangles[t]) {
      const CVertexId v = measured.partition().site[cell];
      want[v] = std::min(before[v], std::max(min_radius(task, surface_data, v), 0.8f * before[v]));
    }
  }
  ASSERT_GT(bad, 3u);
  ASSERT_GT(good, 3u);
  for (bool any = true; any;) {
    any = false;
    for (CVertexId v = 0; v < want.size(); ++v) {
      for (const CVertexGraph::Neighbour& n : surface_data.graph.row(v)) {
        const float most = want[v] + n.weight * (1.0f / 3.0f);
        if (want[n.id] <= most * (1 + 1e-6f)) continue;
        want[n.id] = most;
        any = true;
      }
    }
  }
  EXPECT_TRUE(shrink_cells_at_bad_triangles(measured, task, measured.triangles()));
  std::size_t lowered = 0, kept = 0;
  for (CVertexId v = 0; v < want.size(); ++v) {
    ASSERT_NEAR(measured.covering().radius()[v], want[v], 1e-4 * want[v]) << v;
    (want[v] < before[v] ? lowered : kept) += 1;
  }
  EXPECT_GT(lowered, 3u);
  EXPECT_GT(kept, 3u);
}

TEST(RefinementRounds, DoesNotDependOnTheNumberOfThreads) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  std::vector<CVertexId> sites;
  std::vector<double> errors;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    Refined refined(surface_data);
    RefinementTask task = within_distance(0.05);
    task.shape = ShapeGoal{};
    task.max_sites = 300;
    refined.refine(task);
    std::vector<double> own;
    for (const CellError& e : refined.measured.errors()) own.push_back(e.excess);
    if (threads == 1) {
      sites = refined.measured.partition().site;
      errors = own;
    }
    EXPECT_EQ(refined.measured.partition().site, sites) << threads;
    EXPECT_EQ(own, errors) << threads;
  }
}

TEST(RefinementRounds, StopsWhenCancelled) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined refined(surface_data);
  std::atomic<bool> cancel = false;
  RunControl control;
  control.cancel = &cancel;
  std::size_t reports = 0;
  control.progress = [&](std::string_view, double) { cancel = ++reports == 2; };
  try {
    refined.refine(within_distance(0.02), control);
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(reports, 2u);
}

TEST(RefinementRounds, ReportsProgressInEveryRound) {
  const SurfaceComplex surface = ball();
  const SurfaceData surface_data(surface);
  Refined refined(surface_data);
  std::vector<double> fractions;
  RunControl control;
  control.progress = [&](std::string_view stage, double fraction) {
    if (stage == "refine") fractions.push_back(fraction);
  };
  refined.refine(within_distance(0.02), control);
  ASSERT_EQ(fractions.size(), refined.level.rounds + 1);
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 0.25) << "its share of a level's time";
  for (const double f : fractions) EXPECT_TRUE(f >= 0 && f <= 0.25) << f;
  EXPECT_GT(fractions[fractions.size() / 2], 0);
  EXPECT_LT(fractions[fractions.size() / 2], 0.25);
}

}  // namespace
}  // namespace isoatlas::detail
