// SPDX-License-Identifier: Apache-2.0
#include "levels.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>

#include "core/file_name.h"
#include "interruptible.h"
#include "isoatlas/error.h"
#include "isoatlas/neuroglancer.h"
#include "isoatlas/version.h"
#include "outputs/mesh_outputs.h"
#include "outputs/output_files.h"
#include "outputs/stated_rounding.h"
#include "page/page.h"
#include "settings_of_words.h"
#include "wording/supersampling.h"

namespace isoatlas::detail::python {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::bad_argument, message);
}

/// Replaces the index of the first sample that is not finite, which the library states in its own
/// order of axes, by the index in the caller's array.
Error error_of_samples(const Error& error, const ArrayVolume& volume, NonFinite rule) {
  if (error.code() != ErrorCode::unsupported || rule != NonFinite::refuse) return error;
  const SampleSummary summary = summarize(volume.view());
  if (summary.nan_count + summary.infinity_count == 0) return error;
  const auto [x, y, z] = summary.first_non_finite;
  const Vec3 first = volume.axes.to_caller(
      {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  const auto index = [](double i) { return std::to_string(static_cast<std::size_t>(i)); };
  return {error.code(),
          std::to_string(summary.nan_count) + " NaN and " + std::to_string(summary.infinity_count) +
              " infinite samples, the first at index (" + index(first.x) + ", " + index(first.y) +
              ", " + index(first.z) + ")",
          error.remedy()};
}

/// A warning about the first file in which rounding causes self-intersections, or an empty text.
std::string warning_of(const std::vector<ReportFile>& files) {
  for (const ReportFile& file : files) {
    for (std::size_t i = 0; i < file.self_intersections.size(); ++i) {
      if (const std::size_t pairs = file.self_intersections[i].pairs; pairs > 0)
        return file.path + ": level " + std::to_string(file.levels[i]) + ": " +
               std::to_string(pairs) +
               " self-intersections caused by rounding to float32; .ply, .obj and .vtp keep all "
               "digits";
    }
  }
  return "";
}

Error error_of_file(const Error& error, const std::string& path) {
  return path.empty() ? error : error.with_prefix(path + ": ");
}

}  // namespace

std::shared_ptr<Levels> extract_levels(const ArrayVolume& volume, const ExtractWords& words,
                                       const py::object& progress) {
  const ExtractSettings settings = settings_of(words);
  const Space space = settings.options.space;
  if (space == Space::ras && !volume.is_xyz)
    refuse("space: ras needs the coordinates x, y, z, expected order='xyz' with it");
  const VolumeView view = volume.view();
  auto levels = std::make_shared<Levels>();
  Levels::Extracted& extracted = levels->extracted.emplace();
  extracted.context.volume.path = volume.path;
  extracted.context.volume.source = volume.source;
  extracted.context.volume.grid = volume.grid;
  extracted.context.volume.sample_type = view.type;
  extracted.context.options = in_world(settings, view.grid);
  extracted.context.threads = settings.threads;

  ExtractOptions options = extracted.context.options;
  options.space = volume.axes.space_in_library(space);
  const auto work = [view, options](const RunControl& control) {
    require_memory_for_supersampling(view, options, 0, control);
    const std::string digest = sample_digest(view);
    return std::pair(extract(view, options, control), digest);
  };
  Extraction extraction;
  try {
    std::tie(extraction, extracted.context.volume.sample_digest) = compute_interruptibly(
        work, {.progress = progress, .threads = settings.threads, .keep_alive = volume.array});
  } catch (const Error& error) {
    throw error_of_file(error_of_samples(error, volume, settings.options.surface.non_finite),
                        volume.path);
  }
  volume.axes.to_caller(extraction, space);
  levels->hierarchy = std::move(extraction.hierarchy);
  extracted.report = std::move(extraction.report);
  extracted.context.peak_memory_bytes = peak_memory_bytes();
  levels->info = file_info(extracted.report, extracted.context.options, view.grid.unit);
  if (!volume.is_xyz && space != Space::voxel)
    levels->info.mesh.space.clear();  // the meaning of the array's axes is unknown
  return levels;
}

std::shared_ptr<Levels> read_levels(const std::string& path) {
  return compute_interruptibly(
      [path](const RunControl&) {
        auto levels = std::make_shared<Levels>();
        HierarchyFile file = isoatlas::read_levels(path);
        levels->hierarchy = std::move(file.hierarchy);
        levels->info = std::move(file.info);
        if (!is_hierarchy_path(path)) levels->info.mesh.comment = "isoatlas " ISOATLAS_VERSION;
        return levels;
      },
      {});
}

namespace {

/// A read-only rows x 3 view of numbers that `owner` keeps alive.
template <class Number>
py::array view_of(const void* numbers, std::size_t rows, const std::shared_ptr<Levels>& owner) {
  const py::array_t<Number> array({rows, std::size_t{3}}, {3 * sizeof(Number), sizeof(Number)},
                                  static_cast<const Number*>(numbers), py::cast(owner));
  // Levels share their vertices, and save() writes them.
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

const Hierarchy::Level& level_at(const Levels& levels, std::size_t level) {
  if (level >= levels.hierarchy.levels.size()) throw py::index_error("no such level");
  return levels.hierarchy.levels[level];
}

}  // namespace

py::array vertices_of(const std::shared_ptr<Levels>& levels, std::size_t level) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const Hierarchy::Level& it = level_at(*levels, level);
  return view_of<double>(
      it.own_positions.empty() ? levels->hierarchy.positions.data() : it.own_positions.data(),
      it.vertex_count, levels);
}

py::array faces_of(const std::shared_ptr<Levels>& levels, std::size_t level) {
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const Hierarchy::Level& it = level_at(*levels, level);
  return view_of<std::uint32_t>(it.triangles.data(), it.triangles.size(), levels);
}

py::object distance_of(const std::shared_ptr<Levels>& levels, std::size_t level) {
  const std::vector<float>& distance = level_at(*levels, level).distance;
  if (distance.empty()) return py::none();
  const py::array_t<float> array({distance.size()}, {sizeof(float)}, distance.data(),
                                 py::cast(levels));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

std::string report_of(const Levels& levels) {
  return levels.extracted ? to_json(levels.extracted->report, levels.extracted->context)
                          : std::string();
}

namespace {

/// The first levels of a hierarchy.
Hierarchy first_levels(Hierarchy hierarchy, std::size_t count) {
  if (count == 0 || count > hierarchy.levels.size()) throw py::index_error("no such level");
  hierarchy.levels.resize(count);
  if (hierarchy.positions.size() > hierarchy.levels.back().vertex_count)
    hierarchy.positions.resize(hierarchy.levels.back().vertex_count);
  return hierarchy;
}

std::string make_page(const Levels& levels, std::size_t level_count, const fs::path& path) {
  require_pages();
  Hierarchy hierarchy = first_levels(levels.hierarchy, level_count);
  // The heading names the volume, or this name if the volume came from memory.
  const PageEntry entry =
      levels.extracted ? entry_of_report(report_of(levels), "array", std::move(hierarchy), {})
                       : entry_of_levels({std::move(hierarchy), levels.info}, "mesh");
  return page_html({&entry, 1}, path);
}

/// The volume that the levels were made from; empty if it came from memory.
fs::path volume_path(const Levels& levels) {
  return levels.extracted ? levels.extracted->context.volume.path : std::string();
}

void check_page_path(const Levels& levels, const fs::path& path,
                     const std::optional<std::string>& report) {
  require_pages();
  if (path.string().find("{level}") != std::string::npos)
    refuse(path.string() + ": a page shows all levels, expected a name without {level}");
  if (same_file(path, volume_path(levels)))
    refuse(path.string() + ": the page would replace the volume");
  if (report && same_file(*report, path))
    refuse(*report + ": the report would replace the page, expected another name");
  if (report && same_file(*report, volume_path(levels)))
    refuse(*report + ": the report would replace the volume, expected another name");
  check_output_path(path);
  if (report) check_output_path(*report);
}

void save_page(const std::shared_ptr<Levels>& levels, const fs::path& path,
               const std::optional<std::string>& report) {
  check_page_path(*levels, path, report);
  const auto outputs = std::make_shared<OutputFiles>();
  run_interruptibly(
      [levels, path, report, outputs](const RunControl& control) {
        const std::string page = make_page(*levels, levels->hierarchy.levels.size(), path);
        outputs->write(path, [&](const fs::path& staged) { write_text_file(page, staged); });
        if (report)
          outputs->write(*report, [&](const fs::path& staged) {
            write_text_file(report_of(*levels), staged);
          });
        control.check_cancelled();
        outputs->commit();
      },
      {.discard = [outputs] { outputs->discard(); }});
}

}  // namespace

std::string page_of(const std::shared_ptr<Levels>& levels, std::size_t level_count) {
  return compute_interruptibly(
      [levels, level_count](const RunControl&) { return make_page(*levels, level_count, "page"); },
      {});
}

std::string save_levels(const std::shared_ptr<Levels>& levels, const std::string& path,
                        const std::optional<std::string>& report, bool glb_per_level) {
  if (report && !levels->extracted)
    refuse("report: these levels were read from a file, expected a result of extract()");
  if (lower_case_extension(path) == ".html") {
    if (glb_per_level) refuse("glb_per_level: expected it with NAME.glb, got " + path);
    save_page(levels, path, report);
    return "";
  }
  const MeshOutputs meshes(path, glb_per_level);
  std::vector<MeshOutputs::Other> others;
  if (report) others.push_back({*report, "report"});
  meshes.check(levels->hierarchy.levels.size(), volume_path(*levels), others);
  const auto output_files = std::make_shared<OutputFiles>();
  const auto warning = std::make_shared<std::string>();
  run_interruptibly(
      [levels, report, meshes, output_files, warning](const RunControl& control) {
        OutputFiles& outputs = *output_files;
        const auto started = std::chrono::steady_clock::now();
        HierarchyFileInfo info = levels->info;
        ExtractReport written_report;
        if (levels->extracted) {
          const ReportContext& context = levels->extracted->context;
          written_report = levels->extracted->report;
          state_rounding(written_report, meshes.roundings(levels->hierarchy, info.mesh),
                         context.volume.grid, context.options.space);
          info.levels = file_info(written_report, context.options, context.volume.grid.unit).levels;
        }
        const bool finds_intersections =
            levels->extracted && !levels->extracted->context.options.allow_self_intersections;
        const std::vector<ReportFile> files = meshes.write(
            levels->hierarchy, info, outputs, finds_intersections ? &control : nullptr);
        *warning = warning_of(files);
        if (report) {
          ReportContext context = levels->extracted->context;
          context.files = files;
          context.write_seconds =
              std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
          context.peak_memory_bytes = peak_memory_bytes();
          outputs.write(*report, [&](const fs::path& staged) {
            write_text_file(to_json(written_report, context), staged);
          });
        }
        control.check_cancelled();
        outputs.commit();
      },
      {.discard = [output_files] { output_files->discard(); }});
  return *warning;
}

void save_neuroglancer(const std::shared_ptr<Levels>& levels, const std::string& folder) {
  check_neuroglancer_folder(folder);
  const auto output_files = std::make_shared<OutputFiles>();
  run_interruptibly(
      [levels, folder, output_files](const RunControl& control) {
        output_files->write(folder, [&](const fs::path& staged) {
          return write_neuroglancer(levels->hierarchy, staged, levels->info, control);
        });
        control.check_cancelled();
        output_files->commit();
      },
      {.discard = [output_files] { output_files->discard(); }});
}

}  // namespace isoatlas::detail::python
