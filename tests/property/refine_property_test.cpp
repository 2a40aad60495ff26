// SPDX-License-Identifier: Apache-2.0
// Invariants of the levels of any volume, for any options.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "core/vector_math.h"
#include "geometry/triangle_bvh.h"
#include "isosurface/parse_surface.h"
#include "property/random_goals.h"
#include "support/mesh_counts.h"
#include "support/soundness.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

[[maybe_unused]] const bool kCases = run_cases(12);

bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

void log_goals(const ExtractOptions& o) {
  RC_LOG() << (o.surface.topology == Topology::faces ? "faces, " : "trilinear, ")
           << (o.placement == Placement::surface ? "surface" : "balanced")
           << (o.covering.max_radius ? ", large disks" : "") << "; coarse " << text(o.coarse);
  for (const LevelGoal& goal : o.refine) RC_LOG() << "; " << text(goal);
}

// A small volume that has a surface, and the options for its levels.
struct LevelsCase {
  explicit LevelsCase(const RandomCase& any)
      : c(smaller(any)),
        samples(c.samples()),
        volume(c.volume(SampleType::int16)),
        options(with_random_goals(c)) {
    RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
    log_goals(options);
  }
  RandomCase c;
  Samples samples;
  Volume volume;
  ExtractOptions options = coarse_options();
};

SurfaceComplex parsed(const RandomCase& c, const Volume& volume, const ExtractOptions& options) {
  ParseOptions parse;
  parse.rule = {c.isovalue(), c.inside()};
  parse.topology = options.surface.topology;
  return parse_surface(volume, parse);
}

std::vector<Vec3> grid_edge_crossings(const Samples& s, double isovalue, Inside inside) {
  std::vector<Vec3> out;
  const auto value = [&](const Size& p) {
    const double v = static_cast<double>(s.at(p[0], p[1], p[2])) - isovalue;
    return inside == Inside::above ? v : -v;
  };
  for (Size p{}; p[2] < s.size[2]; ++p[2]) {
    for (p[1] = 0; p[1] < s.size[1]; ++p[1]) {
      for (p[0] = 0; p[0] < s.size[0]; ++p[0]) {
        for (std::size_t a = 0; a < 3; ++a) {
          Size q = p;
          if (++q[a] == s.size[a]) continue;
          const double f = value(p), g = value(q);
          if ((f >= 0) == (g >= 0)) continue;
          std::array<double, 3> at{static_cast<double>(p[0]), static_cast<double>(p[1]),
                                   static_cast<double>(p[2])};
          at[a] += f / (f - g);
          out.push_back({at[0], at[1], at[2]});
        }
      }
    }
  }
  return out;
}

