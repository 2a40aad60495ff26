// SPDX-License-Identifier: Apache-2.0
#include "embedding/resolve_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>

#include "complex/components.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "error/level_mesh.h"
#include "isoatlas/error.h"
#include "isosurface/parse_surface.h"
#include "isosurface/surface_nesting.h"
#include "support/levels.h"
#include "support/mesh_reference.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

using Ids = std::vector<std::uint32_t>;

struct Parsed {
  explicit Parsed(const Samples& samples) : volume(to_volume(samples)), surface(make(volume)) {}

  Volume volume;
  AdaptiveSurface surface;

 private:
  static AdaptiveSurface make(const Volume& volume) {
    ParseOptions options;
    options.rule = {0, Inside::above, NonFinite::refuse};
    std::vector<VerticalNode> nodes;
    SurfaceComplex complex = parse_surface(volume, options, {}, &nodes);
    const Components components = find_components(complex);
    const Nesting nesting = surface_nesting(components, nodes);
    return {std::move(complex), components, nesting, InterpolatedField(volume.view, options.rule)};
  }
};

// The dual of a covering of the surface itself. Counts the calls.
class SurfaceDual : public GrowingDual {
 public:
  SurfaceDual(AdaptiveSurface& surface, float max_radius)
      : surface_(surface),
        graph_(make_graph(surface.complex())),
        covering_(graph_, disks(max_radius)),
        dual_(surface.complex(), covering_) {
    covering_.cover({});
    covering_.ignore_events();
    dual_.update(report_, {});
  }

  Covering& covering() override { return covering_; }
  const SurfaceComplex& complex() const override { return surface_.complex(); }
  void update() override {
    ++updates;
    dual_.update(report_, {});
  }
  std::vector<Vec3> positions() const override {
    std::vector<Vec3> out;
    for (const CVertexId v : covering_.partition().site)
      out.push_back(surface_.complex().positions[v]);
    return out;
  }
  std::vector<Triangle> triangles() const override { return to_triangles(dual_.triangles()); }
  std::vector<CVertexId> sites_on_surface() const override { return covering_.partition().site; }
  bool repair_first() override { return updates <= repairs; }
  bool subdivide(std::span<const CellId> single) override {
    ++subdivisions;
    Ids sites;
    for (const CellId c : single) {
      EXPECT_EQ(covering_.farthest_distances()[c], 0) << "a single c-vertex";
      sites.push_back(covering_.partition().site[c]);
    }
    const Ids wanted = filter_subdividable(surface_, sites);
    if (wanted.empty()) return false;
    const std::vector<Vec3> before = surface_.complex().positions;
    surface_.subdivide(wanted);
    std::vector<std::uint8_t> changed = rebuild_graph(graph_, surface_.complex());
    for (CVertexId v = 0; v < before.size(); ++v)
      changed[v] |= !(before[v] == surface_.complex().positions[v]);
    covering_.adapt_to(changed, Ids(covering_.partition().site));
    covering_.ignore_events();
    dual_.adapt_to(changed);
    return true;
  }

  TriangleMesh mesh() const { return {positions(), triangles()}; }

  int updates = 0, subdivisions = 0, repairs = 0;

 protected:
  AdaptiveSurface& surface_;
  CVertexGraph graph_;
  Covering covering_;
  CertifiedDual dual_;
  CertificateReport report_;
};

ResolvedIntersections resolve(GrowingDual& dual, const AdaptiveSurface& surface,
                              const RunControl& control = {}) {
  IntersectionTracker tracker;
  return resolve_intersections(dual, surface, tracker, control);
}

TEST(ResolveIntersections, ChangesNothingWithoutIntersections) {
  Parsed p(sampled({14, 14, 14}, sphere({6.4, 6.6, 6.55}, 5)));
  SurfaceDual dual(p.surface, 3);
  const Ids sites = dual.covering().partition().site;
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_FALSE(out.has_changed);
  EXPECT_EQ(out.sites_for_intersections, 0u);
  EXPECT_EQ(out.sites_for_nesting, 0u);
  EXPECT_EQ(dual.updates, 1);
  EXPECT_EQ(dual.subdivisions, 0);
  EXPECT_EQ(dual.covering().partition().site, sites);
}

TEST(ResolveIntersections, ReportsThatRepairsChangedSomething) {
  Parsed p(sampled({14, 14, 14}, sphere({6.4, 6.6, 6.55}, 5)));
  SurfaceDual dual(p.surface, 3);
  dual.repairs = 2;
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_TRUE(out.has_changed);
  EXPECT_EQ(dual.updates, 3) << "repairs come first, and each is followed by an update";
  EXPECT_EQ(out.sites_for_intersections + out.sites_for_nesting, 0u);
}

// The outer samples are outside, so that the surface is closed.
Samples with_outer_layer(Samples samples) {
  for (std::size_t z = 0; z < samples.size[2]; ++z) {
    for (std::size_t y = 0; y < samples.size[1]; ++y) {
      for (std::size_t x = 0; x < samples.size[0]; ++x) {
        if (x == 0 || y == 0 || z == 0 || x + 1 == samples.size[0] || y + 1 == samples.size[1] ||
            z + 1 == samples.size[2])
          samples.at(x, y, z) = -1000;
      }
    }
  }
  return samples;
}

