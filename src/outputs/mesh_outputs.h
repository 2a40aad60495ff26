// SPDX-License-Identifier: Apache-2.0
// The mesh files that a run writes, and the levels in each of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/mesh_file.h"
#include "outputs/output_files.h"
#include "outputs/stated_rounding.h"
#include "report/report.h"

namespace isoatlas::detail {

/// The mesh files of the options -o and --glb-per-level. NAME.ply is the finest level;
/// NAME-{level}.ply is one file per level; NAME.vtm and NAME.glb have all levels. With
/// `glb_per_level`, there are also NAME-0.glb, NAME-1.glb, ... and their list NAME.json.
class MeshOutputs {
 public:
  /// Another output of the run.
  struct Other {
    std::filesystem::path path;
    std::string what;  ///< its name in messages: "report"
  };

  /// @throws Error(bad_argument) if braces in the name are not {level}, or if the name does not fit
  ///         `glb_per_level`
  MeshOutputs(std::filesystem::path path, bool glb_per_level);

  /// Checks all output paths. Call it before a long computation.
  /// @throws Error(bad_argument) if an output would replace the volume or another output
  /// @throws Error(bad_file), Error(unsupported) if one of them cannot be written
  void check(std::size_t level_count, const std::filesystem::path& volume,
             const std::vector<Other>& others) const;

  /// The rounding of positions in each file. It is known before the files are written, so that the
  /// facts about levels inside the files can include it.
  std::vector<FileRounding> roundings(const Hierarchy& hierarchy, const MeshFileInfo& info) const;

  /// Writes all files to the staged paths of `outputs`.
  /// @param intersection_control  for counting the self-intersections of files that round
  /// positions;
  ///        null: they are not counted
  /// @return the files with their final names
  std::vector<ReportFile> write(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                                OutputFiles& outputs, const RunControl* intersection_control) const;

  /// All files that will be written, the file with the given name first.
  std::vector<std::filesystem::path> paths(std::size_t level_count) const;

 private:
  // A file and its levels.
  struct Item {
    std::filesystem::path path;
    std::vector<std::size_t> levels;
  };
  std::vector<Item> items(std::size_t level_count) const;
  std::filesystem::path level_path(std::size_t level) const;
  std::filesystem::path manifest() const {
    return std::filesystem::path(path_).replace_extension(".json");
  }

  std::filesystem::path path_;
  bool glb_per_level_;
  bool is_pattern_ = false;  // the name contains {level}
};

/// The metadata for the mesh files of an extraction.
/// @param unit  the unit of the volume
HierarchyFileInfo file_info(const ExtractReport& report, const ExtractOptions& options,
                            LengthUnit unit);

}  // namespace isoatlas::detail
