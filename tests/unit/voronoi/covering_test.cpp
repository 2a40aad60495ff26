// SPDX-License-Identifier: Apache-2.0
// The invariants of the covering, each checked independently: distances, radii, coverage, and their
// consequences.
#include "voronoi/covering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "complex/coarsen.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"
#include "voronoi/component_graphs.h"

namespace isoatlas::detail {
namespace {

using namespace test;

CoveringOptions options(float max_radius) {
  CoveringOptions out;
  out.max_radius = max_radius;
  out.event_persistence = 1.5f;
  out.first_stage = 4;
  return out;
}

std::vector<std::pair<std::string, SurfaceComplex>> surfaces() {
  std::vector<std::pair<std::string, SurfaceComplex>> out{{"grid", flat_grid(17, 13)},
                                                          {"tube", tube(11, 20)}};
  for (const KnownVolume& known : known_volumes()) {
    if (known.samples.values.size() < 16000)
      out.emplace_back(known.name, surface_of(known.samples, known.isovalue));
  }
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {8, 7, 9}, seed);
    if (has_surface(s, 0))
      out.emplace_back(name(family),
                       surface_of(s, 0, Inside::above, seed % 2 ? Vec3{1, 1, 1} : Vec3{1, 2, 0.5}));
  }
  return out;
}

enum class Boundary { owned_from_boundary, owned_from_anywhere };

void expect_promises(const CVertexGraph& graph, const Covering& covering, const std::string& what,
                     Boundary boundary = Boundary::owned_from_boundary) {
  const Partition& p = covering.partition();
  const std::vector<double> distance = slow_distances(graph, p.site);
  std::set<CVertexId> sites(p.site.begin(), p.site.end());
  ASSERT_EQ(sites.size(), p.site.size()) << what << ": a site twice";
  ASSERT_EQ(covering.site_count(), p.site.size());
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    ASSERT_NEAR(covering.distance()[v], distance[v], 1e-4 * (1 + distance[v]))
        << what << ": distance of " << v;
    ASSERT_TRUE(covering.is_covered(v)) << what << ": " << v;
    ASSERT_GT(covering.radius()[v], 0) << what;
    ASSERT_LT(p.cell_of[v], p.cell_count()) << what;
    for (const auto& n : graph.row(v)) {  // 1/3-Lipschitz along every edge
      ASSERT_LE(covering.radius()[v], covering.radius()[n.id] + n.weight / 3 * 1.0001f) << what;
    }
  }
  for (CellId c = 0; c < p.cell_count(); ++c) {
    ASSERT_EQ(p.cell_of[p.site[c]], c) << what << ": a site owns itself";
    ASSERT_EQ(covering.distance()[p.site[c]], 0) << what;
  }
  // Cells are connected in the graph, and every c-vertex is as far from its own site as from the
  // nearest one.
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    if (covering.distance()[v] == 0) continue;
    bool has_parent = false;
    for (const auto& n : graph.row(v)) {
      has_parent |= p.cell_of[n.id] == p.cell_of[v] &&
                    covering.distance()[n.id] + n.weight == covering.distance()[v];
    }
    ASSERT_TRUE(has_parent) << what << ": a c-vertex whose way to its site leaves the cell";
  }
  // Boundary c-vertices belong to boundary sites. Where c-vertices were added, the certificate
  // checks what matters of this.
  if (boundary == Boundary::owned_from_anywhere) return;
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    ASSERT_TRUE(!graph.on_boundary[v] || graph.on_boundary[p.site[p.cell_of[v]]])
        << what << ": boundary owned from inside";
  }
}

