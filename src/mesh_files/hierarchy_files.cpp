// SPDX-License-Identifier: Apache-2.0
// Reading and writing files of levels; the extension selects the format.
#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "core/file_name.h"
#include "files/file_error.h"
#include "mesh_files/formats.h"

namespace isoatlas {
using namespace detail;

namespace fs = std::filesystem;

namespace {

struct HierarchyFormat {
  std::string_view extension;
  io::StoredLevels (*read)(const fs::path&);
  StoredPositions (*write)(const Hierarchy&, const HierarchyFileInfo&, const fs::path&);
  bool has_pieces;
  double (*rounding)(const Hierarchy&, const fs::path&);  ///< null: all digits are kept
  std::vector<Vec3> (*positions)(const Hierarchy&, std::size_t,
                                 const fs::path&);  ///< null: all digits are kept
};

constexpr std::array kFormats{
    HierarchyFormat{".glb", io::read_glb, io::write_glb, false, io::rounding_in_glb,
                    io::positions_in_glb},
    HierarchyFormat{".vtm", io::read_vtm, io::write_vtm, true, nullptr, nullptr}};

const HierarchyFormat* find_format(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  const auto found = std::ranges::find(kFormats, extension, &HierarchyFormat::extension);
  return found == kFormats.end() ? nullptr : &*found;
}

const HierarchyFormat& format_of(const fs::path& path) {
  const HierarchyFormat* format = find_format(path);
  if (format == nullptr) {
    throw io::unsupported(path, "unknown format for levels of detail, expected .glb or .vtm");
  }
  return *format;
}

std::string fault_of(const TriangleMesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return "the position of vertex " + std::to_string(v) + " is not finite";
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::ranges::any_of(mesh.triangles[t], [&](std::uint32_t corner) {
          return corner >= mesh.positions.size();
        })) {
      return "triangle " + std::to_string(t) + " uses a vertex that does not exist";
    }
  }
  return mesh.triangles.empty() ? "there are no triangles" : "";
}

std::string fault_of(const std::vector<float>& distances, std::size_t vertex_count) {
  if (!distances.empty() && distances.size() != vertex_count) {
    return "there are " + std::to_string(distances.size()) + " distances for " +
           std::to_string(vertex_count) + " vertices";
  }
  for (std::size_t v = 0; v < distances.size(); ++v) {
    if (!(distances[v] >= 0) || std::isinf(distances[v])) {
      return "the distance of vertex " + std::to_string(v) + " is not finite or negative";
    }
  }
  return "";
}

std::string fault_of(const Hierarchy& hierarchy, const HierarchyFileInfo& info) {
  if (hierarchy.levels.empty()) {
    return "there are no levels";
  }
  if (!info.levels.empty() && info.levels.size() != hierarchy.levels.size()) {
    return "there are " + std::to_string(info.levels.size()) + " JSON texts for " +
           std::to_string(hierarchy.levels.size()) + " levels";
  }
  std::uint32_t most = 0;
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    const Hierarchy::Level& level = hierarchy.levels[k];
    const std::string where = "level " + std::to_string(k) + ": ";
    if (level.vertex_count < most ||
        (level.own_positions.empty() && level.vertex_count > hierarchy.positions.size()) ||
        (!level.own_positions.empty() && level.own_positions.size() != level.vertex_count)) {
      return where + "its " + std::to_string(level.vertex_count) +
             " vertices do not begin with those of the previous level";
    }
    if (const std::string fault = fault_of(level.distance, level.vertex_count); !fault.empty()) {
      return where + fault;
    }
    most = level.vertex_count;
    if (const std::string fault = fault_of(hierarchy.mesh(k)); !fault.empty()) {
      return where + fault;
    }
    if (!info.levels.empty() &&
        !nlohmann::json::parse(info.levels[k], nullptr, false).is_object()) {
      return where + "its JSON text is not a JSON object";
    }
  }
  return "";
}

}  // namespace

bool is_hierarchy_path(const fs::path& path) { return find_format(path) != nullptr; }

std::vector<fs::path> files_of_hierarchy(const fs::path& path, std::size_t level_count) {
  std::vector<fs::path> files{path};
  for (std::size_t k = 0; format_of(path).has_pieces && k < level_count; ++k) {
    files.push_back(io::vtm_piece(path, k));
  }
  return files;
}

void check_hierarchy_path(const fs::path& path, std::size_t level_count) {
  const HierarchyFormat& format = format_of(path);
  const io::AtomicFile probe(path);
  if (!format.has_pieces) {
    return;
  }
  const fs::path folder = io::vtm_piece(path, 0).parent_path();
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) {
    return;
  }
  if (!fs::is_directory(status)) {
    throw io::bad_file(path, "cannot be written: " + folder.string() +
                                 " is not a folder, but its levels are written there");
  }
  for (std::size_t k = 0; k < level_count; ++k) {
    const io::AtomicFile piece(io::vtm_piece(path, k));
  }
}

StoredPositions write_hierarchy(const Hierarchy& hierarchy, const fs::path& path,
                                const HierarchyFileInfo& info) {
  const HierarchyFormat& format = format_of(path);
  if (const std::string fault = fault_of(hierarchy, info); !fault.empty()) {
    throw Error(ErrorCode::bad_argument, io::one_line(path.string() + ": not written: " + fault));
  }
  HierarchyFileInfo clean_info = info;
  clean_info.mesh = {io::one_line(info.mesh.space), io::one_line(info.mesh.comment),
                     info.mesh.unit};
  return io::translate_exceptions(path, [&] { return format.write(hierarchy, clean_info, path); });
}

double rounding_of_hierarchy_file(const Hierarchy& hierarchy, const fs::path& path) {
  const HierarchyFormat& format = format_of(path);
  return format.rounding == nullptr || hierarchy.levels.empty() ? 0
                                                                : format.rounding(hierarchy, path);
}

std::vector<Vec3> stored_positions(const Hierarchy& hierarchy, std::size_t level,
                                   const fs::path& path) {
  const HierarchyFormat& format = format_of(path);
  return format.positions == nullptr ? hierarchy.mesh(level).positions
                                     : format.positions(hierarchy, level, path);
}

HierarchyFile read_hierarchy(const fs::path& path) {
  return io::translate_exceptions(path, [&] {
    io::readable_file_size(path);
    io::StoredLevels stored = format_of(path).read(path);
    HierarchyFile file;
    file.info = std::move(stored.info);
    for (std::size_t k = 0; k < stored.meshes.size(); ++k) {
      std::string fault = fault_of(stored.meshes[k]);
      if (fault.empty()) {
        fault = fault_of(stored.distances[k], stored.meshes[k].positions.size());
      }
      if (!fault.empty()) {
        throw io::bad_file(path, "level " + std::to_string(k) + ": " + fault);
      }
    }
    file.hierarchy = hierarchy_of(std::move(stored.meshes));
    for (std::size_t k = 0; k < stored.distances.size(); ++k) {
      file.hierarchy.levels[k].distance = std::move(stored.distances[k]);
    }
    return file;
  });
}

}  // namespace isoatlas
