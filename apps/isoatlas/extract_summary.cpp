// SPDX-License-Identifier: Apache-2.0
#include "extract_summary.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "extent_text.h"
#include "outputs/stated_rounding.h"
#include "text.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

std::string level_name(std::size_t level) { return "level " + std::to_string(level); }

std::string certificate_text(const CertificateReport& certificate) {
  return counted(certificate.cells_checked, "cell") + ", " +
         counted(certificate.arcs_checked, "arc") + ", " +
         counted(certificate.triples_checked, "triple");
}

std::string repair_text(const CertificateReport& certificate) {
  return counted(certificate.repair_sites, "site") + " added in " +
         counted(certificate.repair_rounds, "round");
}

/// The first few places.
std::string places_text(const std::vector<Vec3>& places) {
  constexpr std::size_t kMostShown = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(places.size(), kMostShown); ++i)
    text += (i == 0 ? "" : ", ") + point_text(places[i]);
  return text;
}

/// " (0.25 of it by rounding to float32)" after a length that rounding increased noticeably.
std::string rounding_text(const LevelReport& level, double reached, LengthUnit unit) {
  constexpr double kNoticeableShare = 0.01;
  if (level.rounding <= kNoticeableShare * reached) return "";
  return " (" + with_unit(level.rounding, unit) + " of it by rounding to float32)";
}

/// The measured distance of a level. It may exceed a bound that the metric satisfies.
std::string measured_text(const LevelReport& level, LengthUnit unit) {
  const double maximum =
      level.measured->maximum() + level.rounding;  // measured before it was rounded
  std::string text = "measured at most " + with_unit(maximum, unit) + " (99 % within " +
                     with_unit(level.measured->p99() + level.rounding, unit) + ")";
  for (const ConstraintResult& result : level.constraints)
    if (result.constraint.quantity == Quantity::max_distance && maximum > result.constraint.bound)
      text += ", above the bound " + with_unit(result.constraint.bound, unit);
  return text;
}

/// The supersampling factor at which the Voronoi cells at the limit could satisfy their bounds.
/// Assumes that distances are proportional to the sample spacing.
std::uint32_t helpful_supersampling(const LevelReport& level, std::uint32_t factor) {
  constexpr double kMost = 8;
  return factor * static_cast<std::uint32_t>(
                      std::clamp(std::ceil(level.at_limit.front().excess), 2.0, kMost));
}

/// Size, metrics, constraints and shape of a level, on one line.
/// @param supersample  the supersampling factor of the run
std::string level_text(const LevelReport& level, std::uint32_t supersample, LengthUnit unit) {
  std::string text =
      counted(level.vertices, "vertex") + ", " + counted(level.triangles, "triangle");
  std::string violated;
  for (const ConstraintResult& result : level.constraints) {
    const std::string quantity(name(result.constraint.quantity));
    if (is_metric(result.constraint.quantity))
      text += ", " + quantity + " " + bound_text(result.constraint.quantity, result.reached, unit);
    if (result.constraint.quantity == Quantity::max_distance)
      text += rounding_text(level, result.reached, unit);
    const std::string bound =
        result.constraint.is_default
            ? " (default " + bound_text(result.constraint.quantity, result.constraint.bound, unit) +
                  ")"
            : "";
    if (result.satisfied) {
      text += bound;
    } else {
      violated += (violated.empty() ? "" : ", ") + quantity + bound;
    }
  }
  if (level.measured) text += ", " + measured_text(level, unit);
  text += ", aspect ratio at least " + ratio_text(level.quality.aspect_min) + ", " +
          percent_text(level.quality.aspect_share_below_third) + " below 1/3";
  if (level.self_intersections)
    text += ", " + (*level.self_intersections == 0 ? "no" : count_text(*level.self_intersections)) +
            " self-intersections";
  if (!violated.empty()) text += "; violated: " + violated;
  if (!level.at_limit.empty())
    text += "; --supersample " + std::to_string(helpful_supersampling(level, supersample)) +
            " would help at " + counted(level.at_limit.size(), "place");
  return text;
}