TEST(Covering, ParallelComponentsEqualSequentialOnes) {
  for (std::uint64_t seed = 0; seed < kFamilies; ++seed) {
    const Samples s = random_samples(static_cast<Family>(seed), {30, 34, 32}, seed);
    if (!has_surface(s, 0)) continue;
    const CVertexGraph graph = make_graph(surface_of(s, 0));
    const std::string what = name(static_cast<Family>(seed));
    Covering apart(graph, options(6));
    apart.ignore_events();
    apart.cover({});
    Covering in_turn(
        graph, options(6));  // with a site already, components are covered one after the other
    in_turn.ignore_events();
    const auto on_boundary = std::ranges::find(graph.on_boundary, std::uint8_t{1});
    in_turn.insert(on_boundary == graph.on_boundary.end()
                       ? 0
                       : static_cast<CVertexId>(on_boundary - graph.on_boundary.begin()));
    in_turn.cover({});
    EXPECT_EQ(apart.partition().site, in_turn.partition().site) << what;
    EXPECT_EQ(apart.partition().cell_of, in_turn.partition().cell_of) << what;
    EXPECT_EQ(apart.distance(), in_turn.distance()) << what;
    EXPECT_EQ(apart.radius(), in_turn.radius()) << what;
    EXPECT_EQ(apart.inserted_in(), in_turn.inserted_in()) << what;
  }
}

TEST(ComponentGraphs, PartitionTheWholeGraph) {
  const CVertexGraph graph = make_graph(surface_of(random_samples(Family{}, {30, 34, 32}, 1), 0));
  const ComponentGraphs groups(graph);
  EXPECT_GT(groups.count(), 1u);
  std::vector<int> times(graph.c_vertex_count(), 0);
  for (std::uint32_t group = 0; group < groups.count(); ++group) {
    const auto own = groups.c_vertices(group);
    EXPECT_TRUE(std::ranges::is_sorted(own));
    const CVertexGraph part = groups.subgraph(group);
    ASSERT_EQ(part.c_vertex_count(), own.size());
    for (std::size_t k = 0; k < own.size(); ++k) {
      ++times[own[k]];
      EXPECT_EQ(part.on_boundary[k], graph.on_boundary[own[k]]);
      const auto row = part.row(static_cast<CVertexId>(k)), whole = graph.row(own[k]);
      ASSERT_EQ(row.size(), whole.size());
      for (std::size_t i = 0; i < row.size(); ++i) {
        EXPECT_EQ(own[row[i].id], whole[i].id);
        EXPECT_EQ(row[i].weight, whole[i].weight);
        EXPECT_EQ(part.is_diagonal[part.first[k] + i], graph.is_diagonal[graph.first[own[k]] + i]);
      }
    }
  }
  EXPECT_TRUE(std::ranges::all_of(times, [](int n) { return n == 1; }));
}

TEST(Covering, SatisfiesItsInvariants) {
  for (const auto& [what, surface] : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    for (const float radius : {2.5f, 6.0f, 30.0f}) {
      Covering covering(graph, options(radius));
      covering.cover({});
      expect_promises(graph, covering, what + ", radius " + std::to_string(radius));
      if (HasFatalFailure()) return;
      for (const float r : covering.radius()) ASSERT_LE(r, radius);
    }
  }
}

