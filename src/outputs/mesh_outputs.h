// SPDX-License-Identifier: Apache-2.0
// Which files of meshes a run writes, and which levels go into each.
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

/// What -o and --glb-per-level ask for: NAME.ply is the finest level, NAME-{level}.ply each level,
/// NAME.vtm and NAME.glb all of them; with glb_per_level also NAME-0.glb, NAME-1.glb, ... and their
/// list NAME.json.
class MeshOutputs {
 public:
  /// What else a run writes.
  struct Other {
    std::filesystem::path path;
    std::string what;  ///< "report"
  };

  /// @throws Error(bad_argument) if the name and glb_per_level do not make sense
  MeshOutputs(std::filesystem::path path, bool glb_per_level);

  /// Everything that can be wrong with the names is found here, before anybody waits.
  /// @throws Error(bad_argument) if an output would replace the volume or another output
  /// @throws Error(bad_file), Error(unsupported) if one of them cannot be written
  void check(std::size_t level_count, const std::filesystem::path& volume,
             const std::vector<Other>& others) const;

  /// How much each file will round positions, known before it is written: what is said of levels
  /// inside the files is true of them.
  std::vector<FileRounding> roundings(const Hierarchy& hierarchy, const MeshFileInfo& info) const;

  /// Writes all files to where `outputs` stages them.
  /// @param intersection_control  counts the self-intersections of files that round positions;
  /// null: does not count
  /// @return what was written, under the names it will have
  std::vector<ReportFile> write(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                                OutputFiles& outputs, const RunControl* intersection_control) const;

  /// All files that will be there, the one that the name says first.
  std::vector<std::filesystem::path> paths(std::size_t level_count) const;

 private:
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
  bool is_pattern_ = false;
};

/// What files of the levels of an extraction say about them. `unit` is that of the volume.
HierarchyFileInfo file_info(const ExtractReport& report, const ExtractOptions& options,
                            LengthUnit unit);

}  // namespace isoatlas::detail
