// SPDX-License-Identifier: Apache-2.0
#include "levels/judge.h"

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

double reached(Quantity quantity, const MeshExtent& mesh, const std::array<MetricSummary, kMetricCount>& metrics) {
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

// @param limits, aims  names of the constraints that came before: those that stop the work, and those that drive it
std::string reason(const Constraint& c, const MeshExtent& mesh, const Obstacles& obstacles, const std::string& limits,
                   const std::string& aims) {
  if (obstacles.before == nullptr) {
    if (c.quantity == Quantity::max_vertices) return "topology alone needs " + count_text(mesh.vertices);
    return c.quantity == Quantity::min_edge ? "topology alone needs shorter edges" : "the coarse mesh is not refined";
  }
  const auto first_comes = [](const std::string& names) { return names + " comes first"; };
  const std::string whose = obstacles.before_is_coarse ? "topology alone" : "the level before";
  switch (c.quantity) {
    case Quantity::max_vertices:
      if (static_cast<double>(obstacles.before->vertices) > c.bound)
        return whose + (obstacles.before_is_coarse ? " needs " : " has ") + count_text(obstacles.before->vertices);
      return aims.empty() ? "topology alone needs " + count_text(mesh.vertices) : first_comes(aims);
    case Quantity::min_edge:
      if (obstacles.before->shortest_edge < c.bound) return whose + (obstacles.before_is_coarse ? " needs" : " has") + " shorter edges";
      return aims.empty() ? "topology or the bends of the surface bring some vertices closer" : first_comes(aims);
    case Quantity::min_aspect:
      if (!limits.empty()) return first_comes(limits);
      return count_text(
                 static_cast<std::size_t>(std::count_if(mesh.aspects.begin(), mesh.aspects.end(), [&](double a) { return a < c.bound; }))) +
             " triangles cannot be made better where c-vertices are this sparse";
    default:
      break;
  }
  if (!limits.empty()) return first_comes(limits);
  if (c.quantity == Quantity::min_vertices)
    return "cells cannot be smaller: the surface has " + count_text(mesh.c_vertices) + " c-vertices; supersampling would give more";
  if (obstacles.cells_at_limit == 0) return "smaller cells did not help";
  return (obstacles.cells_at_limit == 1 ? "1 cell is" : count_text(obstacles.cells_at_limit) + " cells are") +
         " at the resolution limit; supersampling would help there";
}

}  // namespace

MeshExtent extent_of(const LevelMesh& mesh) {
  MeshExtent out;
  out.vertices = mesh.cell_count();
  for (CellId c = 0; c < mesh.cell_count(); ++c) out.c_vertices += mesh.c_vertices_of.row(c).size();
  out.shortest_edge = std::numeric_limits<double>::infinity();
  out.aspects.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    std::array<double, 3> edge;
    for (std::size_t k = 0; k < 3; ++k) edge[k] = length(mesh.point[t[k]] - mesh.point[t[(k + 1) % 3]]);
    const auto [low, high] = std::minmax_element(edge.begin(), edge.end());
    out.shortest_edge = std::min(out.shortest_edge, *low);
    out.longest_edge = std::max(out.longest_edge, *high);
    out.aspects.push_back(*high > 0 ? *low / *high : 0);
  }
  return out;
}

std::vector<ConstraintResult> judge(const LevelGoal& goal, const MeshExtent& mesh, const std::array<MetricSummary, kMetricCount>& metrics,
                                    const Obstacles& obstacles) {
  std::vector<ConstraintResult> out;
  std::string limits, aims;
  for (const Constraint& c : goal) {
    ConstraintResult& result = out.emplace_back();
    result.wanted = c;
    result.reached = reached(c.quantity, mesh, metrics);
    result.met = is_lower_bound(c.quantity) ? result.reached >= c.bound : result.reached <= c.bound;
    if (!result.met) result.reason = reason(c, mesh, obstacles, limits, aims);
    const auto add_to = [&](std::string& list) { list += (list.empty() ? "" : ", ") + std::string(name(c.quantity)); };
    if (c.quantity == Quantity::max_vertices) {
      if (obstacles.vertices_ran_out) add_to(limits);
    } else if (c.quantity == Quantity::min_edge) {
      if (obstacles.edges_in_the_way) add_to(limits);
    } else {
      add_to(aims);
    }
  }
  return out;
}

}  // namespace isoatlas::detail
