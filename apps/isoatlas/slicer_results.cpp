// SPDX-License-Identifier: Apache-2.0
#include "slicer_results.h"

#include <algorithm>

#include "text.h"

namespace isoatlas::detail::tool {
namespace {

std::string distance_of(const LevelReport& level, LengthUnit unit) {
  if (level.distance_at_most) return "at most " + with_unit(*level.distance_at_most, unit);
  if (level.measured)
    return with_unit(std::max(level.measured->mesh_to_surface.maximum,
                              level.measured->surface_to_mesh.maximum),
                     unit) +
           " (measured)";
  if (!level.metrics) return "not measured";
  return with_unit(level.metrics->front().maximum, unit) + " (sampled)";
}

std::string violations(const LevelReport& level, LengthUnit unit) {
  std::string text;
  for (const ConstraintResult& result : level.constraints) {
    if (result.satisfied) continue;
    const Quantity quantity = result.constraint.quantity;
    text += (text.empty() ? "" : "; ") + std::string(name(quantity)) + " " +
            bound_text(quantity, result.constraint.bound, unit) + ": reached " +
            bound_text(quantity, result.reached, unit) +
            (result.reason.empty() ? "" : ": " + result.reason);
  }
  return text.empty() ? "none" : one_line(text);
}

std::string line(const std::string& name, const std::string& value) {
  return name + " = " + value + "\n";
}

}  // namespace

std::string slicer_result_file(const ExtractReport& report, LengthUnit unit) {
  const LevelReport& level = report.levels.back();
  return line("vertices", std::to_string(level.vertices)) +
         line("triangles", std::to_string(level.triangles)) +
         line("components", std::to_string(level.topology.components)) +
         line("genus", std::to_string(level.topology.genus)) +
         line("boundaryLoops", std::to_string(level.topology.boundary_loops)) +
         line("distance", distance_of(level, unit)) + line("violated", violations(level, unit));
}

}  // namespace isoatlas::detail::tool