/// The proved bound of the distances, or else their sampling density. Empty if no distance was
/// computed.
std::string distance_sampling(const ExtractReport& report) {
  const LevelReport& level = report.levels.back();
  if (!level.metrics) return "";
  if (level.distance_at_most)
    return proof_text(*level.distance_at_most) +
           (level.measured ? "; " + sampling_text(*level.measured) : "");
  if (!level.measured)
    return "sampled at " + count_text(report.c_vertices + report.faces) +
           " points of the isosurface, about 2 per voxel face, and on every triangle; --measure "
           "adds 200,000 samples in each direction";
  return sampling_text(*level.measured);
}

/// The result of recounting all levels. Nesting is compared only if self-intersections are not
/// allowed.
std::string recount_text(const ExtractReport& report) {
  if (report.blocks)  // any other Euler characteristic would have been an error
    return "the merged triangles have the Euler characteristic of the blocks' surfaces";
  const auto same = [&](const LevelReport& level) { return level.topology == report.reference; };
  const auto is_placed = [](const LevelReport& level) { return level.inverted_components == 0; };
  const std::string what =
      report.levels.back().self_intersections ? "orientation and nesting" : "orientation";
  return std::string(std::ranges::all_of(report.levels, same) ? "same topology"
                                                              : "DIFFERENT TOPOLOGY") +
         ", " + (std::ranges::all_of(report.levels, is_placed) ? what : "but NOT the same " + what);
}

/// The certificate of the finest level. It represents all levels: a run with a level that fails
/// ends with an error.
std::string certificate_of_all(const ExtractReport& report) {
  const auto passed = [](const LevelReport& level) { return level.certificate.passed; };
  const std::size_t count = report.levels.size();
  const std::string where = count == 1 ? "" : " on all " + std::to_string(count) + " levels";
  return (std::ranges::all_of(report.levels, passed) ? "passed" : "FAILED") + where + ": " +
         certificate_text(report.levels.back().certificate) + (count == 1 ? "" : " on the finest") +
         "; counted again: " + recount_text(report);
}

/// A ratio is infinite if the triangles of a Voronoi cell face away from its surface; the mean is
/// then infinite as well.
std::string metric_text(Quantity metric, const MetricSummary& summary, LengthUnit unit) {
  if (std::isinf(summary.maximum))
    return "unbounded: in some places triangles face away from the surface";
  return "at most " + bound_text(metric, summary.maximum, unit) + ", on average " +
         bound_text(metric, summary.mean, unit);
}

void print_level_details(std::ostream& out, const LevelReport& level, std::size_t number,
                         LengthUnit unit) {
  const auto print_row = [&](const std::string& label, const std::string& value) {
    out << row("  " + label, value);
  };
  out << row(level_name(number), repair_text(level.certificate) + " by repair, " +
                                     counted(level.refine_rounds, "round") + " of refinement, " +
                                     seconds_text(level.seconds));
  print_row("shape", "aspect ratio 1st percentile " + ratio_text(level.quality.aspect_p01) +
                         ", median " + ratio_text(level.quality.aspect_median) + ", angles " +
                         number_text(level.quality.angle_min) + " to " +
                         number_text(level.quality.angle_max) + " degrees (" +
                         counted(level.quality.angles_above_150, "triangle") +
                         " above 150), between triangles " +
                         number_text(level.quality.dihedral_min) + " to " +
                         number_text(level.quality.dihedral_max) + " degrees");
  for (std::size_t i = 0; level.metrics && i < kMetricCount; ++i) {
    const auto metric = static_cast<Quantity>(i);
    print_row(std::string(name(metric)), metric_text(metric, (*level.metrics)[i], unit));
  }
  for (const ConstraintResult& result : level.constraints)
    print_row(result.satisfied ? "satisfied" : "violated",
              std::string(name(result.constraint.quantity)) + " " +
                  bound_text(result.constraint.quantity, result.constraint.bound, unit) +
                  (result.constraint.is_default ? " (default)" : "") + ": reached " +
                  bound_text(result.constraint.quantity, result.reached, unit));
  if (!level.measured) return;
  const auto distances = [unit](const OneSidedDistance& d) {
    return "at most " + with_unit(d.maximum, unit) + ", 99 % within " + with_unit(d.p99, unit) +
           ", on average " + with_unit(d.mean, unit);
  };
  print_row("to surface", distances(level.measured->mesh_to_surface));
  print_row("from surface", distances(level.measured->surface_to_mesh));
  print_row("normals", "differ by " + number_text(level.measured->normal_mean) +
                           " degrees on average, at most " +
                           number_text(level.measured->normal_maximum));
}

