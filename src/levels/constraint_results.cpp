// SPDX-License-Identifier: Apache-2.0
#include "levels/constraint_results.h"

#include <algorithm>
#include <limits>
#include <string>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

std::string count_text(std::size_t n) {
  const std::string digits = std::to_string(n);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

double reached(Quantity quantity, const MeshStatistics& mesh,
               const std::array<MetricSummary, kMetricCount>& metrics) {
  switch (quantity) {
    case Quantity::max_vertices:
    case Quantity::min_vertices:
      return static_cast<double>(mesh.vertices);
    case Quantity::min_edge:
      return mesh.shortest_edge;
    case Quantity::max_edge:
      return mesh.longest_edge;
    case Quantity::min_aspect:
      return mesh.aspects.empty() ? 1 : *std::min_element(mesh.aspects.begin(), mesh.aspects.end());
    default:
      return metrics[static_cast<std::size_t>(quantity)].maximum;
  }
}

// @param limits, targets  names of the earlier constraints: those that limit refinement, and those
//        that drive it
std::string reason(const Constraint& c, const MeshStatistics& mesh, const Obstacles& obstacles,
                   const std::string& limits, const std::string& targets) {
  if (obstacles.previous == nullptr) {
    if (c.quantity == Quantity::max_vertices)
      return "topology alone needs " + count_text(mesh.vertices);
    return c.quantity == Quantity::min_edge ? "topology alone needs shorter edges"
                                            : "the coarse mesh is not refined";
  }
  const auto priority_of = [](const std::string& names) { return names + " comes first"; };
  const std::string previous =
      obstacles.previous_is_coarse ? "topology alone" : "the previous level";
  switch (c.quantity) {
    case Quantity::max_vertices:
      if (static_cast<double>(obstacles.previous->vertices) > c.bound)
        return previous + (obstacles.previous_is_coarse ? " needs " : " has ") +
               count_text(obstacles.previous->vertices);
      return targets.empty() ? "topology alone needs " + count_text(mesh.vertices)
                             : priority_of(targets);
    case Quantity::min_edge:
      if (obstacles.previous->shortest_edge < c.bound)
        return previous + (obstacles.previous_is_coarse ? " needs" : " has") + " shorter edges";
      return targets.empty() ? "topology or the bends of the surface bring some vertices closer"
                             : priority_of(targets);
    case Quantity::min_aspect:
      if (!limits.empty()) return priority_of(limits);
      return count_text(
                 static_cast<std::size_t>(std::count_if(mesh.aspects.begin(), mesh.aspects.end(),
                                                        [&](double a) { return a < c.bound; }))) +
             " triangles cannot be made better where c-vertices are this sparse";
    default:
      break;
  }
  if (!limits.empty()) return priority_of(limits);
  if (c.quantity == Quantity::min_vertices)
    return "cells cannot be smaller: the surface has " + count_text(mesh.c_vertices) +
           " c-vertices; supersampling would give more";
  if (obstacles.cells_at_limit == 0) return "smaller cells did not help";
  return (obstacles.cells_at_limit == 1 ? "1 cell is"
                                        : count_text(obstacles.cells_at_limit) + " cells are") +
         " at the resolution limit; supersampling would help there";
}

}  // namespace

MeshStatistics mesh_statistics(const LevelMesh& mesh) {
  MeshStatistics out;
  out.vertices = mesh.cell_count();
  for (CellId c = 0; c < mesh.cell_count(); ++c) out.c_vertices += mesh.c_vertices_of.row(c).size();
  out.shortest_edge = std::numeric_limits<double>::infinity();
  out.aspects.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    std::array<double, 3> edge;
    for (std::size_t k = 0; k < 3; ++k)
      edge[k] = length(mesh.point[t[k]] - mesh.point[t[(k + 1) % 3]]);
    const auto [low, high] = std::minmax_element(edge.begin(), edge.end());
    out.shortest_edge = std::min(out.shortest_edge, *low);
    out.longest_edge = std::max(out.longest_edge, *high);
    out.aspects.push_back(*high > 0 ? *low / *high : 0);
  }
  return out;
}

std::vector<ConstraintResult> evaluate_constraints(
    const LevelGoal& goal, const MeshStatistics& mesh,
    const std::array<MetricSummary, kMetricCount>& metrics, const CustomMaximum& custom_maximum,
    const Obstacles& obstacles) {
  std::vector<ConstraintResult> out;
  std::string limits, targets;
  for (const Constraint& c : goal) {
    ConstraintResult& result = out.emplace_back();
    result.constraint = c;
    result.reached = c.custom ? custom_maximum(*c.custom) : reached(c.quantity, mesh, metrics);
    result.satisfied =
        is_lower_bound(c.quantity) ? result.reached >= c.bound : result.reached <= c.bound;
    if (!result.satisfied) result.reason = reason(c, mesh, obstacles, limits, targets);
    const auto add_to = [&](std::string& list) {
      list += (list.empty() ? "" : ", ") + std::string(name(c));
    };
    if (c.quantity == Quantity::max_vertices) {
      if (obstacles.vertex_limit_reached) add_to(limits);
    } else if (c.quantity == Quantity::min_edge) {
      if (obstacles.blocked_by_min_edge) add_to(limits);
    } else {
      add_to(targets);
    }
  }
  return out;
}

}  // namespace isoatlas::detail