RC_GTEST_PROP(AnyLevels, AreNestedManifoldsWithTheReferenceTopology, (const RandomCase& any)) {
  const auto [c, samples, volume, options] = LevelsCase(any);
  const Extraction e = extract(volume, options);
  const Hierarchy& h = e.hierarchy;
  RC_CLASSIFY(e.report.tunnels > 0);
  const TopologySummary want = options.surface.topology == Topology::faces
                                   ? reference_topology(samples, c.isovalue(), c.inside())
                                   : count_manifold(parsed(c, volume, options)).topology;

  RC_ASSERT(h.levels.size() == options.refine.size() + 1);
  RC_ASSERT(e.report.levels.size() == h.levels.size());
  RC_ASSERT(h.levels.back().vertex_count == h.positions.size());
  RC_ASSERT(h.parent.size() == h.positions.size());
  std::uint32_t before = 0;
  RC_ASSERT(what_is_wrong(e, options) == "");
  for (std::size_t l = 0; l < h.levels.size(); ++l) {
    const Hierarchy::Level& level = h.levels[l];
    const LevelReport& report = e.report.levels[l];
    RC_ASSERT(level.vertex_count >= before);
    for (std::uint32_t v = before; v < level.vertex_count; ++v) {
      RC_ASSERT(h.level_of(v) == l);
      RC_ASSERT((l == 0 ? h.parent[v] == v : h.parent[v] < before));
    }
    before = level.vertex_count;
    for (const Triangle& t : level.triangles)
      RC_ASSERT(std::max({t[0], t[1], t[2]}) < level.vertex_count);
    RC_ASSERT(level.own_positions.size() ==
              (options.placement == Placement::balanced && l > 0 ? level.vertex_count : 0u));

    const TriangleMesh mesh = h.mesh(l);
    const MeshCounts counts = count_mesh(mesh);
    RC_ASSERT(counts.fault == "");
    RC_ASSERT(counts.topology == want);
    RC_ASSERT(report.topology == want);
    RC_ASSERT(report.vertices == level.vertex_count);
    RC_ASSERT(report.triangles == level.triangles.size());
    RC_ASSERT(report.certificate.passed);
    RC_ASSERT(report.certificate.cells_checked == level.vertex_count);

    // The reported shape is that of the returned mesh.
    const MeshQuality quality = mesh_quality(mesh);
    RC_ASSERT(quality.edge_min == report.quality.edge_min);
    RC_ASSERT(quality.edge_max == report.quality.edge_max);
    RC_ASSERT(quality.aspect_min == report.quality.aspect_min);
    for (const Vec3& p : mesh.positions)
      RC_ASSERT(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
  std::set<std::array<double, 3>> distinct_positions;
  for (const Vec3& p : h.positions) RC_ASSERT(distinct_positions.insert({p.x, p.y, p.z}).second);
}

double reached(Quantity quantity, const LevelReport& report, const MeshQuality& quality) {
  switch (quantity) {
    case Quantity::max_vertices:
    case Quantity::min_vertices:
      return static_cast<double>(report.vertices);
    case Quantity::min_edge:
      return quality.edge_min;
    case Quantity::max_edge:
      return quality.edge_max;
    case Quantity::min_aspect:
      return quality.aspect_min;
    default:
      return (*report.metrics)[static_cast<std::size_t>(quantity)].maximum;
  }
}

RC_GTEST_PROP(AnyLevels, ConstraintsAreSatisfiedOrTheirViolationIsReported,
              (const RandomCase& any)) {
  const auto [c, samples, volume, options] = LevelsCase(any);
  const Extraction e = extract(volume, options);
  for (std::size_t l = 0; l < e.report.levels.size(); ++l) {
    const LevelReport& report = e.report.levels[l];
    const LevelGoal& goal = l == 0 ? options.coarse : options.refine[l - 1];
    RC_ASSERT(report.metrics.has_value());
    for (std::size_t m = 0; m < kMetricCount; ++m) {
      const MetricSummary& metric = (*report.metrics)[m];
      RC_ASSERT(!std::isnan(metric.mean) &&
                metric.mean >= (unit(static_cast<Quantity>(m)) == Unit::ratio ? 1 - 1e-9 : 0));
      RC_ASSERT(metric.mean <= metric.maximum * (1 + 1e-9));
    }
    RC_ASSERT(report.constraints.size() == goal.size());
    RC_ASSERT(report.all_satisfied() == std::all_of(report.constraints.begin(),
                                                    report.constraints.end(),
                                                    [](const auto& r) { return r.satisfied; }));
    const MeshQuality quality = mesh_quality(e.hierarchy.mesh(l));
    for (std::size_t i = 0; i < goal.size(); ++i) {
      const ConstraintResult& result = report.constraints[i];
      RC_LOG() << " level " << l << ": " << name(goal[i].quantity) << " " << result.reached << " "
               << result.reason << ";";
      RC_ASSERT(result.constraint == goal[i]);
      const double have = reached(goal[i].quantity, report, quality);
      // Shape is evaluated before positions are rounded to multiples of 2^-32 of a grid step, which
      // affects short edges.
      const Vec3 spacing = volume.view.grid.spacing;
      const double rounding =
          std::ldexp(std::max({spacing.x, spacing.y, spacing.z}), -31) + 4 * c.rounding();
      const double of_ratio = goal[i].quantity == Quantity::min_aspect && quality.edge_min > 0
                                  ? 4 * rounding / quality.edge_min
                                  : 0;
      RC_ASSERT(have == result.reached ||
                std::abs(have - result.reached) <= 1e-9 * (1 + have) + of_ratio + 4 * c.rounding());
      // The comparison is made in voxels, so it is exact only up to rounding.
      const double slack = 1e-12 * goal[i].bound;
      const bool above = result.reached >= goal[i].bound - (result.satisfied ? slack : -slack);
      const bool below = result.reached <= goal[i].bound + (result.satisfied ? slack : -slack);
      RC_ASSERT(result.satisfied == (is_lower_bound(goal[i].quantity) ? above : below));
      RC_ASSERT(result.reason.empty() == result.satisfied);
      RC_ASSERT(result.reason.find('\n') == std::string::npos);
      RC_ASSERT(!result.reason.starts_with("0 "));
    }
    for (std::size_t i = 1; i < report.at_limit.size(); ++i)
      RC_ASSERT(report.at_limit[i - 1].excess >= report.at_limit[i].excess);
    for (const CellAtLimit& cell : report.at_limit) RC_ASSERT(cell.excess > 1);
    if (l == 0 || goal.empty()) continue;

    // The first constraint is satisfied whatever the others are.
    const ConstraintResult& first = report.constraints.front();
    if (first.constraint.quantity == Quantity::max_vertices &&
        e.report.levels[l - 1].vertices <= first.constraint.bound &&
        report.sites_for_intersections == 0)
      RC_ASSERT(first.satisfied);
    if (is_metric(first.constraint.quantity) && !first.satisfied && goal.size() == 1)
      RC_ASSERT(!report.at_limit.empty());
  }
}

// No point of the surface that is known exactly (c-vertices, and where the surface intersects grid
// edges) is farther from the mesh than reported. This test searches all triangles, the product only
// those around each cell.
RC_GTEST_PROP(AnyLevels, AreNowhereFartherThanReported, (const RandomCase& any)) {
  auto [c, samples, volume, options] = LevelsCase(any);
  options.space = Space::voxel;
  const Extraction e = extract(volume, options);
  std::vector<Vec3> points = grid_edge_crossings(samples, c.isovalue(), c.inside());
  const SurfaceComplex surface = parsed(c, volume, options);
  points.insert(points.end(), surface.positions.begin(), surface.positions.end());
  for (Vec3& p : points) p = to_metric(p, c.spacing);
  const double voxel = std::min({c.spacing.x, c.spacing.y, c.spacing.z});
  for (std::size_t l = 0; l < e.report.levels.size(); ++l) {
    TriangleMesh mesh = e.hierarchy.mesh(l);
    for (Vec3& p : mesh.positions) p = to_metric(p, c.spacing);
    const TriangleBvh tree(mesh.positions, mesh.triangles);
    const double reported =
        (*e.report.levels[l].metrics)[static_cast<std::size_t>(Quantity::max_distance)].maximum;
    for (const Vec3& p : points)
      RC_ASSERT(std::sqrt(tree.closest(p).squared_distance) <=
                reported * (1 + 1e-6) + 1e-5 * voxel);
  }
}

// Points spread over the isosurface, which the product has not tested, are within the proved
// distance. (For the other direction the search for closest points in noise misses some now and
// then: see TriangleProof.)
RC_GTEST_PROP(AnyLevels, AreAsNearAsProved, (const RandomCase& any)) {
  auto [c, samples, volume, options] = LevelsCase(any);
  for (LevelGoal& goal : options.refine)
    goal = Constraint{Quantity::max_distance, 0.6 * volume.view.grid.smallest_spacing()};
  const Extraction e = extract(volume, options);
  MeasureOptions measuring;
  measuring.surface.isovalue = options.surface.isovalue;
  measuring.surface.inside = options.surface.inside;
  measuring.surface.non_finite = options.surface.non_finite;
  measuring.surface.topology = options.surface.topology;
  measuring.surface.interpolation = options.surface.interpolation;
  measuring.space = options.space;
  measuring.samples = 4000;
  std::size_t proved = 0;
  for (std::size_t l = 1; l < e.report.levels.size(); ++l) {
    const LevelReport& level = e.report.levels[l];
    if (!level.distance_at_most) continue;
    ++proved;
    RC_ASSERT((*level.metrics)[static_cast<std::size_t>(Quantity::max_distance)].maximum <=
              *level.distance_at_most * (1 + 1e-6));
    const double rounding = 1e-6 * volume.view.grid.smallest_spacing() + 4 * c.rounding();
    RC_ASSERT(measure(e.hierarchy.mesh(l), volume, measuring).surface_to_mesh.maximum <=
              *level.distance_at_most + rounding);
  }
  RC_CLASSIFY(proved > 0, "proved");
}

RC_GTEST_PROP(AnyLevels, AreTheSameBytesForAnyNumberOfThreads, (const RandomCase& any)) {
  const auto [c, samples, volume, options] = LevelsCase(any);
  RunControl one, two;
  one.threads = 1;
  two.threads = 2;
  const Extraction a = extract(volume, options, one), b = extract(volume, options, two);
  RC_ASSERT(same_bytes(a.hierarchy.positions, b.hierarchy.positions));
  RC_ASSERT(a.hierarchy.parent == b.hierarchy.parent);
  for (std::size_t l = 0; l < a.hierarchy.levels.size(); ++l) {
    RC_ASSERT(a.hierarchy.levels[l].vertex_count == b.hierarchy.levels[l].vertex_count);
    RC_ASSERT(a.hierarchy.levels[l].triangles == b.hierarchy.levels[l].triangles);
    RC_ASSERT(same_bytes(a.hierarchy.levels[l].own_positions, b.hierarchy.levels[l].own_positions));
    for (std::size_t m = 0; m < kMetricCount; ++m) {
      RC_ASSERT((*a.report.levels[l].metrics)[m].maximum ==
                (*b.report.levels[l].metrics)[m].maximum);
      RC_ASSERT((*a.report.levels[l].metrics)[m].mean == (*b.report.levels[l].metrics)[m].mean);
    }
  }
}

// A later level does not change an earlier one.
RC_GTEST_PROP(AnyLevels, StayTheSameWhenMoreFollow, (const RandomCase& any)) {
  auto [c, samples, volume, options] = LevelsCase(any);
  const Extraction all = extract(volume, options);
  options.refine.resize(1);
  const Extraction first = extract(volume, options);
  for (std::size_t l = 0; l < 2; ++l) {
    RC_ASSERT(all.hierarchy.levels[l].triangles == first.hierarchy.levels[l].triangles);
    RC_ASSERT(same_bytes(all.hierarchy.mesh(l).positions, first.hierarchy.mesh(l).positions));
  }
}

}  // namespace
}  // namespace isoatlas::detail