// A covering of a coarser complex, transferred to the complex itself, whose distances are a little
// longer: radii are raised where necessary and stay Lipschitz.
TEST(Covering, SatisfiesItsInvariantsOnAFinerComplex) {
  std::size_t risen = 0;
  double largest_rise = 1;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Samples samples =
        seed % 2 == 0 ? sampled({24, 24, 24},
                                sphere({11.4, 11.6, 11.55}, 6 + 0.4 * static_cast<double>(seed)))
                      : random_samples(Family::gyroid_cut, {18, 17, 19}, seed);
    const SurfaceComplex surface = surface_of(samples);
    const Coarsened coarser = coarsen(surface, 3, {});
    const CVertexGraph coarse_graph = make_graph(coarser.complex), graph = make_graph(surface);
    Covering on_coarser(coarse_graph, options(8));
    on_coarser.cover({});
    std::vector<CVertexId> sites;
    for (const CVertexId v : on_coarser.partition().site)
      sites.push_back(coarser.representative[v]);
    std::vector<Covering::Radius> radii;
    for (CVertexId v = 0; v < coarse_graph.c_vertex_count(); ++v)
      radii.push_back({coarser.representative[v], on_coarser.radius()[v]});
    Covering covering(graph, options(8));
    covering.seed(sites, radii);
    expect_promises(graph, covering, "seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
    for (const Covering::Radius& r : radii) {
      risen += covering.radius()[r.at] > r.radius ? 1 : 0;
      largest_rise =
          std::max(largest_rise, static_cast<double>(covering.radius()[r.at] / r.radius));
    }
    covering.lower_radius(sites.front(), 1);
    covering.cover({});
    expect_promises(graph, covering, "covered again, seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(risen, 0U);
  std::printf("%zu radii have risen, by a factor of %.2f at most\n", risen, largest_rise);
}

// A covering whose cells were made smaller, transferred to a complex with more c-vertices in some
// places.
TEST(Covering, SatisfiesItsInvariantsOnASubdividedComplex) {
  std::size_t sites = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const SurfaceComplex surface = surface_of(random_samples(
        seed % 2 == 0 ? Family::gyroid_cut : Family::smooth_blobs, {18, 17, 19}, seed));
    Coarsened coarser = coarsen(surface, 3, {});
    CVertexGraph graph = make_graph(coarser.complex);
    Covering start(graph, options(8));
    start.cover({});
    std::vector<CellId> cells;
    for (CellId c = 0; c < start.site_count(); c += 3) cells.push_back(c);
    const std::vector<CellId> single = start.shrink(cells);
    EXPECT_TRUE(start.is_lipschitz());
    start.cover({});
    expect_promises(graph, start, "made smaller");
    if (HasFatalFailure()) return;

    const std::vector<std::uint8_t> was_on_boundary = graph.on_boundary;
    const auto c_vertices = static_cast<CVertexId>(was_on_boundary.size());
    std::vector<CVertexId> to_split;
    for (CVertexId v = 0; v < c_vertices; v += 5) to_split.push_back(v);
    split_regions(surface, to_split, {}, coarser);
    const std::vector<std::uint8_t> changed = rebuild_graph(graph, coarser.complex);
    for (const bool moves : {false, true}) {
      std::vector<CVertexId> at = start.partition().site;
      for (CVertexId v = 0; moves && v < c_vertices;
           v += 3) {  // some sites move to another c-vertex of their cell
        const CellId c = start.partition().cell_of[v];
        if (was_on_boundary[v] == was_on_boundary[at[c]]) at[c] = v;
      }
      Covering covering(start);
      covering.clear_changes();
      covering.adapt_to(changed, at);
      std::vector<CVertexId> other_cell;
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
        if (v >= c_vertices || covering.partition().cell_of[v] != start.partition().cell_of[v])
          other_cell.push_back(v);
      }
      EXPECT_EQ(std::vector<CVertexId>(covering.changed().begin(), covering.changed().end()),
                other_cell);
      expect_promises(graph, covering, "finer", Boundary::owned_from_anywhere);
      if (HasFatalFailure()) return;
      std::vector<Covering::Radius> radii;
      for (CVertexId v = 0; v < c_vertices; ++v) radii.push_back({v, start.radius()[v]});
      Covering anew(graph, options(8));
      anew.seed(at, radii);
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v)
        ASSERT_NEAR(covering.distance()[v], anew.distance()[v], 1e-4) << v;
      covering.cover({});
      EXPECT_EQ(covering.site_count(), start.site_count()) << "all is covered already";
      sites += covering.site_count();
    }
  }
  EXPECT_GT(sites, 500U);
}

