// SPDX-License-Identifier: Apache-2.0
// isoatlas levels: compares the levels of detail in a file.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "core/file_name.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "report/level_facts.h"
#include "text.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

/// The levels of a file, and whether they are nested.
struct LevelsOfFile {
  std::vector<LevelFacts> facts;
  std::optional<bool> nested;
  std::string about_nesting;
};

/// Topology and shape are recounted from the triangles; metrics and distances are those that the
/// file states.
LevelFacts recount(const TriangleMesh& mesh, const std::optional<LevelFacts>& stated) {
  LevelFacts facts;
  if (stated) {
    facts.metrics = stated->metrics;
    facts.measured = stated->measured;
    facts.distance_at_most = stated->distance_at_most;
  }
  const MeshTopology topology = mesh_topology(mesh);
  facts.vertices = topology.vertices;
  facts.triangles = topology.triangles;
  facts.is_manifold = topology.is_manifold() && topology.is_oriented() && topology.triangles > 0;
  if (*facts.is_manifold) facts.topology = summarize(topology.components);
  facts.topology.components = topology.components.size();
  facts.quality = mesh_quality(mesh);
  return facts;
}

/// The first vertex of the coarser level that is missing in the finer level, or has another
/// position there. None if the vertices of the coarser level are the first of the finer level, bit
/// by bit.
std::optional<std::size_t> first_difference(const std::vector<Vec3>& coarse,
                                            const std::vector<Vec3>& fine) {
  for (std::size_t v = 0; v < coarse.size(); ++v)
    if (v >= fine.size() || std::memcmp(&coarse[v], &fine[v], sizeof(Vec3)) != 0) return v;
  return std::nullopt;
}

LevelsOfFile levels_of_meshes(const fs::path& path) {
  const HierarchyFile file = read_hierarchy(path);
  LevelsOfFile levels;
  levels.nested = true;
  levels.about_nesting =
      "yes: every vertex of a level is in the next one, at the same index, bit by bit";
  TriangleMesh coarser;
  for (std::size_t k = 0; k < file.hierarchy.levels.size(); ++k) {
    TriangleMesh mesh = file.hierarchy.mesh(k);
    levels.facts.push_back(recount(mesh, file.info.levels.empty()
                                             ? std::nullopt
                                             : facts_of_level(file.info.levels[k], path.string())));
    const auto difference = first_difference(coarser.positions, mesh.positions);
    if (difference && *levels.nested) {
      levels.nested = false;
      levels.about_nesting = "NO: vertex " + count_text(*difference) + " of level " +
                             std::to_string(k - 1) + " has another position in level " +
                             std::to_string(k);
    }
    coarser = std::move(mesh);
  }
  if (file.info.placement == Placement::balanced) {
    levels.nested = std::nullopt;
    levels.about_nesting =
        "by index only: with balanced placement vertices have other positions in each level";
  } else if (levels.facts.size() == 1) {
    levels.about_nesting = "yes: there is one level";
  }
  return levels;
}

LevelsOfFile facts_of_file(const fs::path& path) {
  if (is_hierarchy_path(path)) return levels_of_meshes(path);
  if (!has_extension(path, ".json"))
    throw Error(
        ErrorCode::unsupported,
        path.string() + ": unknown format for levels of detail, expected .glb, .vtm or .json");
  return {facts_of_levels(read_text_file(path), path.string()), std::nullopt,
          "not known: the file has no vertices"};
}

/// Prints rows: a label, then a column for each level.
class Table {
 public:
  explicit Table(const std::vector<LevelFacts>& levels) : levels_(levels) {}

  void line(const std::string& label,
            const std::function<std::string(const LevelFacts&)>& cell) const {
    std::cout << "  " << label
              << std::string(kLabelWidth - std::min(kLabelWidth, label.size()), ' ');
    for (const LevelFacts& level : levels_) {
      const std::string text = cell(level);
      std::cout << std::string(kColumnWidth - std::min(kColumnWidth - 1, text.size()), ' ') << text;
    }
    std::cout << "\n";
  }