// Meshes are checked by a slow reference.
TEST(ResolveIntersections, EmbedsTheDualOfNoise) {
  std::size_t pairs_before = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const Family family = seed % 2 == 0 ? Family::white_noise : Family::few_values;
    const Samples samples = random_samples(family, {10, 9, 10}, seed);
    Parsed p(with_outer_layer(samples));
    SurfaceDual dual(p.surface, seed % 3 == 2 ? 0.5f : 4);  // small disks: single c-vertices
    const auto kinds = kinds_of(dual.mesh());
    const EmbeddingCheck before = check_embedding(dual.mesh());
    pairs_before += before.pairs;
    const std::uint32_t start = dual.covering().site_count();
    const ResolvedIntersections out = resolve(dual, p.surface);
    const TriangleMesh mesh = dual.mesh();
    EXPECT_EQ(kinds_of(mesh), kinds);
    const EmbeddingCheck after = check_embedding(mesh);
    EXPECT_EQ(after.pairs, 0u);
    EXPECT_EQ(after.without_area, 0u);
    EXPECT_EQ(misplaced_components(mesh), 0u);
    EXPECT_EQ(out.has_changed, dual.updates > 1);
    EXPECT_LE(start + out.sites_for_intersections + out.sites_for_nesting,
              dual.covering().site_count());
  }
  EXPECT_GT(pairs_before, 50u);
}

TEST(ResolveIntersections, DoesNotDependOnTheNumberOfThreads) {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    Parsed p(random_samples(Family::white_noise, {7, 7, 7}, 3));
    SurfaceDual dual(p.surface, 4);
    const ResolvedIntersections out = resolve(dual, p.surface);
    EXPECT_GT(out.sites_for_intersections, 0u);
    if (threads == 1) {
      positions = dual.positions();
      triangles = dual.triangles();
    }
    EXPECT_EQ(dual.positions(), positions) << threads;
    EXPECT_EQ(dual.triangles(), triangles) << threads;
  }
}

TEST(ResolveIntersections, StopsWhenCancelled) {
  Parsed p(random_samples(Family::white_noise, {6, 6, 6}, 3));
  SurfaceDual dual(p.surface, 4);
  const std::atomic<bool> cancel = true;
  RunControl control;
  control.cancel = &cancel;
  EXPECT_THROW(resolve(dual, p.surface, control), Error);
}

// A mesh whose component is inverted until there are enough sites.
class MirroredDual : public SurfaceDual {
 public:
  using SurfaceDual::SurfaceDual;
  std::vector<Vec3> positions() const override {
    std::vector<Vec3> out = SurfaceDual::positions();
    for (Vec3& p : out) p.x = covering_.site_count() < needed ? -p.x : p.x;
    return out;
  }
  std::uint32_t needed = 0;
};

TEST(ResolveIntersections, AddsSitesUntilComponentsHaveTheirOrientation) {
  Parsed p(sampled({14, 14, 14}, sphere({6.4, 6.6, 6.55}, 5)));
  MirroredDual dual(p.surface, 4);
  const std::uint32_t start = dual.covering().site_count();
  dual.needed = 3 * start;
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_TRUE(out.has_changed);
  EXPECT_EQ(out.sites_for_intersections, 0u);
  EXPECT_EQ(out.sites_for_nesting, dual.covering().site_count() - start);
  EXPECT_GE(dual.covering().site_count(), dual.needed);
  EXPECT_EQ(dual.subdivisions, 0);
}

// Pairs of crossing triangles as a script requires. 16 cells in the middle of a flat grid are
// single c-vertices; the others are larger.
class ScriptedDual : public GrowingDual {
 public:
  explicit ScriptedDual(std::vector<std::size_t> larger_pairs)
      : larger_pairs_(std::move(larger_pairs)),
        grid_(flat_grid(40, 40)),
        graph_(make_graph(grid_)),
        covering_(graph_, disks(100)) {
    covering_.ignore_events();
    for (std::uint32_t y = 0; y < 40; ++y) {
      for (std::uint32_t x = 0; x < 40; ++x) {
        const bool in_block = x >= 10 && x < 16 && y >= 10 && y < 16;
        if (in_block || (x % 3 == 0 && y % 3 == 0)) covering_.insert(x + 40 * y);
      }
    }
    covering_.cover({});
  }