// If two disks overlap, their radii differ by less than a factor of two; a later site is at least
// its own radius away from every earlier one (0.55 of it on the boundary).
TEST(Covering, NeighbouringDisksAndSpacing) {
  for (const auto& [what, surface] : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    Covering covering(graph, options(8));
    covering.cover({});
    const Partition& p = covering.partition();
    if (p.cell_count() > 150) continue;
    for (CellId a = 0; a < p.cell_count(); ++a) {
      const std::vector<double> d = slow_distances(graph, {p.site[a]});
      const double ha = covering.radius()[p.site[a]];
      for (CellId b = a + 1; b < p.cell_count(); ++b) {
        const double apart = d[p.site[b]], hb = covering.radius()[p.site[b]];
        ASSERT_GE(apart, (graph.on_boundary[p.site[b]] ? 0.55 : 1) * hb * 0.9999) << what;
        if (apart < ha + hb) {
          ASSERT_LT(ha, 2 * hb * 1.0001) << what;
          ASSERT_LT(hb, 2 * ha * 1.0001) << what;
        }
      }
    }
  }
}

// On a grid of whole numbers distances along rows are exact, so ties are exact.
TEST(Covering, TiesGoToTheEarlierSite) {
  const SurfaceComplex grid = flat_grid(9, 3);
  const CVertexGraph graph = make_graph(grid);
  for (const bool swapped : {false, true}) {
    Covering covering(graph, options(100));
    covering.insert(swapped ? 8 + 9 : 0 + 9);
    covering.insert(swapped ? 0 + 9 : 8 + 9);
    EXPECT_EQ(covering.partition().cell_of[4 + 9], 0u) << "half way";
    EXPECT_EQ(covering.partition().cell_of[swapped ? 5 + 9 : 3 + 9], 0u);
    EXPECT_EQ(covering.partition().cell_of[swapped ? 3 + 9 : 5 + 9], 1u);
    EXPECT_EQ(covering.distance()[4 + 9], 4);
  }
}

TEST(Covering, InsertNeverIncreasesDistances) {
  const SurfaceComplex surface = surface_of(random_samples(Family::gyroid_cut, {10, 10, 10}, 3));
  const CVertexGraph graph = make_graph(surface);
  Covering covering(graph, options(100));
  Random random(4);
  std::vector<CVertexId> sites;
  std::vector<float> before(graph.c_vertex_count(), std::numeric_limits<float>::infinity());
  for (int k = 0; k < 30; ++k) {
    const auto v = static_cast<CVertexId>(random.bits() % graph.c_vertex_count());
    if (covering.distance()[v] == 0) continue;
    covering.insert(v);
    sites.push_back(v);
    const std::vector<double> want = slow_distances(graph, sites);
    for (CVertexId w = 0; w < graph.c_vertex_count(); ++w) {
      ASSERT_LE(covering.distance()[w], before[w]);
      if (std::isinf(want[w])) {
        ASSERT_TRUE(std::isinf(covering.distance()[w]));
      } else {
        ASSERT_NEAR(covering.distance()[w], want[w], 1e-4 * (1 + want[w]));
      }
    }
    before = covering.distance();
    ASSERT_EQ(covering.partition().site, sites);
  }
}

