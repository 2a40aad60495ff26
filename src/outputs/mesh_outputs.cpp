// SPDX-License-Identifier: Apache-2.0
#include "outputs/mesh_outputs.h"

#include <sys/stat.h>

#include <numeric>
#include <system_error>
#include <utility>

#include "isoatlas/error.h"
#include "isoatlas/text_file.h"
#include "isoatlas/version.h"

namespace isoatlas::detail {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPlaceholder = "{level}";

[[noreturn]] void refuse(const fs::path& path, const std::string& message) {
  throw Error(ErrorCode::bad_argument, path.string() + ": " + message);
}

/// Checks the folder for the level files of a .vtm. The files are written next to the .vtm and then
/// renamed, so an existing folder must be on the same file system.
void check_level_folder(const fs::path& path, std::size_t level_count, const fs::path& volume) {
  const std::vector<fs::path> files = files_of_hierarchy(target_of(path), level_count);
  if (files.size() == 1) return;
  const fs::path folder = files[1].parent_path();
  std::error_code error;
  if (same_file(folder, volume))
    refuse(path, "its levels would be written into the volume's folder " + folder.string());
  if (!fs::is_directory(folder, error)) return;
  struct stat parent {
  }, inside{};
  if (stat(resolved(path).parent_path().c_str(), &parent) == 0 &&
      stat(folder.c_str(), &inside) == 0 && parent.st_dev != inside.st_dev)
    refuse(path, "the folder " + folder.string() +
                     " for its levels is on another file system, expected the same one");
  for (std::size_t i = 1; i < files.size(); ++i) check_output_path(files[i]);
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

/// A hierarchy that consists of one level of another one.
Hierarchy only_level(const Hierarchy& hierarchy, std::size_t level) {
  Hierarchy result;
  result.levels.push_back(hierarchy.levels[level]);
  result.float32_origin = hierarchy.float32_origin;
  const auto count = static_cast<std::ptrdiff_t>(hierarchy.levels[level].vertex_count);
  result.positions.assign(hierarchy.positions.begin(), hierarchy.positions.begin() + count);
  return result;
}

}  // namespace

MeshOutputs::MeshOutputs(fs::path path, bool glb_per_level)
    : path_(std::move(path)), glb_per_level_(glb_per_level) {
  const std::string name = path_.filename().string();
  for (std::size_t open = name.find('{'); open != std::string::npos;
       open = name.find('{', open + 1)) {
    if (name.compare(open, kPlaceholder.size(), kPlaceholder) != 0)
      refuse(path_, "expected only {level} in braces, for the number of the level, got " +
                        name.substr(open));
    if (is_pattern_) refuse(path_, "{level} occurs twice in the name, expected once");
    is_pattern_ = true;
  }
  if (path_.parent_path().string().find(kPlaceholder) != std::string::npos)
    refuse(path_, "{level} is in the name of a folder, expected it in the name of the file");
  const bool is_glb = is_hierarchy_path(path_) && files_of_hierarchy(path_, 1).size() == 1;
  if (is_pattern_ && is_hierarchy_path(path_) && !is_glb)
    refuse(path_, "a .vtm holds all levels, expected a name without {level}");
  if (glb_per_level_ && (!is_glb || is_pattern_))
    refuse(path_, "--glb-per-level needs a .glb with all levels, expected -o NAME.glb");
}

fs::path MeshOutputs::level_path(std::size_t level) const {
  if (!is_pattern_)
    return path_.parent_path() /
           (path_.stem().string() + "-" + std::to_string(level) + path_.extension().string());
  std::string name = path_.filename().string();
  name.replace(name.find(kPlaceholder), kPlaceholder.size(), std::to_string(level));
  return path_.parent_path() / name;
}

std::vector<MeshOutputs::Item> MeshOutputs::items(std::size_t level_count) const {
  std::vector<std::size_t> all(level_count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<Item> result;
  if (!is_pattern_)
    result.push_back(
        {path_, is_hierarchy_path(path_) ? all : std::vector<std::size_t>{level_count - 1}});
  if (is_pattern_ || glb_per_level_)
    for (const std::size_t level : all) result.push_back({level_path(level), {level}});
  return result;
}

void MeshOutputs::check(std::size_t level_count, const fs::path& volume,
                        const std::vector<Other>& others) const {
  std::vector<fs::path> meshes;
  for (const Item& item : items(level_count)) {
    meshes.push_back(item.path);
    if (same_file(item.path, volume)) refuse(item.path, "the mesh would replace the volume");
    check_output_path(item.path);
    if (is_hierarchy_path(item.path)) {
      check_level_folder(item.path, level_count, volume);
      check_hierarchy_path(item.path, level_count);
      const std::vector<fs::path> files = files_of_hierarchy(target_of(item.path), level_count);
      for (std::size_t i = 1; i < files.size(); ++i) {
        if (same_file(files[i], volume))
          refuse(item.path, "one of its levels would replace the volume");
        meshes.push_back(files[i]);
      }
    } else {
      check_mesh_path(item.path);
    }
  }
  if (glb_per_level_) {
    if (same_file(manifest(), volume))
      refuse(manifest(), "the list of levels would replace the volume");
    check_output_path(manifest());
  }
  for (std::size_t i = 0; i < meshes.size(); ++i)  // two names can be links to one file
    for (std::size_t j = 0; j < i; ++j)
      if (same_file(meshes[i], meshes[j]))
        refuse(meshes[i], "a level would replace another, in " + meshes[j].string());
  for (std::size_t i = 0; i < others.size(); ++i) {
    const fs::path& path = others[i].path;
    const std::string& what = others[i].what;
    const auto replaces = [&](const fs::path& other, const std::string& name) {
      if (same_file(path, other))
        refuse(path, "the " + what + " would replace the " + name + ", expected another name");
    };
    if (glb_per_level_) replaces(manifest(), "list of levels");
    for (const fs::path& mesh : meshes) replaces(mesh, "mesh");
    for (std::size_t j = 0; j < i; ++j) replaces(others[j].path, others[j].what);
    replaces(volume, "volume");
    check_output_path(path);
  }
}

std::vector<FileRounding> MeshOutputs::roundings(const Hierarchy& hierarchy,
                                                 const MeshFileInfo& info) const {
  const std::size_t level_count = hierarchy.levels.size();
  std::vector<FileRounding> result;
  for (const Item& item : items(level_count)) {
    const std::size_t first = item.levels.front();
    const double rounding =
        !is_hierarchy_path(item.path)
            ? rounding_of_mesh_file(hierarchy.mesh(first), item.path, info)
        : item.levels.size() < level_count
            ? rounding_of_hierarchy_file(only_level(hierarchy, first), item.path)
            : rounding_of_hierarchy_file(hierarchy, item.path);
    result.push_back({item.path.string(), item.levels, rounding});
  }
  return result;
}

std::vector<ReportFile> MeshOutputs::write(const Hierarchy& hierarchy,
                                           const HierarchyFileInfo& info, OutputFiles& outputs,
                                           const RunControl* intersection_control) const {
  const std::size_t level_count = hierarchy.levels.size();
  std::vector<ReportFile> written, one_level;
  const auto add = [&](const fs::path& path, const fs::path& staged,
                       std::vector<std::size_t> levels, const StoredPositions& stored) {
    written.push_back({path.string(),
                       std::move(levels),
                       static_cast<std::size_t>(fs::file_size(staged)),
                       stored.single_precision,
                       stored.largest_rounding,
                       stored.space,
                       stored.unit,
                       stored.notes,
                       {}});
  };
  // Counts self-intersections of the file added last; `file` contains its levels.
  const auto count_intersections = [&](const Hierarchy& file, const fs::path& path) {
    if (intersection_control == nullptr || !written.back().single_precision) return;
    for (std::size_t k = 0; k < file.levels.size(); ++k) {
      TriangleMesh mesh = file.mesh(k);
      mesh.positions = is_hierarchy_path(path) ? stored_positions(file, k, path)
                                               : stored_positions(mesh, path, info.mesh);
      written.back().self_intersections.push_back(
          find_self_intersections(mesh, *intersection_control));
    }
  };
  for (const Item& item : items(level_count)) {
    outputs.write(item.path, [&](const fs::path& staged) {
      if (!is_hierarchy_path(item.path)) {
        const std::size_t level = item.levels.front();
        const Hierarchy only = only_level(hierarchy, level);
        MeshFileInfo mesh_info = info.mesh;
        mesh_info.cap_triangles = only.levels[0].cap_triangles;
        add(item.path, staged, item.levels, write_mesh(only.mesh(0), staged, mesh_info));
        count_intersections(only, staged);
        return;
      }
      const bool is_part = item.levels.size() < level_count;
      HierarchyFileInfo part = info;
      if (is_part && !info.levels.empty()) part.levels = {info.levels[item.levels.front()]};
      const Hierarchy only = is_part ? only_level(hierarchy, item.levels.front()) : Hierarchy();
      const Hierarchy& all = is_part ? only : hierarchy;
      const StoredPositions stored = write_hierarchy(all, staged, part);
      add(item.path, staged, item.levels, stored);
      count_intersections(all, staged);
      if (glb_per_level_ && item.path != path_) one_level.push_back(written.back());
      const std::vector<fs::path> names = files_of_hierarchy(target_of(item.path), level_count);
      const std::vector<fs::path> files = files_of_hierarchy(staged, level_count);
      for (std::size_t i = 1; i < files.size(); ++i) add(names[i], files[i], {i - 1}, stored);
    });
  }
  if (glb_per_level_)
    outputs.write(manifest(), [&](const fs::path& staged) {
      write_text_file(levels_manifest(one_level, info.levels), staged);
    });
  return written;
}

std::vector<fs::path> MeshOutputs::paths(std::size_t level_count) const {
  std::vector<fs::path> result;
  for (const Item& item : items(level_count)) {
    result.push_back(item.path);
    if (!is_hierarchy_path(item.path)) continue;
    const std::vector<fs::path> files = files_of_hierarchy(target_of(item.path), level_count);
    result.insert(result.end(), files.begin() + 1, files.end());
  }
  if (glb_per_level_) result.push_back(manifest());
  return result;
}

HierarchyFileInfo file_info(const ExtractReport& report, const ExtractOptions& options,
                            LengthUnit unit) {
  HierarchyFileInfo info{
      .mesh = {.space = space_name(options.space),
               .comment = "isoatlas " ISOATLAS_VERSION,
               .unit = options.space == Space::voxel ? LengthUnit::unknown : unit},
      .placement = options.placement,
      .levels = {}};
  for (std::size_t k = 0; k < report.levels.size(); ++k)
    info.levels.push_back(level_json(report.levels[k], k));
  return info;
}

}  // namespace isoatlas::detail