/// "3 components, the largest of 12.5 cubic mm at ..., cut by the volume boundary"
std::string ranked_text(const std::vector<RankedComponent>& components, LengthUnit unit) {
  const RankedComponent& largest = components.front();
  const std::size_t parts = components.back().part - largest.part + 1;
  return (parts < components.size() ? counted(parts, "part") + " in " : "") +
         counted(components.size(), "component") + (parts > 1 ? ", the largest of " : " of ") +
         volume_text(largest.size, unit) + " at " + point_text(largest.position) +
         (largest.topology.boundary_loops > 0 ? ", cut by the volume boundary" : "");
}

/// Where the volume boundary cuts the surface. Empty if it does not.
std::string border_text(const LevelReport& level, bool is_in_blocks, LengthUnit unit) {
  if (level.caps) {
    if (level.caps->triangles == 0) return "closed without caps";
    return "closed by caps on the volume boundary: " + counted(level.caps->triangles, "triangle") +
           ", " + number_text(level.caps->area) + " square " +
           (unit == LengthUnit::unknown ? "units" : std::string(symbol(unit))) +
           "; errors and shape do not include them";
  }
  const std::int64_t loops = level.topology.boundary_loops;
  if (loops == 0) return "";
  return "open: the volume boundary cuts the surface in " +
         counted(static_cast<std::uint64_t>(loops), "loop") +
         (is_in_blocks ? "" : "; --border closed caps it");
}

std::string blocks_text(const BlockSummary& blocks) {
  return counted(blocks.counts[0] * blocks.counts[1] * blocks.counts[2], "block") + " of up to " +
         size_text(blocks.block_size) + " grid cells, " + count_text(blocks.with_surface) +
         " with a part of the surface; " + counted(blocks.seam_vertices, "vertex") +
         " on shared faces fit";
}

}  // namespace

void print_summary(std::ostream& out, const ExtractReport& report, const ReportContext& context,
                   const std::string& outputs) {
  const Grid& grid = context.volume.grid;
  const LengthUnit unit = grid.unit;
  const std::string spacing = number_text(grid.spacing.x) + " x " + number_text(grid.spacing.y) +
                              " x " + with_unit(grid.spacing.z, unit);
  out << row("read", volume_name(context.volume.path) + ": " + size_text(grid.size) + " " +
                         std::string(name(context.volume.sample_type)) + ", spacing " + spacing +
                         ", " + seconds_text(context.read_seconds))
      << row("surface", "isovalue " + number_text(context.options.surface.isovalue) + ": " +
                            topology_text(report.levels.back().topology));
  if (!report.kept.empty()) out << row("kept", ranked_text(report.kept, unit));
  if (!report.dropped.empty()) out << row("dropped", ranked_text(report.dropped, unit));
  const std::string border = border_text(report.levels.back(), report.blocks.has_value(), unit);
  if (!border.empty()) out << row("border", border);
  if (report.blocks) out << row("blocks", blocks_text(*report.blocks));
  for (std::size_t k = 0; k < report.levels.size(); ++k)
    out << row(level_name(k), level_text(report.levels[k], context.options.supersample, unit));
  if (const std::string sampling = distance_sampling(report); !sampling.empty())
    out << row("distances", sampling);
  double rounding = 0;
  for (const ReportFile& file : context.files) rounding = std::max(rounding, file.largest_rounding);
  out << row("certificate", certificate_of_all(report))
      << row("wrote", outputs + ", meshed in " + seconds_text(report.total_seconds) +
                          (rounding > 0 ? "; rounded by at most " + number_text(rounding) +
                                              ", read back and checked"
                                        : ""));
  if (!context.files.empty())  // the same for all
    for (const std::string& note : context.files.front().notes) out << row("note", note);
}

