// SPDX-License-Identifier: Apache-2.0
// The output files and streams of `isoatlas extract`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "interruption.h"
#include "isoatlas/neuroglancer.h"
#include "outputs/mesh_outputs.h"
#include "outputs/output_files.h"
#include "outputs/standard_output.h"

namespace isoatlas::detail::tool {

/// Meshes, report and page: files that appear together or not at all. One of the three may be named
/// "-": it is sent to standard output when all files are complete.
class ExtractOutputs {
 public:
  /// Checks all output names. @throws Error as MeshOutputs::check()
  ExtractOutputs(const ExtractArguments& arguments, std::size_t level_count);

  /// True if a result goes to standard output. The summary then goes to standard error.
  bool uses_standard_output() const { return stream_file_ || stream_text_name_; }

  /// How much each file will round the coordinates; files have their final names.
  std::vector<FileRounding> roundings(const Hierarchy& hierarchy, const MeshFileInfo& info) const;

  /// Writes the meshes to the staging folder. Returns the files with their final names.
  /// @param intersection_control  as MeshOutputs::write()
  std::vector<ReportFile> write_meshes(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                                       const RunControl* intersection_control);

  /// Writes all levels for Neuroglancer to the staging folder, if that was requested.
  NeuroglancerMesh write_neuroglancer(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                                      const RunControl& control);

  /// Writes a report or a page to the staging folder. `name` is that of the arguments.
  void write_text(const std::filesystem::path& name, const std::string& text);

  /// Writes a volume to the staging folder, as NRRD.
  void write_volume(const std::filesystem::path& name, const VolumeView& volume);

  /// Sends standard output, then puts all files in place.
  /// @return false if the run was interrupted while standard output was sent; no file is then
  /// written
  bool commit(Interruption& interruption);

  /// Removes all staged files. May be called from another thread.
  void discard() noexcept;

  /// "NAME-0.ply and 2 more files, report NAME.json"
  std::string names(std::size_t mesh_bytes) const;

 private:
  std::size_t level_count_;
  std::optional<StandardOutputFile> stream_file_;
  std::optional<std::filesystem::path> stream_text_name_;
  std::string stream_text_;
  MeshOutputs meshes_;
  std::optional<MeshOutputs> level_meshes_;  ///< also all levels, as .vtp, which do not round
  std::optional<std::filesystem::path> neuroglancer_;
  std::vector<MeshOutputs::Other> others_;  ///< report, page and returned values
  OutputFiles files_;
};

}  // namespace isoatlas::detail::tool