TEST(Covering, RemoveSitesRestoresThePartition) {
  Random random(5);
  for (const auto& [what, surface] : surfaces()) {
    const CVertexGraph graph = make_graph(surface);
    Covering covering(graph, options(5));
    covering.cover({});
    for (int round = 0; round < 4; ++round) {
      const Covering before = covering;
      covering.clear_changes();
      for (int k = 0; k < 8; ++k) {
        const auto v = static_cast<CVertexId>(random.bits() % graph.c_vertex_count());
        covering.lower_radius(v, 0.7f * covering.radius()[v]);
        if (covering.distance()[v] > 0 && random.bits() % 2) covering.insert(v);
      }
      covering.cover({});
      const Partition finer = covering.partition();
      covering.remove_sites(before.site_count());
      ASSERT_EQ(covering.partition().site, before.partition().site) << what;
      ASSERT_EQ(covering.partition().cell_of, before.partition().cell_of) << what;
      ASSERT_EQ(covering.distance(), before.distance()) << what;
      ASSERT_EQ(covering.inserted_in(), before.inserted_in()) << what;
      expect_promises(graph, covering, what, Boundary::owned_from_anywhere);
      const std::set<CVertexId> changed(covering.changed().begin(), covering.changed().end());
      for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
        ASSERT_TRUE(finer.cell_of[v] == before.partition().cell_of[v] || changed.contains(v))
            << what << ": " << v << " has changed its cell";
        // Larger by a thousandth of the largest radius, so that rounding leaves nothing uncovered.
        ASSERT_LE(covering.radius()[v], before.radius()[v] + 0.01f)
            << what << ": radii rise only as far as something was uncovered";
      }
      const CellMembers& members = covering.members();
      ASSERT_EQ(members.cell_count(), covering.site_count());
      for (CellId c = 0; c < members.cell_count(); ++c)
        members.for_each(c, [&](CVertexId v) { EXPECT_EQ(covering.partition().cell_of[v], c); });
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Covering, LowerRadiusPropagates) {
  const SurfaceComplex surface = surface_of(sampled({20, 20, 20}, sphere({9.4, 9.6, 9.55}, 7)));
  const CVertexGraph graph = make_graph(surface);
  Covering covering(graph, options(6));
  const CVertexId centre = 100;
  covering.lower_radius(centre, 1.5f);
  covering.lower_radius(centre, 3.0f);  // not lower: no effect
  const std::vector<double> d = slow_distances(graph, {centre});
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v)
    ASSERT_NEAR(covering.radius()[v], std::min(6.0, 1.5 + d[v] / 3), 1e-4);
}

TEST(Covering, LowerRadiiEqualsLowerRadiusOfEach) {
  const SurfaceComplex surface = surface_of(sampled({20, 20, 20}, gyroid(11.3, 0.1)));
  const CVertexGraph graph = make_graph(surface);
  Covering one_by_one(graph, options(6)), at_once(graph, options(6));
  Random random(5);
  std::vector<Covering::Radius> radii;
  for (int k = 0; k < 60; ++k)
    radii.push_back({static_cast<CVertexId>(random.bits() % graph.c_vertex_count()),
                     0.5f + 0.01f * static_cast<float>(random.bits() % 700)});
  for (const Covering::Radius& r : radii) one_by_one.lower_radius(r.at, r.radius);
  at_once.lower_radii(radii);
  EXPECT_EQ(at_once.radius(), one_by_one.radius());
  EXPECT_TRUE(at_once.is_lipschitz());
  one_by_one.cover({});
  at_once.cover({});
  EXPECT_EQ(at_once.partition().site, one_by_one.partition().site);
}

TEST(Covering, OneSiteForATinyClosedComponent) {
  const SurfaceComplex t = tetrahedron();
  const CVertexGraph graph = make_graph(t);
  Covering covering(graph, options(100));
  covering.cover({});
  EXPECT_GE(covering.site_count(), 1u);
  expect_promises(graph, covering, "tetrahedron");
}

TEST(Covering, SmallerRadiusMeansMoreSites) {
  const SurfaceComplex surface = surface_of(sampled({40, 40, 40}, sphere({19.4, 19.6, 19.55}, 16)));
  const CVertexGraph graph = make_graph(surface);
  std::uint32_t before = 0;
  for (const float radius : {40.0f, 12.0f, 6.0f, 3.0f}) {
    Covering covering(graph, options(radius));
    covering.cover({});
    EXPECT_GT(covering.site_count(), before);
    before = covering.site_count();
  }
}

TEST(Covering, Cancelled) {
  const SurfaceComplex grid = flat_grid(30, 30);
  const CVertexGraph graph = make_graph(grid);
  Covering covering(graph, options(2));
  const std::atomic<bool> cancel{true};
  RunControl control;
  control.cancel = &cancel;
  EXPECT_THROW(covering.cover(control), Error);
}

}  // namespace
}  // namespace isoatlas::detail
