// SPDX-License-Identifier: Apache-2.0
// Incremental updates yield the same state as complete ones.
#include "error/measured_covering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "complex/coarsen.h"
#include "support/levels.h"
#include "support/reference_topology.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<SurfaceComplex> surfaces() {
  std::vector<SurfaceComplex> out;
  out.push_back(surface_of(sampled({24, 24, 24}, sphere({11.4, 11.6, 11.55}, 9))));
  out.push_back(surface_of(sampled({20, 18, 19}, gyroid(11.3, 0.1))));
  out.push_back(surface_of(random_samples(Family::white_noise, {7, 8, 6}, 3)));
  out.push_back(surface_of(random_samples(Family::gyroid_cut, {11, 9, 10}, 5), 0, Inside::above,
                           {1, 2, 0.5}));
  out.push_back(surface_of(random_samples(Family::checkerboard, {6, 5, 6}, 2)));
  return out;
}

std::vector<std::array<CellId, 3>> set_of(const std::vector<DualTriangle>& triangles) {
  std::vector<std::array<CellId, 3>> out;
  for (DualTriangle t : triangles) {
    std::rotate(t.cell.begin(), std::min_element(t.cell.begin(), t.cell.end()), t.cell.end());
    out.push_back(t.cell);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Face nodes are on edges of the grid that was parsed, except those of faces that were split.
TEST(FaceNodes, AreOnGridEdges) {
  const Volume volume = exact_volume({14, 15, 16}, sphere({6.4, 16.6, 7.55}, 9));
  for (const std::uint32_t factor : {1u, 3u}) {
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      ParseOptions options;
      options.supersample = factor;
      options.interpolation = interpolation;
      const SurfaceComplex surface = parse_surface(volume, options);
      const Isosurface isosurface(volume, options.rule, surface, interpolation, factor);
      const InterpolatedField field(volume, options.rule, interpolation);
      const FaceNodes between(surface, isosurface);
      std::size_t seen = 0;
      for (CVertexId v = 0; v < surface.c_vertex_count(); ++v) {
        between.for_each_at(v, [&](Vec3 p, const Face&) {
          int whole = 0;
          for (const double x : {p.x, p.y, p.z})
            whole += std::abs(factor * x - std::round(factor * x)) < 1e-9 ? 1 : 0;
          ASSERT_GE(whole, 2);
          ASSERT_LT(std::abs(field.at(p).value), 1e-6);
          ++seen;
        });
      }
      EXPECT_EQ(seen, surface.faces.size());
    }
  }
}

void expect_same(const MeasuredCovering& a, const MeasuredCovering& b) {
  ASSERT_EQ(a.partition().site, b.partition().site);
  ASSERT_EQ(a.partition().cell_of, b.partition().cell_of);
  ASSERT_EQ(a.placement().anchor, b.placement().anchor);
  ASSERT_EQ(set_of(a.triangles()), set_of(b.triangles()));
  for (CellId c = 0; c < a.partition().cell_count(); ++c) {
    const double x = a.errors()[c].excess, y = b.errors()[c].excess;
    ASSERT_TRUE(x == y || std::abs(x - y) <= 1e-5 * (1 + y))
        << x << " and " << y << " in cell " << c;
  }
}

void insert_some(MeasuredCovering& work, Random& random, int count) {
  Covering& covering = work.covering();
  for (int k = 0; k < count; ++k) {
    const auto v = static_cast<CVertexId>(random.bits() % covering.distance().size());
    if (covering.distance()[v] == 0) continue;
    covering.lower_radius(v, covering.distance()[v]);
    if (random.bits() % 2) covering.insert(v);
  }
}

std::vector<std::vector<Constraint>> bound_sets() {
  return {{{Quantity::max_distance, 0.2}},
          {{Quantity::mean_distance, 0.1}, {Quantity::normal_angle, 30}},
          {{Quantity::area_curvature, 1.05}, {Quantity::area_curvature_smooth, 1.01}},
          {{Quantity::geodesic_ratio, 1.05}, {Quantity::max_edge, 2}},
          {{Quantity::max_edge, 2}, {Quantity::max_distance, 0.5}}};
}

TEST(MeasuredCovering, IncrementalUpdatesEqualANewMeasurement) {
  Random random(7);
  for (const SurfaceComplex& surface : surfaces()) {
    const SurfaceData surface_data(surface);
    for (const auto& set_bounds : bound_sets()) {
      MeasuredCovering work(surface_data, disks(8), {}, {}, {});
      CertificateReport report;
      work.set_bounds(set_bounds, Placement::surface);
      work.update(report, {});
      for (int round = 0; round < 6; ++round) {
        insert_some(work, random, 4);
        work.update(report, {});
        ASSERT_TRUE(report.passed);
        MeasuredCovering fresh(work);
        fresh.update_all(report, {});
        expect_same(work, fresh);
        if (HasFatalFailure()) return;
      }
    }
  }
}

// The same with the trilinear isosurface, with bounds that are tightened in between, and with a
// quick first measurement.
TEST(MeasuredCovering, IncrementalUpdatesEqualANewMeasurementWithTheIsosurface) {
  const std::vector<std::pair<Samples, Vec3>> cases{
      {sampled({24, 24, 24}, sphere({11.4, 11.6, 11.55}, 9)), {1, 1, 1}},
      {sampled({20, 18, 19}, gyroid(11.3, 0.1)), {1, 2, 1.5}},
      {random_samples(Family::white_noise, {7, 8, 6}, 3), {1, 1, 1}}};
  Random random(9);
  for (const auto& [samples, spacing] : cases) {
    const Volume volume = to_volume(samples, SampleType::int16, spacing);
    ParseOptions parse;
    const SurfaceComplex surface = parse_surface(volume, parse);
    const Isosurface isosurface(volume, parse.rule, surface);
    const SurfaceData surface_data(surface, &isosurface);
    MeasuredCovering work(surface_data, disks(8), {}, {}, {});
    CertificateReport report;
    double bound = 2;
    work.set_bounds(std::array{Constraint{Quantity::max_distance, bound}}, Placement::surface, 0.5);
    work.update(report, {});
    for (int round = 0; round < 10; ++round) {
      insert_some(work, random, 4);
      if (round % 2) {
        work.tighten_bounds(0.6);
        bound *= 0.6;
      }
      work.update(report, {});
      MeasuredCovering fresh(work);
      fresh.set_bounds(std::array{Constraint{Quantity::max_distance, bound * 2}},
                       Placement::surface);
      fresh.set_bounds(std::array{Constraint{Quantity::max_distance, bound}}, Placement::surface);
      fresh.update(report, {});
      ASSERT_EQ(set_of(work.triangles()), set_of(fresh.triangles()));
      for (CellId c = 0; c < work.partition().cell_count(); ++c) {
        // The exact excess may differ, but not on which side of its bound a cell is.
        const double x = work.errors()[c].excess, y = fresh.errors()[c].excess;
        ASSERT_TRUE((x > 1) == (y > 1) || std::abs(x - y) <= 1e-5)
            << x << " and " << y << " in cell " << c;
      }
    }
  }
}

// Removing sites restores partition and dual, whatever was done since; the errors equal those of a
// new measurement. (If two triangles are equally close, their ids decide which one counts.)
TEST(MeasuredCovering, RemoveSitesRestoresTheState) {
  Random random(11);
  for (const SurfaceComplex& surface : surfaces()) {
    const SurfaceData surface_data(surface);
    for (const auto& set_bounds : bound_sets()) {
      MeasuredCovering work(surface_data, disks(8), {}, {}, {});
      CertificateReport report;
      work.set_bounds(set_bounds, Placement::surface);
      work.update(report, {});
      for (int round = 0; round < 6; ++round) {
        const MeasuredCovering before(work);
        for (std::uint64_t steps = random.bits() % 3 + 1; steps > 0; --steps) {
          insert_some(work, random, 4);
          work.update(report, {});
        }
        work.remove_sites(before.partition().cell_count());
        const std::size_t repaired = report.repair_sites;
        work.update(report, {});
        ASSERT_EQ(report.repair_sites, repaired);
        ASSERT_EQ(work.partition().site, before.partition().site);
        ASSERT_EQ(work.partition().cell_of, before.partition().cell_of);
        ASSERT_EQ(work.placement().anchor, before.placement().anchor);
        ASSERT_EQ(set_of(work.triangles()), set_of(before.triangles()));
        MeasuredCovering anew(work);
        anew.update_all(report, {});
        expect_same(work, anew);
        for (CellId c = 0;
             set_bounds[0].quantity == Quantity::max_distance && c < work.errors().size(); ++c) {
          ASSERT_EQ(work.errors()[c].excess > 1, before.errors()[c].excess > 1) << c;
        }
        ASSERT_EQ(work.covering().distance(), before.covering().distance());
        ASSERT_EQ(work.covering().inserted_in(), before.covering().inserted_in());
        ASSERT_TRUE(work.covering().is_lipschitz());
        for (CVertexId v = 0; v < work.covering().distance().size(); ++v)
          ASSERT_TRUE(work.covering().is_covered(v));
        insert_some(work, random, 3);
        work.update(report, {});
        MeasuredCovering fresh(work);
        fresh.update_all(report, {});
        expect_same(work, fresh);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(MeasuredCovering, CopiesAreIndependent) {
  Random random(8);
  for (const SurfaceComplex& surface : surfaces()) {
    const SurfaceData surface_data(surface);
    MeasuredCovering work(surface_data, disks(6), {}, {}, {});
    CertificateReport report;
    const auto set_bounds = bound_sets()[0];
    work.set_bounds(set_bounds, Placement::surface);
    work.update(report, {});
    const MeasuredCovering kept(work), twin(work);
    insert_some(work, random, 10);
    work.update(report, {});
    ASSERT_GT(work.partition().cell_count(), kept.partition().cell_count());
    expect_same(kept, twin);
    MeasuredCovering one(kept), other(kept);  // the same steps lead to the same state
    Random first(81), second(81);
    insert_some(one, first, 10);
    insert_some(other, second, 10);
    one.update(report, {});
    other.update(report, {});
    expect_same(one, other);
    if (HasFatalFailure()) return;
  }
}

TEST(CertifiedDual, UpdatesEqualACompleteCheck) {
  Random random(9);
  for (const SurfaceComplex& surface : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    Covering covering(graph, disks(6));
    covering.cover({});
    covering.ignore_events();
    CertifiedDual dual(surface, covering);
    CertificateReport report;
    dual.update(report, {});
    for (int round = 0; round < 12; ++round) {
      for (int k = 0; k < 5; ++k) {
        const auto v = static_cast<CVertexId>(random.bits() % graph.c_vertex_count());
        if (covering.distance()[v] == 0) continue;
        covering.lower_radius(v, covering.distance()[v]);
        covering.insert(v);
      }
      covering.cover({});
      dual.update(report, {});
      ASSERT_TRUE(report.passed);
      const Partition& p = covering.partition();
      const PartitionCheck full = check_partition(surface, p.cell_of, p.cell_count(), p.site);
      ASSERT_TRUE(full.passed());
      ASSERT_EQ(set_of(dual.triangles()), set_of(full.triangles));
    }
    const std::uint32_t before = covering.site_count();
    dual.certify(report, {});
    EXPECT_EQ(covering.site_count(), before) << "the full check has nothing to repair";
    EXPECT_EQ(report.cells_checked, before);
  }
}

void expect_full_check(const SurfaceComplex& complex, const Covering& covering,
                       const CertifiedDual& dual) {
  const Partition& p = covering.partition();
  const PartitionCheck full = check_partition(complex, p.cell_of, p.cell_count(), p.site);
  ASSERT_TRUE(full.passed());
  ASSERT_EQ(set_of(dual.triangles()), set_of(full.triangles));
}

// Moves sites to other c-vertices of their cells, one in `share`. @return how many
std::size_t move_some(std::vector<CVertexId>& sites, const std::vector<CellId>& cell_of,
                      const std::vector<std::uint8_t>& on_boundary, unsigned share,
                      Random& random) {
  std::size_t moved = 0;
  for (CVertexId v = 0; v < cell_of.size(); ++v) {
    CVertexId& site = sites[cell_of[v]];
    if (site == v || random.bits() % share != 0 || on_boundary[v] != on_boundary[site]) continue;
    site = v;
    ++moved;
  }
  return moved;
}

// The same where sites move, which changes the diagonals of quads with four cells.
TEST(CertifiedDual, AdaptsToMovedSites) {
  Random random(12);
  std::size_t moved = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const SurfaceComplex surface = surface_of(random_samples(
        seed % 2 == 0 ? Family::smooth_blobs : Family::gyroid_cut, {13, 14, 12}, seed));
    const CVertexGraph graph = make_graph(surface);
    Covering covering(graph, disks(1.8f));
    covering.cover({});
    covering.ignore_events();
    CertifiedDual dual(surface, covering);
    CertificateReport report;
    dual.update(report, {});
    for (int round = 0; round < 10; ++round) {
      std::vector<CVertexId> sites = covering.partition().site;
      moved += move_some(sites, covering.partition().cell_of, graph.on_boundary, 40, random);
      const std::vector<std::uint8_t> changed(graph.c_vertex_count(), 0);
      covering.adapt_to(changed, sites);
      dual.adapt_to(changed);
      covering.cover({});
      dual.update(report, {});
      expect_full_check(surface, covering, dual);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(moved, 500U);
}

// The same where the complex is subdivided.
TEST(CertifiedDual, AdaptsToASubdividedComplex) {
  Random random(11);
  std::size_t moved = 0, finer = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    const SurfaceComplex surface = surface_of(random_samples(
        seed % 2 == 0 ? Family::gyroid_cut : Family::white_noise, {14, 13, 15}, seed));
    Coarsened coarser = coarsen(surface, 2, {});
    CVertexGraph graph = make_graph(coarser.complex);
    Covering covering(graph, disks(seed % 4 < 2 ? 2 : 5));
    covering.cover({});
    covering.ignore_events();
    CertifiedDual dual(coarser.complex, covering);
    CertificateReport report;
    dual.update(report, {});
    for (int round = 0; round < 5; ++round) {
      const std::vector<std::uint8_t> was_on_boundary = graph.on_boundary;
      std::vector<CVertexId> to_split;
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
        if (random.bits() % (round % 2 ? 40 : 400) == 0) to_split.push_back(v);
      }
      std::vector<CVertexId> sites = covering.partition().site;
      moved += move_some(sites, covering.partition().cell_of, was_on_boundary, 30, random);
      split_regions(surface, to_split, {}, coarser);
      const std::vector<std::uint8_t> changed = rebuild_graph(graph, coarser.complex);
      finer += changed.size() - was_on_boundary.size();
      covering.adapt_to(changed, sites);
      dual.adapt_to(changed);
      covering.cover({});
      dual.update(report, {});
      expect_full_check(coarser.complex, covering, dual);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(moved, 100U);
  EXPECT_GT(finer, 100U);
}

TEST(Covering, SeedEqualsInsertingOneByOne) {
  Random random(10);
  for (const SurfaceComplex& surface : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    std::vector<CVertexId> sites;
    Covering one_by_one(graph, disks(100)), seeded(graph, disks(100));
    while (sites.size() < 20) {
      const auto v = static_cast<CVertexId>(random.bits() % graph.c_vertex_count());
      if (std::find(sites.begin(), sites.end(), v) != sites.end()) continue;
      sites.push_back(v);
      one_by_one.insert(v);
    }
    std::vector<Covering::Radius> radii;
    for (int k = 0; k < 30; ++k) {
      radii.push_back({static_cast<CVertexId>(random.bits() % graph.c_vertex_count()),
                       static_cast<float>(1 + 9 * random.unit())});
      one_by_one.lower_radius(radii.back().at, radii.back().radius);
    }
    seeded.seed(sites, radii);
    EXPECT_EQ(seeded.partition().site, one_by_one.partition().site);
    EXPECT_EQ(seeded.partition().cell_of, one_by_one.partition().cell_of);
    EXPECT_EQ(seeded.distance(), one_by_one.distance());
    // An uncovered c-vertex gets a larger radius, and the radii around it grow as far as the
    // Lipschitz condition requires.
    std::vector<float> wanted = one_by_one.radius();
    for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
      if (seeded.partition().cell_of[v] == kNone || one_by_one.is_covered(v))
        continue;  // or it is in a component without a site
      wanted[v] = one_by_one.distance()[v] * (1.001f / (graph.on_boundary[v] ? 0.55f : 1.0f));
    }
    for (bool any = true; any;) {
      any = false;
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
        for (const CVertexGraph::Neighbour& n : graph.row(v)) {
          const float r = wanted[n.id] - n.weight * (1.0f / 3.0f);
          if (r <= wanted[v]) continue;
          wanted[v] = r;
          any = true;
        }
      }
    }
    for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
      ASSERT_NEAR(
          seeded.radius()[v], wanted[v],
          1e-5 * wanted[v]);  // up to rounding: sums along paths are computed in another order
      ASSERT_TRUE(seeded.partition().cell_of[v] == kNone || seeded.is_covered(v));
    }
    EXPECT_EQ(seeded.inserted_in(), std::vector<CellId>(20, kNone));
  }
}

TEST(Covering, RecordsTheCellASiteWasInsertedIn) {
  const SurfaceComplex grid = flat_grid(9, 3);
  const CVertexGraph graph = make_graph(grid);
  Covering covering(graph, disks(100));
  covering.insert(0 + 9);
  covering.insert(8 + 9);
  covering.insert(6 + 9);  // nearer to the second
  covering.insert(1 + 9);
  covering.insert(7 +
                  9);  // half-way between the second and the third site: belongs to the earlier one
  EXPECT_EQ(covering.inserted_in(), (std::vector<CellId>{kNone, 0, 1, 0, 1}));
}

}  // namespace
}  // namespace isoatlas::detail
