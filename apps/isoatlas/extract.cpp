// SPDX-License-Identifier: Apache-2.0
// isoatlas extract: reads a volume, meshes it, writes the results and prints a summary.
#include "isoatlas/extract.h"

#include <chrono>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "block_parts.h"
#include "blocks.h"
#include "commands.h"
#include "exit_status.h"
#include "extract_outputs.h"
#include "extract_summary.h"
#include "isoatlas/blocks.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "isoatlas/mask_field.h"
#include "outputs/stated_rounding.h"
#include "page/page.h"
#include "progress_bar.h"
#include "report/report.h"
#include "slicer_results.h"
#include "text.h"
#include "volume_input.h"
#include "wording/supersampling.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point started_ = Clock::now();
};

/// Warns if supersampling is possible but takes much memory.
void warn_of_memory(std::ostream& out, std::uint64_t bytes, std::uint32_t factor) {
  constexpr std::uint64_t kMuch = std::uint64_t{4} << 30;
  if (bytes < kMuch) return;
  out << "isoatlas: warning: --supersample " << factor << " takes about "
      << bytes_text(static_cast<double>(bytes)) << " of memory\n";
}

/// Meshes the volume in blocks, or merges the blocks that are there.
Extraction extract_blocks(const ExtractArguments& arguments, const VolumeReader& volume,
                          const ExtractOptions& options, const RunControl& control) {
  const BlockPlan plan(volume.grid(), block_size_of(arguments, volume));
  const auto samples_of = [&](const BlockBox& box) {
    volume.drop();  // the samples of the last box
    return volume.box(box.first, box.last);
  };
  if (!arguments.parts) return extract_in_blocks(plan, samples_of, options, control);
  const BlockParts parts(*arguments.parts, plan);
  if (!arguments.only_merges) {
    const std::vector<std::size_t> elsewhere = parts.make(volume, options, {}, control);
    if (!elsewhere.empty())
      throw Error(ErrorCode::bad_argument, "another run is making " + blocks_text(elsewhere) +
                                               "; run `isoatlas blocks merge` when it has ended");
  }
  if (const std::vector<std::size_t> missing = parts.missing(); !missing.empty())
    throw Error(ErrorCode::bad_argument, arguments.parts->string() + ": " + blocks_text(missing) +
                                             " of " + std::to_string(plan.block_count()) +
                                             " missing; make them with `isoatlas blocks run " +
                                             arguments.parts->string() + "`");
  return parts.merge(samples_of, options, control);
}

/// The volume of the arguments. For blocks it gets a reader, and has samples only if the page needs
/// them.
VolumeFile read_input(const ExtractArguments& arguments, std::optional<VolumeReader>& reader) {
  if (!arguments.is_in_blocks())
    return read_volume_input(arguments.volume.path, arguments.volume.read);
  require_no_labels(arguments);
  reader.emplace(open_volume_input(arguments.volume.path, arguments.volume.read));
  VolumeFile file{{}, reader->source()};
  const Size3& size = reader->grid().size;
  if (arguments.page) file.volume = reader->box({0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1});
  file.volume.view.grid = reader->grid();
  file.volume.view.type = reader->type();
  return file;
}

/// Runs the extraction. Errors of the library get the name of the volume as prefix.
Extraction extract_from(const ExtractArguments& arguments, const VolumeView& volume,
                        const std::optional<VolumeReader>& reader, const ExtractOptions& options,
                        const RunControl& control, std::ostream& messages) {
  try {
    if (reader) return extract_blocks(arguments, *reader, options, control);
    warn_of_memory(messages, require_memory_for_supersampling(volume, options, 0, control),
                   options.supersample);
    return extract(volume, options, control);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_file) throw;  // of a block's file, which it names
    throw error.with_prefix(volume_name(arguments.volume.path) + ": ");
  }
}

/// The options with lengths converted to the unit of the volume.
ExtractOptions options_in_world(const ExtractArguments& arguments, const Grid& grid) {
  try {
    return in_world(arguments, grid);
  } catch (const Error& error) {
    throw error.with_prefix(volume_name(arguments.volume.path) + ": ");
  }
}

/// Replaces the volume by a smooth field around the samples with one of arguments.labels, and the
/// surface by that of the field.
void mesh_labels(const ExtractArguments& arguments, Volume& volume, ExtractOptions& options,
                 const RunControl& control) {
  try {
    volume = mask_field(mask_of_labels(volume, arguments.labels), arguments.mask, control);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.with_prefix(volume_name(arguments.volume.path) + ": ");
  }
  options.surface.isovalue = 0;
  options.surface.inside = Inside::above;
  options.surface.topology = Topology::faces;
}

/// Data that was already sent to standard output cannot be withdrawn.
int interrupted_while_sending(const Interruption& interruption) {
  std::cerr << "isoatlas: interrupted; standard output is incomplete, no file was written"
            << std::endl;
  return interruption.exit_status();
}

}  // namespace

int run_extract(const ExtractArguments& arguments, Interruption& interruption) {
  ProgressBar progress(!arguments.quiet);
  return run_extract(arguments, interruption, {progress, std::cerr});
}

