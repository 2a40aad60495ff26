// SPDX-License-Identifier: Apache-2.0
// Where the results of `isoatlas extract` go.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "interruption.h"
#include "outputs/mesh_outputs.h"
#include "outputs/output_files.h"
#include "outputs/standard_output.h"

namespace isoatlas::detail::tool {

/// Meshes, report and page: files that appear together or not at all. One of the three may be named
/// "-": it goes to standard output when all else is ready to appear.
class ExtractOutputs {
 public:
  /// Everything that can be wrong with the names is found here. @throws Error as
  /// MeshOutputs::check()
  ExtractOutputs(const ExtractArguments& arguments, std::size_t level_count);

  /// Then what is said to people goes to standard error.
  bool uses_standard_output() const { return stream_file_ || stream_text_name_; }

  /// How much the files will round, under the names they will have.
  std::vector<FileRounding> roundings(const Hierarchy& hierarchy, const MeshFileInfo& info) const;

  /// Writes the meshes to where they are staged, and says under which names they will be there.
  /// @param intersection_control  as MeshOutputs::write()
  std::vector<ReportFile> write_meshes(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                                       const RunControl* intersection_control);

  /// The same with a report or a page, whose name is one of the arguments.
  void write_text(const std::filesystem::path& name, const std::string& text);

  /// @return false if the run was interrupted while standard output was being sent: nothing else
  /// was written then
  bool commit(Interruption& interruption);

  /// Removes all that is unfinished; may be called from another thread.
  void discard() noexcept;

  /// "NAME-0.ply and 2 more files, report NAME.json"
  std::string names(std::size_t mesh_bytes) const;

 private:
  std::size_t level_count_;
  std::optional<StandardOutputFile> stream_file_;
  std::optional<std::filesystem::path> stream_text_name_;
  std::string stream_text_;
  MeshOutputs meshes_;
  std::vector<MeshOutputs::Other> others_;  ///< report and page
  OutputFiles files_;
};

}  // namespace isoatlas::detail::tool
