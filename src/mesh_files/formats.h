// SPDX-License-Identifier: Apache-2.0
// The readers and writers of read_mesh and write_mesh; formats.cpp selects one by extension.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "isoatlas/mesh_file.h"

namespace isoatlas::detail::io {

/// The extensions of mesh files, with dots, separated by blanks.
std::string mesh_extensions();

// Readers. Their result may have vertex indices out of range: read_mesh checks the meshes of all
// formats.
TriangleMesh read_ply(const std::filesystem::path& path);
TriangleMesh read_stl(const std::filesystem::path& path);
TriangleMesh read_obj(const std::filesystem::path& path);
TriangleMesh read_off(const std::filesystem::path& path);
TriangleMesh read_vtp(const std::filesystem::path& path);
/// Also returns the text fields by name, and the distance of every vertex that the file states
/// (Hierarchy::Level::distance).
/// @throws Error(bad_file) if an array that the mesh needs is missing, damaged or longer than the
/// file can hold
TriangleMesh read_vtp(const std::filesystem::path& path, std::map<std::string, std::string>& fields,
                      std::vector<float>& distance);

TriangleMesh read_3mf(const std::filesystem::path& path);
TriangleMesh read_gii(const std::filesystem::path& path);

// Facts that a file states in addition to the triangles.
/// .ply, .stl, .obj, .off: reads SPACE=... and UNIT=... near the beginning.
MeshFileInfo info_in_text(const std::filesystem::path& path);
MeshFileInfo info_in_vtp(const std::filesystem::path& path);
MeshFileInfo info_in_3mf(const std::filesystem::path& path);
MeshFileInfo info_in_gii(const std::filesystem::path& path);

// Writers. The mesh has finite positions and indices in range; `info` has no control characters.
// The bytes depend on the arguments only. The caller commits the file.
void write_ply(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_stl(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_obj(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_off(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_3mf(const TriangleMesh& mesh, const MeshFileInfo& info,
               AtomicFile& file);  ///< the result of form_in_3mf()
void write_gii(const TriangleMesh& mesh, const MeshFileInfo& info,
               AtomicFile& file);                     ///< the result of form_in_gifti()
constexpr const char* kVtpDistance = "max_distance";  ///< the array of distances in .vtp
/// Writes text fields by name, except empty ones, and the distances of the vertices, if there are
/// any.
void write_vtp(const TriangleMesh& mesh, const std::map<std::string, std::string>& fields,
               const std::vector<float>& distance, std::size_t cap_triangles, AtomicFile& file);

// Writers of levels. The levels are checked like meshes; `info.levels` is empty or has a JSON
// object for each level.
StoredPositions write_glb(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const std::filesystem::path& path);
std::vector<Vec3> positions_in_glb(const Hierarchy& hierarchy, std::size_t level,
                                   const std::filesystem::path& path);
double rounding_in_glb(const Hierarchy& hierarchy, const std::filesystem::path& path);
StoredPositions write_vtm(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const std::filesystem::path& path);

/// Levels as a file stores them, from coarse to fine, each with its own positions.
struct StoredLevels {
  std::vector<TriangleMesh> meshes;
  std::vector<std::vector<float>> distances;  ///< per level; empty if the file has none
  HierarchyFileInfo info;
};
StoredLevels read_glb(const std::filesystem::path& path);
/// Reads from a file's contents; `path` is for messages.
StoredLevels read_glb(std::string contents, const std::filesystem::path& path);
StoredLevels read_vtm(const std::filesystem::path& path);

/// The path of a level of a .vtm: a .vtp file in a folder next to it.
std::filesystem::path vtm_piece(const std::filesystem::path& path, std::size_t level);

}  // namespace isoatlas::detail::io