int run_extract(const ExtractArguments& arguments, Interruption& interruption,
                const RunConsole& console) {
  ProgressDisplay& progress = console.progress;
  if (arguments.page) require_pages();
  const std::size_t planned = arguments.options.levels;
  ExtractOutputs outputs(arguments, planned > 0 ? planned : 1 + arguments.goals.refine.size());

  if (arguments.parts) interruption.set_message(kBlocksAreKept);
  const Interruption::Cleanup clean_up(interruption, [&] {
    progress.erase();
    outputs.discard();
  });
  const RunControl control{
      .progress = [&](std::string_view stage, double fraction) { progress.show(stage, fraction); },
      .cancel = &interruption.requested(),
      .threads = arguments.threads};
  ReportContext context;
  context.threads = arguments.threads;
  context.command = arguments.command;

  progress.show("read", std::nullopt);
  const Stopwatch reading;
  std::optional<VolumeReader> reader;  // for blocks
  VolumeFile file = read_input(arguments, reader);
  if (!file.source.warnings.empty()) progress.clear_line();
  print_warnings(console.messages, arguments.volume.path, file.source);
  Volume volume = std::move(file.volume);
  context.read_seconds = reading.seconds();
  context.volume = {arguments.volume.path.string(), std::move(file.source), "", volume.view.grid,
                    volume.view.type};
  if (arguments.report || arguments.page)
    context.volume.sample_digest = reader ? reader->digest() : sample_digest(volume);
  context.options = options_in_world(arguments, volume.view.grid);
  if (!arguments.labels.empty()) {
    progress.show("mask", std::nullopt);
    RunControl quiet = control;
    quiet.progress = nullptr;
    mesh_labels(arguments, volume, context.options, quiet);
  }
  const ExtractOptions& options = context.options;

  Extraction extraction =
      extract_from(arguments, volume, reader, options, control, console.messages);
  ExtractReport& report = extraction.report;
  std::optional<MeshQuality> marching_cubes;  // shown on the page for comparison
  if (arguments.page) {
    progress.show("compare", std::nullopt);
    std::vector<Vec3> kept;
    for (const RankedComponent& component : report.kept) kept.push_back(component.position);
    marching_cubes =
        marching_cubes_quality(volume, options.surface.isovalue,
                               to_index(std::move(kept), volume.view.grid, options.space));
  }
  if (arguments.field) outputs.write_volume(*arguments.field, volume);
  volume = {};  // frees memory for writing
  reader.reset();

  progress.show("write", std::nullopt);
  control.check_cancelled();
  const Stopwatch writing;
  const Grid& grid = context.volume.grid;
  const MeshFileInfo mesh_info = file_info(report, options, grid.unit).mesh;
  state_rounding(report, outputs.roundings(extraction.hierarchy, mesh_info), grid, options.space);
  context.files = outputs.write_meshes(extraction.hierarchy, file_info(report, options, grid.unit),
                                       options.allow_self_intersections ? nullptr : &control);
  if (arguments.neuroglancer) {
    NeuroglancerMesh written = outputs.write_neuroglancer(
        extraction.hierarchy, file_info(report, options, grid.unit), control);
    context.neuroglancer = {arguments.neuroglancer->string(), written.fragments, written.bytes,
                            std::move(written.rounding), std::move(written.self_intersections)};
  }
  context.write_seconds = writing.seconds();
  context.peak_memory_bytes = peak_memory_bytes();
  if (arguments.strict) {
    progress.clear_line();
    if (!print_violations(console.messages, report, context)) {
      console.messages << "isoatlas: nothing was written, because of --strict\n";
      return kUnsatisfied;
    }
  }
  const std::string json = arguments.report || arguments.page ? to_json(report, context) : "";
  if (arguments.report) outputs.write_text(*arguments.report, json);
  if (arguments.page) {
    progress.show("page", std::nullopt);
    add_noticeable_rounding(extraction.hierarchy, report, grid);
    const PageEntry entry = entry_of_report(json, arguments.page->string(),
                                            std::move(extraction.hierarchy), marching_cubes);
    outputs.write_text(*arguments.page, page_html({&entry, 1}, *arguments.page));
  }
  if (arguments.returned_values)
    outputs.write_text(*arguments.returned_values, slicer_result_file(report, grid.unit));
  const bool is_complete = outputs.commit(interruption);
  is_complete ? progress.finish() : progress.erase();
  if (!is_complete) return interrupted_while_sending(interruption);

  std::ostream& out = outputs.uses_standard_output() ? std::cerr : std::cout;
  if (!arguments.quiet) {
    std::size_t bytes = 0;
    for (const ReportFile& written : context.files) bytes += written.bytes;
    print_summary(out, report, context, outputs.names(bytes));
  }
  if (arguments.verbose) print_details(out, report, context);
  print_rounding(console.messages, context);
  return print_violations(console.messages, report, context) ? kSuccess : kUnsatisfied;
}

}  // namespace isoatlas::detail::tool
