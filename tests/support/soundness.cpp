// SPDX-License-Identifier: Apache-2.0
#include "support/soundness.h"

#include <algorithm>
#include <cmath>

#include "support/mesh_counts.h"
#include "support/mesh_reference.h"

namespace isoatlas::detail::test {
namespace {

constexpr std::size_t kMaxCheckedComponents =
    100;  // components: each is compared with all triangles

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::string wrong_with_level(const Extraction& e, const ExtractOptions& options, std::size_t l) {
  const Hierarchy& h = e.hierarchy;
  const Hierarchy::Level& level = h.levels[l];
  const LevelReport& report = e.report.levels[l];
  const std::uint32_t before = l == 0 ? 0 : h.levels[l - 1].vertex_count;
  if (level.vertex_count < before || level.vertex_count > h.positions.size())
    return "its vertices are not those of a hierarchy";
  if (level.own_positions.size() !=
      (options.placement == Placement::balanced && l > 0 ? level.vertex_count : 0u))
    return "own_positions has another size";
  for (std::uint32_t v = before; v < level.vertex_count; ++v) {
    if (h.level_of(v) != l) return "level_of is wrong for vertex " + std::to_string(v);
    if (l == 0 ? h.parent[v] != v : h.parent[v] >= before)
      return "the parent of vertex " + std::to_string(v) + " is not in the previous level";
  }
  const TriangleMesh mesh = h.mesh(l);
  for (const Vec3& p : mesh.positions) {
    if (!is_finite(p)) return "a position is not finite";
  }
  for (const Triangle& t : mesh.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= mesh.positions.size())
      return "a triangle has a vertex that the level has not";
  }
  const MeshCounts counts = count_mesh(mesh);
  if (!counts.fault.empty()) return counts.fault;
  if (counts.topology != report.topology) return "its topology is not that of its report";
  if (report.topology != e.report.reference)
    return "its topology is not that of the reference surface";
  if (report.vertices != level.vertex_count || report.triangles != level.triangles.size())
    return "the report miscounts";
  if (!report.certificate.passed) return "the certificate did not pass";
  const LevelGoal& goal = l == 0 ? options.coarse : options.refine[l - 1];
  if (report.constraints.size() != goal.size()) return "constraints are missing in the report";
  for (const ConstraintResult& r : report.constraints) {
    if (r.satisfied != r.reason.empty())
      return "constraint on " + std::string(name(r.constraint.quantity)) +
             ": a reason and satisfied, or neither: " + r.reason;
    if (std::isnan(r.reached))
      return "constraint on " + std::string(name(r.constraint.quantity)) + " reached no number";
  }
  if (report.metrics) {
    for (const MetricSummary& m : *report.metrics) {
      if (std::isnan(m.maximum) || std::isnan(m.mean)) return "a metric is no number";
    }
  }
  for (const double q :
       {report.quality.aspect_min, report.quality.aspect_median, report.quality.angle_min,
        report.quality.angle_max, report.quality.edge_min, report.quality.edge_max}) {
    if (std::isnan(q)) return "the quality of its triangles is no number";
  }
  if (report.self_intersections || (kEmbedded && !options.allow_self_intersections)) {
    const auto [pairs, without_area] = check_embedding(mesh);
    if (report.quality.zero_area_triangles != without_area)
      return "the report miscounts triangles without area";
    if (kEmbedded && !options.allow_self_intersections && without_area > 0)
      return std::to_string(without_area) + " triangles have no area";
    if (report.self_intersections && *report.self_intersections != pairs)
      return std::to_string(pairs) + " pairs of triangles intersect, the report has " +
             std::to_string(*report.self_intersections);
    if (kEmbedded && pairs > 0) return std::to_string(pairs) + " pairs of triangles intersect";
    if (report.topology.boundary_loops == 0 &&
        report.topology.components <= kMaxCheckedComponents) {
      if (const std::size_t wrong = misplaced_components(mesh); wrong > 0)
        return std::to_string(wrong) + " components are inverted or lie where they should not";
    }
  }
  if (report.self_intersections.has_value() == options.allow_self_intersections)
    return "self-intersections are not reported as the options require";
  if (report.measured.has_value() != (options.measure_samples > 0))
    return "it is not measured as the options require";
  if (report.measured && !std::isfinite(report.measured->maximum()))
    return "its distance is not finite";
  return "";
}

}  // namespace

std::string what_is_wrong(const Extraction& e, const ExtractOptions& options) {
  const Hierarchy& h = e.hierarchy;
  if (h.levels.size() != options.refine.size() + 1 || e.report.levels.size() != h.levels.size())
    return "another number of levels";
  if (h.parent.size() != h.positions.size()) return "another number of parents than of vertices";
  if (h.levels.back().vertex_count != h.positions.size()) return "vertices beyond the last level";
  if (options.surface.topology == Topology::faces && e.report.tunnels > 0)
    return "tunnels, although the topology is that of faces";
  for (std::size_t l = 0; l < h.levels.size(); ++l) {
    if (const std::string wrong = wrong_with_level(e, options, l); !wrong.empty())
      return "level " + std::to_string(l) + ": " + wrong;
  }
  return "";
}

}  // namespace isoatlas::detail::test
