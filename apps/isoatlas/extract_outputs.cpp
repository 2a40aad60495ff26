// SPDX-License-Identifier: Apache-2.0
#include "extract_outputs.h"

#include <unistd.h>

#include "file_kinds.h"
#include "isoatlas/error.h"
#include "isoatlas/text_file.h"
#include "text.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::bad_argument, message);
}

constexpr const char* kDefaultFormat = "ply";

void require_possible_stream(const ExtractArguments& arguments) {
  if (arguments.glb_per_level)
    refuse("-o -: --glb-per-level writes several files, expected -o NAME.glb");
  if (isatty(STDOUT_FILENO) != 0)
    refuse("-o -: standard output is a terminal, expected a pipe or a redirection to a file");
}

/// The temporary file of a mesh that goes to standard output.
std::optional<StandardOutputFile> stream_of(const ExtractArguments& arguments) {
  const bool is_stream = is_standard_stream(arguments.mesh);
  if (!arguments.format.empty() && !is_stream)
    refuse("--format needs -o -, found -o " + arguments.mesh.string() +
           ": its extension is the format");
  if (!is_stream) return std::nullopt;
  require_possible_stream(arguments);
  return std::optional<StandardOutputFile>(
      std::in_place, "mesh." + (arguments.format.empty() ? kDefaultFormat : arguments.format));
}

std::vector<MeshOutputs::Other> others_of(const ExtractArguments& arguments) {
  std::vector<MeshOutputs::Other> others;
  if (arguments.report) others.push_back({*arguments.report, "report"});
  if (arguments.page) others.push_back({*arguments.page, "page"});
  if (arguments.field) others.push_back({*arguments.field, "field"});
  if (arguments.returned_values) others.push_back({*arguments.returned_values, "returned values"});
  return others;
}

// The folder of a mesh for Neuroglancer.
void check_folder(const fs::path& folder, const ExtractArguments& arguments,
                  const std::vector<MeshOutputs::Other>& others) {
  if (is_standard_stream(folder) || !folder.has_filename())
    refuse("--neuroglancer " + folder.string() + ": expected the name of a folder");
  if (same_file(folder, arguments.volume.path))
    refuse(folder.string() + ": the mesh for Neuroglancer would replace the volume");
  if (same_file(folder, arguments.mesh))
    refuse(folder.string() + ": the mesh for Neuroglancer would replace the mesh");
  for (const MeshOutputs::Other& other : others) {
    if (same_file(folder, other.path))
      refuse(folder.string() + ": the mesh for Neuroglancer would replace the " + other.what);
  }
  check_neuroglancer_folder(folder);
  std::error_code error;
  const fs::path parent = resolved(folder).parent_path();
  if (!fs::is_directory(parent, error))
    throw Error(ErrorCode::bad_file,
                folder.string() + ": cannot be written: there is no folder " + parent.string());
  check_output_path(parent / (folder.filename().string() + ".index"));
}

std::string shown(const fs::path& path) {
  return is_standard_stream(path) ? kStandardOutputName : path.string();
}

}  // namespace

ExtractOutputs::ExtractOutputs(const ExtractArguments& arguments, std::size_t level_count)
    : level_count_(level_count),
      stream_file_(stream_of(arguments)),
      meshes_(stream_file_ ? stream_file_->path() : arguments.mesh, arguments.glb_per_level),
      neuroglancer_(arguments.neuroglancer),
      others_(others_of(arguments)) {
  if (arguments.level_files) level_meshes_.emplace(*arguments.level_files, false);
  std::vector<MeshOutputs::Other> named;
  std::string streamed = stream_file_ ? "mesh" : "";
  for (const MeshOutputs::Other& other : others_) {
    if (!is_standard_stream(other.path)) {
      named.push_back(other);
      continue;
    }
    if (!streamed.empty())
      refuse("the " + streamed + " and the " + other.what +
             " would both go to standard output, expected a file name for one of them");
    streamed = other.what;
    stream_text_name_ = other.path;
  }
  // A volume from standard input has no file that an output could replace.
  meshes_.check(level_count,
                is_standard_stream(arguments.volume.path) ? fs::path() : arguments.volume.path,
                named);
  if (level_meshes_) {
    named.push_back({arguments.mesh, "mesh of the finest level"});
    level_meshes_->check(level_count, arguments.volume.path, named);
  }
  if (neuroglancer_) check_folder(*neuroglancer_, arguments, named);
  if (arguments.report && !is_standard_stream(*arguments.report))
    require_report_name(*arguments.report);
  if (arguments.page && !is_standard_stream(*arguments.page)) require_page_name(*arguments.page);
}

