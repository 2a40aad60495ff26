// SPDX-License-Identifier: Apache-2.0
#include "file_kinds.h"

#include <algorithm>
#include <fstream>
#include <system_error>
#include <vector>

#include "core/file_name.h"
#include "files/stored_data.h"
#include "isoatlas/error.h"
#include "isoatlas/mesh_file.h"
#include "mesh_files/formats.h"
#include "nearest_name.h"
#include "volume_files/volume_format.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPictures = ".png .jpg .jpeg .bmp .gif";

/// False for folders, pipes, empty files and files that cannot be read.
bool has_contents(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && fs::file_size(path, error) > 0 &&
         std::ifstream(path).good();
}

bool is_volume(const fs::path& path) {
  try {
    io::format_of(path);
    // A legacy VTK file may also hold a mesh, which isoatlas cannot read.
    return !has_extension(path, ".vtk") ||
           io::first_bytes(path, 1024).find("POLYDATA") == std::string::npos;
  } catch (const Error&) {
    return false;
  }
}

/// The header next to a file of samples; empty if it is missing.
fs::path header_of(const fs::path& path) {
  for (const char* extension : {".nhdr", ".mhd", ".hdr"}) {
    const fs::path header = fs::path(path).replace_extension(extension);
    std::error_code ignored;
    if (header != path && fs::is_regular_file(header, ignored)) return header;
  }
  return {};
}

/// The target of a broken link, or else a file in the same folder with a similar name.
std::string advice_on_missing(const fs::path& path) {
  std::error_code no_link;
  if (const fs::path target = fs::read_symlink(path, no_link); !no_link)
    return "it is a link to " + target.string();
  constexpr std::size_t kMostFiles = 10'000;
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error);
       !error && entry != fs::directory_iterator() && names.size() < kMostFiles;
       entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::ranges::sort(names);
  const std::string nearest = nearest_name(path.filename().string(), names);
  return nearest.empty() ? "" : "did you mean " + (path.parent_path() / nearest).string() + "?";
}

/// Advice for a file that was given as a volume.
std::string advice_on_volume(FileKind kind, const fs::path& path, bool is_of_check) {
  switch (kind) {
    case FileKind::mesh:
      return is_of_check
                 ? "it is a mesh: expected a volume after --volume, and the mesh without an option"
                 : "it is a mesh: isoatlas check analyses it, isoatlas picture draws it";
    case FileKind::levels:
      return "it holds levels of detail: isoatlas levels compares them, isoatlas report shows them";
    case FileKind::json:
      return "isoatlas levels and isoatlas report read reports of isoatlas extract";
    case FileKind::page:
      return "it is a page: open it in a browser";
    case FileKind::unknown: {
      if (!has_contents(path)) return "";
      const fs::path header = header_of(path);
      return header.empty() ? "for a headerless file, use --raw-size and --raw-type"
                            : "its header seems to be " + header.string();
    }
    default:
      return "";
  }
}

/// Advice for a file that was given as a mesh or a result.
std::string advice_on_mesh(std::string_view command, FileKind kind, const fs::path& path) {
  const bool takes_levels = command != "check",
             takes_json = command == "levels" || command == "report";
  switch (kind) {
    case FileKind::volume:
      return command == "check" ? "it is a volume: isoatlas extract meshes it; to measure the "
                                  "distance of a mesh from it, use --volume"
                                : "it is a volume: isoatlas extract meshes it";
    case FileKind::folder:
      return "isoatlas extract and isoatlas info read folders of slices";
    case FileKind::mesh:
      return command == "levels" ? "it is a single mesh: isoatlas check analyses it" : "";
    case FileKind::levels:
      return takes_levels ? "" : "isoatlas levels reads it";
    case FileKind::json:
      return takes_json ? ""
                        : "isoatlas levels and isoatlas report read reports of isoatlas extract";
    case FileKind::page:
      return "it is a page: open it in a browser";
    case FileKind::unknown:
      return takes_json && has_contents(path) ? "the name of a report ends in .json" : "";
    default:
      return "";
  }
}

}  // namespace

FileKind kind_of_name(const fs::path& path) {
  if (is_hierarchy_path(path)) return FileKind::levels;
  if (has_extension(path, io::mesh_extensions())) return FileKind::mesh;
  if (has_extension(path, ".json")) return FileKind::json;
  if (has_extension(path, ".html .htm")) return FileKind::page;
  if (has_extension(path, kPictures)) return FileKind::picture;
  return has_extension(path, io::volume_extensions()) ? FileKind::volume : FileKind::unknown;
}

FileKind kind_of_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return FileKind::folder;
  const FileKind kind = kind_of_name(path);
  if (kind == FileKind::mesh || kind == FileKind::levels || !fs::is_regular_file(path, ignored))
    return kind;
  if (is_volume(path)) return FileKind::volume;
  return kind == FileKind::volume ? FileKind::unknown : kind;
}

std::string advice_for_file(std::string_view command, const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return advice_on_missing(path);
  const bool is_of_check = command == "check --volume";
  const FileKind kind = kind_of_file(path);
  if (command == "view" && kind == FileKind::mesh)
    return "it is a mesh: isoatlas report makes a page that shows it";
  if (command == "extract" || command == "info" || command == "view" || is_of_check)
    return advice_on_volume(kind, path, is_of_check);
  return advice_on_mesh(command, kind, path);
}

void require_page_name(const fs::path& path) {
  if (path == "-")
    throw Error(
        ErrorCode::bad_argument,
        "isoatlas report does not write to standard output, expected a name ending in .html");
  if (kind_of_name(path) != FileKind::page)
    throw Error(
        ErrorCode::bad_argument,
        path.string() + ": not the name of a page, expected a name ending in .html or .htm");
}

void require_report_name(const fs::path& path) {
  if (kind_of_name(path) == FileKind::page)
    throw Error(ErrorCode::bad_argument,
                path.string() +
                    ": a report is JSON, expected a name ending in .json; --html writes a page");
}

std::string name_without_extensions(const fs::path& path) {
  const std::string name = path.filename().string();
  const std::size_t dot = name.find('.', 1);
  return name.substr(0, dot);
}

}  // namespace isoatlas::detail::tool