void print_details(std::ostream& out, const ExtractReport& report, const ReportContext& context) {
  std::string coarser;
  for (const std::size_t size : report.coarser_c_vertices)
    coarser += (coarser.empty() ? "" : ", ") + count_text(size);
  out << row("complex", counted(report.c_vertices, "c-vertex") + ", " +
                            counted(report.faces, "face") + ", " +
                            counted(report.double_segments, "double segment") + " split" +
                            (report.tunnels > 0 ? ", " + counted(report.tunnels, "tunnel") : ""))
      << row("coarser", coarser.empty()
                            ? "none: disks are too small for blocks"
                            : coarser + " c-vertices, certified in " +
                                  std::to_string(report.coarsening.repair_rounds) + " rounds")
      << row("kinds", kinds_text(report.levels.back().topology, 6));
  const LengthUnit unit = context.volume.grid.unit;
  print_extent(out, report.levels.back().extent, unit,
               context.options.space == Space::voxel ? "samples" : std::string(symbol(unit)));
  for (std::size_t k = 0; k < report.levels.size(); ++k)
    print_level_details(out, report.levels[k], k, unit);
  for (const StageTime& stage : report.seconds)
    out << row("  " + stage.stage, seconds_text(stage.seconds));
  out << row("  write", seconds_text(context.write_seconds))
      << row("memory", bytes_text(static_cast<double>(context.peak_memory_bytes)) + " at most");
}

bool print_violations(std::ostream& out, const ExtractReport& report,
                      const ReportContext& context) {
  const LengthUnit unit = context.volume.grid.unit;
  bool is_sound = true;
  const auto print_violation = [&](const std::string& text) {
    is_sound = false;
    out << one_line("isoatlas: " + text) << "\n";
  };
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    const LevelReport& level = report.levels[k];
    if (level.self_intersections.value_or(0) > 0)
      print_violation(
          level_name(k) + ": " + counted(*level.self_intersections, "self-intersection") +
          ", near " + places_text(level.self_intersection_positions) +
          ": the surface is too close to itself there; --supersample 2 may separate it");
    if (level.inverted_components > 0)
      print_violation(level_name(k) + ": " + counted(level.inverted_components, "component") +
                      " inverted or inside the wrong component; a finer level or --supersample 2 "
                      "may correct it");
  }
  for (const ReportFile& file : context.files) {
    for (std::size_t i = 0; i < file.self_intersections.size(); ++i) {
      const SelfIntersectionReport& found = file.self_intersections[i];
      if (found.pairs <= report.levels[file.levels[i]].self_intersections.value_or(0)) continue;
      std::vector<Vec3> places;
      for (const SelfIntersectionReport::Place& place : found.first)
        places.push_back(place.position);
      print_violation((file.path == "-" ? "standard output" : file.path) + ": " +
                      level_name(file.levels[i]) + ": " +
                      counted(found.pairs, "self-intersection") +
                      " caused by rounding to float32, near " + places_text(places) +
                      "; .ply, .obj and .vtp keep all digits");
    }
  }
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    for (const ConstraintResult& result : report.levels[k].constraints) {
      if (result.satisfied || result.constraint.is_default) continue;
      const Quantity quantity = result.constraint.quantity;
      out << one_line("isoatlas: " + level_name(k) + ": " + std::string(name(quantity)) + " " +
                      bound_text(quantity, result.constraint.bound, unit) + ": reached " +
                      bound_text(quantity, result.reached, unit) +
                      (result.reason.empty() ? "" : ": " + result.reason))
          << "\n";
    }
  }
  return is_sound && std::all_of(report.levels.begin(), report.levels.end(),
                                 [](const LevelReport& level) { return level.all_satisfied(); });
}

void print_rounding(std::ostream& out, const ReportContext& context) {
  const Grid& grid = context.volume.grid;
  const Space space = context.options.space;
  for (const ReportFile& file : context.files) {
    const double rounding = rounding_in_world(file.largest_rounding, grid, space);
    if (!is_noticeable(rounding, grid)) continue;
    const std::string name = file.path == "-" ? "standard output" : file.path;
    out << one_line("isoatlas: " + name + ": its float32 coordinates move vertices by up to " +
                    with_unit(rounding, grid.unit) +
                    "; the stated error includes this; .ply, .obj and .vtp keep all digits" +
                    (space == Space::voxel
                         ? ""
                         : ", and --space voxel gives coordinates near the origin"))
        << "\n";
    return;
  }
}

}  // namespace isoatlas::detail::tool
