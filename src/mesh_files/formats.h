// SPDX-License-Identifier: Apache-2.0
// The readers and writers behind read_mesh and write_mesh; formats.cpp picks one by extension.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "isoatlas/mesh_file.h"

namespace isoatlas::detail::io {

/// The extensions of mesh files, with dots, between blanks.
std::string mesh_extensions();

// Meshes in. What comes out may still have indices out of range: read_mesh checks all formats
// alike.
TriangleMesh read_ply(const std::filesystem::path& path);
TriangleMesh read_stl(const std::filesystem::path& path);
TriangleMesh read_obj(const std::filesystem::path& path);
TriangleMesh read_off(const std::filesystem::path& path);
TriangleMesh read_vtp(const std::filesystem::path& path);
/// With its text fields by name, and what it says of every vertex's distance
/// (Hierarchy::Level::distance).
/// @throws Error(bad_file) if an array that the mesh needs is missing, damaged or longer than the
/// file can hold
TriangleMesh read_vtp(const std::filesystem::path& path, std::map<std::string, std::string>& fields,
                      std::vector<float>& distance);

TriangleMesh read_3mf(const std::filesystem::path& path);
TriangleMesh read_gii(const std::filesystem::path& path);

// What such a file says besides the triangles.
MeshFileInfo info_in_text(
    const std::filesystem::path& path);  ///< .ply, .stl, .obj, .off: SPACE=... near the beginning
MeshFileInfo info_in_vtp(const std::filesystem::path& path);
MeshFileInfo info_in_3mf(const std::filesystem::path& path);
MeshFileInfo info_in_gii(const std::filesystem::path& path);

// Meshes out. The mesh has finite positions and indices in range; `info` is free of control
// characters. The bytes depend on the arguments only. The caller commits the file.
void write_ply(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_stl(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_obj(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_off(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_3mf(const TriangleMesh& mesh, const MeshFileInfo& info,
               AtomicFile& file);  ///< of form_in_3mf()
void write_gii(const TriangleMesh& mesh, const MeshFileInfo& info,
               AtomicFile& file);                     ///< of form_in_gifti()
constexpr const char* kVtpDistance = "max_distance";  ///< the array of distances in .vtp
/// With text fields by name, empty ones are left out, and distances of the vertices or none.
void write_vtp(const TriangleMesh& mesh, const std::map<std::string, std::string>& fields,
               const std::vector<float>& distance, AtomicFile& file);

// Levels out: checked like meshes; `info.levels` is empty or has a JSON object for each level.
StoredPositions write_glb(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const std::filesystem::path& path);
std::vector<Vec3> positions_in_glb(const Hierarchy& hierarchy, std::size_t level,
                                   const std::filesystem::path& path);
double rounding_in_glb(const Hierarchy& hierarchy, const std::filesystem::path& path);
StoredPositions write_vtm(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const std::filesystem::path& path);

/// Levels as a file keeps them, coarse to fine, each with its own positions.
struct StoredLevels {
  std::vector<TriangleMesh> meshes;
  std::vector<std::vector<float>> distances;  ///< of each level, empty where the file has none
  HierarchyFileInfo info;
};
StoredLevels read_glb(const std::filesystem::path& path);
/// The same from a file's contents; `path` is for messages.
StoredLevels read_glb(std::string contents, const std::filesystem::path& path);
StoredLevels read_vtm(const std::filesystem::path& path);

/// Where the pieces of a .vtm are: one .vtp for each level, in a folder beside it.
std::filesystem::path vtm_piece(const std::filesystem::path& path, std::size_t level);

}  // namespace isoatlas::detail::io