  Covering& covering() override { return covering_; }
  const SurfaceComplex& complex() const override { return grid_; }
  void update() override {
    sizes_ = covering_.farthest_distances();
    triangles_.clear();
    positions_.assign(sizes_.size(), {0, 0, 0});
    const auto updated = static_cast<std::size_t>(updates++);
    const std::size_t larger = updated < larger_pairs_.size() ? larger_pairs_[updated] : 0;
    Ids single, many;
    for (CellId c = 0; c < sizes_.size(); ++c) {
      if (sizes_[c] == 0) single.push_back(c);
      if (sizes_[c] > 1) many.push_back(c);
    }
    for (std::size_t k = 0; k < larger; ++k) add_pair(std::span(many).subspan(6 * k, 6));
    if (updated >= larger_pairs_.size()) return;
    add_pair(std::span(single).first(6));
    single_.assign(single.begin(), single.begin() + 6);
  }
  std::vector<Vec3> positions() const override { return positions_; }
  std::vector<Triangle> triangles() const override { return triangles_; }
  std::vector<CVertexId> sites_on_surface() const override { return Ids(positions_.size(), 0); }
  bool subdivide(std::span<const CellId> single) override {
    EXPECT_EQ(Ids(single.begin(), single.end()), single_);
    subdivided_after.push_back(updates);
    return can_subdivide;
  }

  int updates = 0;
  bool can_subdivide = true;
  std::vector<int> subdivided_after;  // the number of updates before each call of subdivide()

 private:
  void add_pair(std::span<const CellId> cells) {
    constexpr std::array<Vec3, 6> kCrossing{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -1}, {0.2, 0.3, -1}, {0.25, 0.25, 1}}};
    const Vec3 at{3.0 * static_cast<double>(triangles_.size()), 0, 0};
    for (std::size_t k = 0; k < 6; ++k) positions_[cells[k]] = at + kCrossing[k];
    triangles_.push_back({cells[0], cells[1], cells[2]});
    triangles_.push_back({cells[3], cells[4], cells[5]});
  }

  std::vector<std::size_t> larger_pairs_;
  SurfaceComplex grid_;
  CVertexGraph graph_;
  Covering covering_;
  std::vector<float> sizes_;
  Ids single_;
  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
};

// A surface with one open component, which has no orientation.
Samples half_space_samples() {
  return sampled({4, 4, 4}, [](double, double, double z) { return 1.5 - z; });
}

// Smaller cells help if at most 0.7 of the pairs are left. In the first round nothing is known.
TEST(ResolveIntersections, SubdividesOnlyIfSmallerCellsDoNotHelp) {
  const Parsed p(half_space_samples());
  ScriptedDual dual({9, 6, 4, 2});  // and one pair of single c-vertices each time
  const std::uint32_t start = dual.covering().site_count();
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_EQ(dual.updates, 5);
  EXPECT_EQ(dual.subdivided_after, (std::vector<int>{1, 3}))
      << "7 of 10 and 3 of 5 pairs have helped, 5 of 7 have not";
  EXPECT_TRUE(out.has_changed);
  EXPECT_EQ(out.sites_for_intersections, dual.covering().site_count() - start);
  EXPECT_GE(out.sites_for_intersections, 9u + 6u + 4u + 2u) << "one or more for each pair";
  EXPECT_EQ(out.sites_for_nesting, 0u);
}

// If nothing can be subdivided and no cell can become smaller, intersections remain.
TEST(ResolveIntersections, EndsIfIntersectionsCannotBeResolved) {
  const Parsed p(half_space_samples());
  ScriptedDual dual({0, 0, 0, 0});
  dual.can_subdivide = false;
  const std::uint32_t start = dual.covering().site_count();
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_EQ(dual.updates, 1);
  EXPECT_EQ(dual.subdivided_after, std::vector<int>{1});
  EXPECT_FALSE(out.has_changed);
  EXPECT_EQ(dual.covering().site_count(), start);
  ScriptedDual larger({1, 1, 0, 0});
  larger.can_subdivide = false;
  EXPECT_TRUE(resolve(larger, p.surface).has_changed);
  EXPECT_EQ(larger.updates, 3) << "as long as a cell can become smaller";
}

TEST(ResolveIntersections, ContinuesAfterASubdivisionWithoutNewSites) {
  const Parsed p(half_space_samples());
  ScriptedDual dual({0});
  const ResolvedIntersections out = resolve(dual, p.surface);
  EXPECT_EQ(dual.updates, 2);
  EXPECT_TRUE(out.has_changed);
  EXPECT_EQ(out.sites_for_intersections, 0u);
}

TEST(FilterSubdividable, KeepsThoseWithParsedFaces) {
  Samples samples = constant({4, 4, 4}, -3);
  samples.at(1, 1, 1) = samples.at(2, 2, 2) = 1;  // two balls, in one grid cell the c-vertices 7, 8
  Parsed p(samples);
  EXPECT_EQ(filter_subdividable(p.surface, {15, 7, 0, 8}), (Ids{15, 7, 0, 8}));
  EXPECT_EQ(filter_subdividable(p.surface, {}), Ids{});
  p.surface.subdivide(Ids{7});
  EXPECT_EQ(filter_subdividable(p.surface, {15, 7, 0, 8}), (Ids{15, 0}));
  p.surface.subdivide(Ids{0, 15});
  EXPECT_EQ(filter_subdividable(p.surface, {15, 7, 0, 8}), Ids{});
}

}  // namespace
}  // namespace isoatlas::detail