 private:
  static constexpr std::size_t kLabelWidth = 30, kColumnWidth = 14;
  const std::vector<LevelFacts>& levels_;
};

/// A ratio is infinite if the triangles of a Voronoi cell face away from its surface.
std::string metric_text(double value) {
  return std::isinf(value) ? "unbounded" : number_text(value);
}

/// The proved bound of the distances, or else their sampling density. Empty if distances were not
/// measured.
std::string distance_sampling(const LevelFacts& finest) {
  if (finest.distance_at_most)
    return proof_text(*finest.distance_at_most) +
           (finest.measured ? "; " + sampling_text(*finest.measured) : "");
  if (finest.measured) return sampling_text(*finest.measured);
  if (!finest.metrics[static_cast<std::size_t>(Quantity::max_distance)]) return "";
  return "sampled at about 2 points per voxel face of the isosurface, and on every triangle";
}

void print_table(const std::string& path, const LevelsOfFile& levels) {
  std::cout << one_line(path) << "\n";
  const Table table(levels.facts);
  std::size_t number = 0;
  table.line("level", [&](const LevelFacts&) { return std::to_string(number++); });
  table.line("vertices", [](const LevelFacts& l) { return count_text(l.vertices); });
  table.line("triangles", [](const LevelFacts& l) { return count_text(l.triangles); });
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const std::string metric(name(static_cast<Quantity>(i)));
    const auto known = [i](double MetricSummary::*part) {
      return [i, part](const LevelFacts& l) {
        return l.metrics[i] ? metric_text(*l.metrics[i].*part) : "-";
      };
    };
    table.line(metric + ", maximum", known(&MetricSummary::maximum));
    table.line(std::string(metric.size(), ' ') + "  mean", known(&MetricSummary::mean));
  }
  if (std::ranges::any_of(levels.facts,
                          [](const LevelFacts& l) { return l.measured.has_value(); })) {
    table.line("measured distance, maximum", [](const LevelFacts& l) {
      return l.measured ? number_text(l.measured->maximum()) : "-";
    });
  }
  table.line("aspect ratio, minimum",
             [](const LevelFacts& l) { return ratio_text(l.quality.aspect_min); });
  table.line("              1st percentile",
             [](const LevelFacts& l) { return ratio_text(l.quality.aspect_p01); });
  table.line("              median",
             [](const LevelFacts& l) { return ratio_text(l.quality.aspect_median); });
  table.line("              below 1/3",
             [](const LevelFacts& l) { return percent_text(l.quality.aspect_share_below_third); });
  table.line("angle, minimum",
             [](const LevelFacts& l) { return number_text(l.quality.angle_min); });
  table.line("manifold", [](const LevelFacts& l) {
    return !l.is_manifold ? "-" : *l.is_manifold ? "yes" : "NO";
  });
  table.line("components", [](const LevelFacts& l) { return count_text(l.topology.components); });
  const auto defined = [](std::int64_t TopologySummary::*part) {
    return [part](const LevelFacts& l) {
      return l.is_manifold.value_or(true) ? std::to_string(l.topology.*part) : "-";
    };
  };
  table.line("genus", defined(&TopologySummary::genus));
  table.line("boundary loops", defined(&TopologySummary::boundary_loops));
  if (const std::string sampling = distance_sampling(levels.facts.back()); !sampling.empty())
    std::cout << row("distances", sampling);
  std::cout << row("nested", levels.about_nesting);
}

}  // namespace

int run_levels(const LevelsArguments& arguments) {
  const LevelsOfFile levels = facts_of_file(arguments.file);
  if (arguments.json)
    std::cout << to_json(arguments.file.string(), levels.facts, levels.nested);
  else
    print_table(arguments.file.string(), levels);
  const bool is_good =
      std::all_of(levels.facts.begin(), levels.facts.end(),
                  [](const LevelFacts& level) { return level.is_manifold.value_or(true); });
  return is_good ? kSuccess : kCheckFailed;
}

}  // namespace isoatlas::detail::tool
