// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/file_name.h"
#include "files/file_error.h"
#include "mesh_files/same_mesh.h"
#include "mesh_files/stored_form.h"

namespace isoatlas {
using namespace detail;

namespace fs = std::filesystem;

namespace {

struct MeshFormat {
  std::string_view extension;
  TriangleMesh (*read)(const fs::path&);
  MeshFileInfo (*read_info)(const fs::path&);
  void (*write)(const TriangleMesh&, const MeshFileInfo&, io::AtomicFile&);
  bool is_single_precision = false;
  bool has_indices = true;
  io::StoredForm (*form)(const TriangleMesh&,
                         const MeshFileInfo&) = nullptr;  ///< null: coordinates are stored as given
};

constexpr std::array kMeshFormats{
    MeshFormat{".ply", io::read_ply, io::info_in_text, io::write_ply},
    MeshFormat{".stl", io::read_stl, io::info_in_text, io::write_stl, true, false, io::form_in_stl},
    MeshFormat{".obj", io::read_obj, io::info_in_text, io::write_obj},
    MeshFormat{".off", io::read_off, io::info_in_text, io::write_off},
    MeshFormat{".vtp", io::read_vtp, io::info_in_vtp, io::write_vtp},
    MeshFormat{".3mf", io::read_3mf, io::info_in_3mf, io::write_3mf, false, true, io::form_in_3mf},
    MeshFormat{".gii", io::read_gii, io::info_in_gii, io::write_gii, true, true, io::form_in_gifti},
};

// The format whose extension the file's name has, in upper or lower case; null if the extension is
// unknown.
template <class Formats>
auto find_format(const Formats& formats, const fs::path& path) -> decltype(formats.data()) {
  const auto found = std::ranges::find_if(
      formats, [&](const auto& format) { return has_extension(path, format.extension); });
  return found == formats.end() ? nullptr : &*found;
}

constexpr const char* kOrLevels = ", or .glb or .vtm for levels of detail";

// @param other_formats  further formats that the caller accepts, for the message
const MeshFormat& mesh_format(const fs::path& path, const std::string& other_formats) {
  const MeshFormat* format = find_format(kMeshFormats, path);
  if (format == nullptr) {
    const std::string found =
        is_hierarchy_path(path) ? "is a file of levels of detail" : "unknown mesh format";
    throw io::unsupported(path,
                          found + ", expected one of " + io::mesh_extensions() + other_formats);
  }
  return *format;
}

const MeshFormat& format_to_write(const fs::path& path) {
  return mesh_format(path, is_hierarchy_path(path) ? "" : kOrLevels);
}

enum class MeshFault { none, position_not_finite, corner_out_of_range };

struct MeshCheck {
  MeshFault fault = MeshFault::none;
  std::string text;
};

MeshCheck check_mesh(const TriangleMesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return {MeshFault::position_not_finite,
              "the position of vertex " + std::to_string(v) + " is not finite"};
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t corner : mesh.triangles[t]) {
      if (corner >= mesh.positions.size()) {
        return {MeshFault::corner_out_of_range,
                "triangle " + std::to_string(t) + " uses vertex " + std::to_string(corner) +
                    ", but there are only " + std::to_string(mesh.positions.size())};
      }
    }
  }
  return {};
}

}  // namespace

std::string io::mesh_extensions() {
  std::string list;
  for (const MeshFormat& format : kMeshFormats) {
    list += list.empty() ? "" : " ";
    list += format.extension;
  }
  return list;
}

void check_mesh_path(const fs::path& path) {
  format_to_write(path);
  const io::AtomicFile probe(path);  // creates its temporary file and removes it
}

