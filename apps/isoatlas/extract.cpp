// SPDX-License-Identifier: Apache-2.0
// isoatlas extract: read, mesh, write, say what happened.
#include "isoatlas/extract.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "exit_status.h"
#include "extract_summary.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "outputs/mesh_outputs.h"
#include "outputs/output_files.h"
#include "page/page.h"
#include "progress_bar.h"
#include "report/report.h"
#include "text.h"
#include "volume_input.h"

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

/// The library does not know what the volume is called; its messages should.
Extraction extract_from(const fs::path& path, const VolumeView& volume, const ExtractOptions& options, const RunControl& control) {
  try {
    return extract(volume, options, control);
  } catch (const Error& error) {
    throw Error(error.code(), path.string() + ": " + error.what());
  }
}

/// Lengths need the volume's unit, which is known only now.
ExtractOptions options_in_world(const ExtractArguments& arguments, const Grid& grid) {
  try {
    return in_world(arguments, grid);
  } catch (const Error& error) {
    throw Error(error.code(), arguments.volume.path.string() + ": " + error.what());
  }
}

/// "NAME.ply", or "NAME-0.ply and 2 more files"
std::string files_text(const std::vector<fs::path>& paths) {
  return paths.front().string() + (paths.size() > 1 ? " and " + counted(paths.size() - 1, "more file") : "");
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
  context.threads = arguments.threads;
  context.command = arguments.command;

  progress.show("read", std::nullopt);
  const Stopwatch reading;
  VolumeFile file = read_volume_input(arguments.volume.path, arguments.volume.read);
  if (!file.source.warnings.empty()) progress.clear_line();
  print_warnings(arguments.volume.path, file.source);
  Volume volume = std::move(file.volume);
  context.read_seconds = reading.seconds();
  context.volume = {arguments.volume.path.string(), std::move(file.source), "", volume.grid, volume.type};
  if (arguments.report || arguments.page) context.volume.sample_digest = sample_digest(volume);
  context.options = options_in_world(arguments, volume.grid);
  const ExtractOptions& options = context.options;

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
  context.files = meshes.write(extraction.hierarchy, file_info(report, options), outputs);
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

  std::string written = files_text(meshes.paths(report.levels.size()));
  for (const auto& [path, what] : others) written += ", " + what + " " + path.string();
  if (!arguments.quiet) print_summary(report, context, written);
  if (arguments.verbose) print_details(report, context);
  return print_unmet(report, context.volume.grid.unit) ? kSuccess : kUnmet;
}

}  // namespace isoatlas::tool
