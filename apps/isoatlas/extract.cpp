// SPDX-License-Identifier: Apache-2.0
// isoatlas extract: read, mesh, write, say what happened.
#include "isoatlas/extract.h"

#include <sys/resource.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "exit_status.h"
#include "extract_summary.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "isoatlas/version.h"
#include "mesh_outputs.h"
#include "output_files.h"
#include "page/page.h"
#include "progress_bar.h"
#include "report/report.h"

namespace isoatlas::tool {
namespace {

namespace fs = std::filesystem;

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point started_ = Clock::now();
};

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

/// The library does not know what the volume is called; its messages should.
Extraction extract_from(const fs::path& path, const VolumeView& volume, const ExtractOptions& options, const RunControl& control) {
  try {
    return extract(volume, options, control);
  } catch (const Error& error) {
    throw Error(error.code(), path.string() + ": " + error.what());
  }
}

const char* space_name(Space space) {
  switch (space) {
    case Space::lps:
      return "LPS";
    case Space::ras:
      return "RAS";
    case Space::voxel:
      return "voxel";
  }
  return "";
}

}  // namespace

int run_extract(const ExtractArguments& arguments, Interruption& interruption) {
  const MeshOutputs meshes(arguments.mesh, arguments.glb_per_level);
  if (arguments.page) require_pages();
  std::vector<MeshOutputs::Other> others;
  if (arguments.report) others.push_back({*arguments.report, "report"});
  if (arguments.page) others.push_back({*arguments.page, "page"});
  meshes.check(1 + arguments.goals.refine.size(), arguments.volume.path, others);

  ProgressBar progress(!arguments.quiet);
  OutputFiles outputs;
  const Interruption::Cleanup clean_up(interruption, [&] {
    progress.erase();
    outputs.discard();
  });
  const RunControl control{.progress = [&](std::string_view stage, double fraction) { progress.show(stage, fraction); },
                           .cancel = &interruption.requested(),
                           .threads = arguments.threads};
  ReportContext context;
  context.volume_path = arguments.volume.path.string();
  context.options = arguments.options;
  context.threads = arguments.threads;
  context.command = arguments.command;

  progress.show("read", std::nullopt);
  const Stopwatch reading;
  Volume volume = read_volume(arguments.volume.path, arguments.volume.raw);
  context.read_seconds = reading.seconds();
  context.grid = volume.grid;
  context.sample_type = volume.type;
  ExtractOptions& options = context.options;
  if (arguments.max_radius) options.max_radius = arguments.max_radius->in_world(volume.grid);
  if (arguments.min_component_size) options.min_component_size = arguments.min_component_size->in_world(volume.grid);
  if (arguments.event_persistence) options.event_persistence = arguments.event_persistence->in_world(volume.grid);
  options.coarse = in_world(arguments.goals.coarse, volume.grid);
  for (const auto& goal : arguments.goals.refine) options.refine.push_back(in_world(goal, volume.grid));

  Extraction extraction = extract_from(arguments.volume.path, volume, options, control);
  const ExtractReport& report = extraction.report;
  std::optional<MeshQuality> marching_cubes;  // for the page to compare with
  if (arguments.page) {
    progress.show("compare", std::nullopt);
    marching_cubes = marching_cubes_quality(volume, options.isovalue);
  }
  volume = {};  // writing needs memory too

  progress.show("write", std::nullopt);
  control.check_cancelled();
  const Stopwatch writing;
  HierarchyFileInfo info{
      .mesh = {.space = space_name(options.space), .comment = "isoatlas " ISOATLAS_VERSION}, .placement = options.placement, .levels = {}};
  for (std::size_t k = 0; k < report.levels.size(); ++k) info.levels.push_back(level_json(report.levels[k], k));
  context.files = meshes.write(extraction.hierarchy, info, outputs);
  context.write_seconds = writing.seconds();
  context.peak_memory_bytes = peak_memory_bytes();
  const std::string json = arguments.report || arguments.page ? to_json(report, context) : "";
  if (arguments.report) outputs.write(*arguments.report, [&](const fs::path& staged) { write_text_file(json, staged); });
  if (arguments.page) {
    progress.show("page", std::nullopt);
    const PageEntry entry = entry_of_report(json, arguments.page->string(), std::move(extraction.hierarchy), marching_cubes);
    const std::string page = page_html({&entry, 1}, *arguments.page);
    outputs.write(*arguments.page, [&](const fs::path& staged) { write_text_file(page, staged); });
  }
  interruption.commit([&] { outputs.commit(); });
  progress.erase();

  std::string written = meshes.text(report.levels.size());
  for (const auto& [path, what] : others) written += ", " + what + " " + path.string();
  if (!arguments.quiet) print_summary(report, context, written);
  if (arguments.verbose) print_details(report, context);
  return print_unmet(report) ? kSuccess : kUnmet;
}

}  // namespace isoatlas::tool
