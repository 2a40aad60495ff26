// SPDX-License-Identifier: Apache-2.0
// isoatlas extract: read, mesh, write, say what happened.
#include "isoatlas/extract.h"

#include <sys/resource.h>

#include <chrono>
#include <iostream>
#include <string>
#include <utility>

#include "commands.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "isoatlas/version.h"
#include "output_files.h"
#include "progress_bar.h"
#include "report/report.h"
#include "text.h"

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

/// Everything that can be wrong with the names is found here, before anybody waits.
void check_paths(const ExtractArguments& arguments) {
  const auto refuse = [](const std::string& message) { throw Error(ErrorCode::bad_argument, message); };
  if (same_file(arguments.mesh, arguments.volume.path)) refuse(arguments.mesh.string() + ": the mesh would replace the volume");
  check_output_path(arguments.mesh);
  check_mesh_path(arguments.mesh);
  if (!arguments.report) return;
  if (same_file(*arguments.report, arguments.mesh)) refuse(arguments.report->string() + ": the report would replace the mesh");
  if (same_file(*arguments.report, arguments.volume.path)) refuse(arguments.report->string() + ": the report would replace the volume");
  check_output_path(*arguments.report);
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

std::string certificate_text(const CertificateReport& certificate) {
  return counted(certificate.cells_checked, "cell") + ", " + counted(certificate.arcs_checked, "arc") + ", " +
         counted(certificate.triples_checked, "triple");
}

std::string repair_text(const CertificateReport& certificate) {
  return counted(certificate.repair_sites, "site") + " added in " + counted(certificate.repair_rounds, "round");
}

void print_summary(const ExtractArguments& arguments, const ExtractReport& report, const ReportContext& context) {
  const auto& quality = report.levels.back().quality;
  std::cout << row("read", context.volume_path + ": " + size_text(context.grid.size) + " " + std::string(name(context.sample_type)) + ", " +
                               seconds_text(context.read_seconds))
            << row("surface", "isovalue " + number_text(context.options.isovalue) + ": " + topology_text(report.levels.back().topology))
            << row("mesh", counted(context.mesh_vertices, "vertex") + ", " + counted(quality.triangles, "triangle") +
                               ", aspect ratio at least " + ratio_text(quality.aspect_min) + ", median " +
                               ratio_text(quality.aspect_median))
            << row("certificate", std::string(report.levels.back().certificate.passed ? "passed" : "FAILED") + ": " +
                                      certificate_text(report.levels.back().certificate) + "; mesh counted again: " +
                                      (report.levels.back().topology == report.reference ? "same topology" : "OTHER TOPOLOGY"))
            << row("wrote", context.mesh_path + " (" + bytes_text(static_cast<double>(fs::file_size(arguments.mesh))) + ")" +
                                (arguments.report ? " and " + arguments.report->string() : "") + ", meshed in " +
                                seconds_text(report.total_seconds));
}

void print_details(const ExtractReport& report, const ReportContext& context) {
  std::string coarser;
  for (const std::size_t size : report.coarser_c_vertices) coarser += (coarser.empty() ? "" : ", ") + count_text(size);
  std::cout << row("complex", counted(report.c_vertices, "c-vertex") + ", " + counted(report.faces, "face") + ", " +
                                  counted(report.double_segments, "double segment") + " split")
            << row("coarser", coarser.empty()
                                  ? "none: disks are too small for blocks"
                                  : coarser + " c-vertices, certified in " + std::to_string(report.coarsening.repair_rounds) + " rounds")
            << row("repair", repair_text(report.levels.back().certificate)) << row("kinds", kinds_text(report.levels.back().topology, 6))
            << row("shape", percent_text(report.levels.back().quality.aspect_share_below_third) +
                                " of the triangles below 1/3, 1st percentile " + ratio_text(report.levels.back().quality.aspect_p01) +
                                ", angles " + number_text(report.levels.back().quality.angle_min) + " to " +
                                number_text(report.levels.back().quality.angle_max) + " degrees");
  for (const StageTime& stage : report.seconds) std::cout << row("  " + stage.stage, seconds_text(stage.seconds));
  std::cout << row("  write", seconds_text(context.write_seconds))
            << row("memory", bytes_text(static_cast<double>(context.peak_memory_bytes)) + " at most");
}

}  // namespace

int run_extract(const ExtractArguments& arguments, Interruption& interruption) {
  check_paths(arguments);

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
  context.mesh_path = arguments.mesh.string();
  context.options = arguments.options;
  context.threads = arguments.threads;

  progress.show("read", std::nullopt);
  const Stopwatch reading;
  Volume volume = read_volume(arguments.volume.path, arguments.volume.raw);
  context.read_seconds = reading.seconds();
  context.grid = volume.grid;
  context.sample_type = volume.type;
  if (arguments.max_radius) context.options.max_radius = arguments.max_radius->in_world(volume.grid);
  if (arguments.event_persistence) context.options.event_persistence = arguments.event_persistence->in_world(volume.grid);

  const Extraction extraction = extract_from(arguments.volume.path, volume, context.options, control);
  volume = {};  // writing needs memory too
  context.mesh_vertices = extraction.finest().vertices;

  progress.show("write", std::nullopt);
  control.check_cancelled();
  const Stopwatch writing;
  write_mesh(extraction.mesh(), outputs.stage(arguments.mesh),
             {.space = space_name(arguments.options.space), .comment = "isoatlas " ISOATLAS_VERSION});
  context.write_seconds = writing.seconds();
  context.peak_memory_bytes = peak_memory_bytes();
  if (arguments.report) write_text_file(to_json(extraction.report, context), outputs.stage(*arguments.report));
  interruption.commit([&] { outputs.commit(); });
  progress.erase();

  if (!arguments.quiet) print_summary(arguments, extraction.report, context);
  if (arguments.verbose) print_details(extraction.report, context);
  return kSuccess;
}

}  // namespace isoatlas::tool