std::vector<FileRounding> ExtractOutputs::roundings(const Hierarchy& hierarchy,
                                                    const MeshFileInfo& info) const {
  if (!stream_file_) return meshes_.roundings(hierarchy, info);
  try {
    std::vector<FileRounding> result = meshes_.roundings(hierarchy, info);
    for (FileRounding& file : result) file.path = kStandardOutputName;
    return result;
  } catch (const Error& error) {
    throw stream_file_->renamed(error);
  }
}

std::vector<ReportFile> ExtractOutputs::write_meshes(const Hierarchy& hierarchy,
                                                     const HierarchyFileInfo& info,
                                                     const RunControl* intersection_control) {
  if (!stream_file_) {
    std::vector<ReportFile> written = meshes_.write(hierarchy, info, files_, intersection_control);
    if (level_meshes_) {
      const auto levels = level_meshes_->write(hierarchy, info, files_, intersection_control);
      written.insert(written.end(), levels.begin(), levels.end());
    }
    return written;
  }
  try {
    OutputFiles whole;
    std::vector<ReportFile> written = meshes_.write(hierarchy, info, whole, intersection_control);
    whole.commit();
    for (ReportFile& file : written) file.path = "-";
    return written;
  } catch (const Error& error) {
    throw stream_file_->renamed(error);
  }
}

NeuroglancerMesh ExtractOutputs::write_neuroglancer(const Hierarchy& hierarchy,
                                                    const HierarchyFileInfo& info,
                                                    const RunControl& control) {
  if (!neuroglancer_) return {};
  return files_.write(*neuroglancer_, [&](const fs::path& staged) {
    return isoatlas::write_neuroglancer(hierarchy, staged, info, control);
  });
}

void ExtractOutputs::write_text(const fs::path& name, const std::string& text) {
  if (is_standard_stream(name))
    stream_text_ = text;
  else
    files_.write(name, [&](const fs::path& staged) { write_text_file(text, staged); });
}

void ExtractOutputs::write_volume(const fs::path& name, const VolumeView& volume) {
  files_.write(name, [&](const fs::path& staged) { write_nrrd(volume, staged); });
}

bool ExtractOutputs::commit(Interruption& interruption) {
  if (uses_standard_output()) {
    // Data that was sent cannot be withdrawn. From here on, this thread checks for interruptions.
    interruption.finish();
    const bool sent = stream_file_
                          ? stream_file_->send(interruption.requested())
                          : send_to_standard_output(stream_text_, interruption.requested());
    if (!sent) return false;
  }
  interruption.commit([&] { files_.commit(); });
  return true;
}

void ExtractOutputs::discard() noexcept {
  files_.discard();
  if (stream_file_) stream_file_->discard();
}

std::string ExtractOutputs::names(std::size_t mesh_bytes) const {
  std::string text = kStandardOutputName;
  if (!stream_file_) {
    std::vector<fs::path> paths = meshes_.paths(level_count_);
    if (level_meshes_) {
      const std::vector<fs::path> levels = level_meshes_->paths(level_count_);
      paths.insert(paths.end(), levels.begin(), levels.end());
    }
    text = paths.front().string() +
           (paths.size() > 1 ? " and " + counted(paths.size() - 1, "more file") : "");
  }
  text += " (" + bytes_text(static_cast<double>(mesh_bytes)) + ")";
  for (const auto& [path, what] : others_) text += ", " + what + " " + shown(path);
  if (neuroglancer_) text += ", Neuroglancer " + neuroglancer_->string();
  return one_line(text);
}

}  // namespace isoatlas::detail::tool