namespace {

StoredPositions write_as_given(const MeshFormat& format, const TriangleMesh& mesh,
                               const MeshFileInfo& info, const fs::path& path) {
  io::AtomicFile file(path);
  format.write(mesh, info, file);
  StoredPositions stored{
      .single_precision = format.is_single_precision, .space = info.space, .unit = info.unit};
  if (format.is_single_precision && file.is_temporary()) {
    file.flush();
    stored.largest_rounding =
        io::require_same_mesh(mesh, format.read(file.written_path()), !format.has_indices, path);
    io::require_rounding_within(io::largest_rounding(mesh.positions, {}, path),
                                stored.largest_rounding, path);
  }
  file.commit();
  return stored;
}

}  // namespace

StoredPositions write_mesh(const TriangleMesh& mesh, const fs::path& path,
                           const MeshFileInfo& info) {
  const MeshFormat& format = format_to_write(path);
  if (const MeshCheck check = check_mesh(mesh); check.fault != MeshFault::none) {
    throw Error(ErrorCode::bad_argument,
                io::one_line(path.string() + ": not written: " + check.text));
  }
  // Comments must be one line: a line break would end the comment, and the next line would be read
  // as data.
  const MeshFileInfo clean_info{io::one_line(info.space), io::one_line(info.comment), info.unit,
                                info.cap_triangles};
  return io::translate_exceptions(path, [&] {
    if (format.form == nullptr) {
      return write_as_given(format, mesh, clean_info, path);
    }
    const io::StoredForm form = format.form(mesh, clean_info);
    StoredPositions stored = write_as_given(format, form.mesh, form.info, path);
    stored.largest_rounding =
        io::convert_length(stored.largest_rounding, form.info.unit, clean_info.unit);
    stored.notes = form.notes;
    return stored;
  });
}

double rounding_of_mesh_file(const TriangleMesh& mesh, const fs::path& path,
                             const MeshFileInfo& info) {
  const MeshFormat& format = format_to_write(path);
  if (!format.is_single_precision) {
    return 0;
  }
  if (format.form == nullptr) {
    return io::largest_rounding(mesh.positions, {}, path);
  }
  const io::StoredForm form = format.form(mesh, info);
  return io::convert_length(io::largest_rounding(form.mesh.positions, {}, path), form.info.unit,
                            info.unit);
}

std::vector<Vec3> stored_positions(const TriangleMesh& mesh, const fs::path& path,
                                   const MeshFileInfo& info) {
  const MeshFormat& format = format_to_write(path);
  std::vector<Vec3> positions =
      format.form == nullptr ? mesh.positions : format.form(mesh, info).mesh.positions;
  return format.is_single_precision ? io::all_rounded(positions, {}, path) : positions;
}

TriangleMesh read_mesh(const fs::path& path) {
  return io::translate_exceptions(path, [&] {
    io::readable_file_size(path);
    TriangleMesh mesh =
        mesh_format(path, is_hierarchy_path(path) ? "; isoatlas levels reads it" : "").read(path);
    if (mesh.triangles.empty()) {
      throw io::bad_file(path, "has no triangles");
    }
    if (const MeshCheck check = check_mesh(mesh); check.fault != MeshFault::none) {
      throw io::bad_file(path, check.text);
    }
    return mesh;
  });
}

MeshFileInfo mesh_file_info(const fs::path& path) {
  return io::translate_exceptions(path, [&] {
    io::readable_file_size(path);
    MeshFileInfo info =
        mesh_format(path, is_hierarchy_path(path) ? "; isoatlas levels reads it" : "")
            .read_info(path);
    return MeshFileInfo{io::one_line(info.space, 32), io::one_line(info.comment), info.unit};
  });
}

std::string mesh_space(const fs::path& path) { return mesh_file_info(path).space; }

HierarchyFile read_levels(const fs::path& path) {
  if (is_hierarchy_path(path)) {
    return read_hierarchy(path);
  }
  return io::translate_exceptions(path, [&] {
    io::readable_file_size(path);
    if (find_format(kMeshFormats, path) == nullptr) {
      throw io::unsupported(path,
                            "unknown format, expected one of " + io::mesh_extensions() + kOrLevels);
    }
    return HierarchyFile{hierarchy_of({read_mesh(path)}), {mesh_file_info(path), {}, {}}};
  });
}

}  // namespace isoatlas
