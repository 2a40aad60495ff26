// SPDX-License-Identifier: Apache-2.0
// The readers and writers behind read_volume, read_mesh and write_mesh; formats.cpp picks one by extension.
#pragma once

#include <filesystem>

#include "io/atomic_file.h"
#include "isoatlas/io.h"

namespace isoatlas::io {

// Volumes. `path` exists and is a readable, non-empty file (a folder for read_dicom).
Volume read_nrrd(const std::filesystem::path& path);
Volume read_nifti(const std::filesystem::path& path);
Volume read_meta_image(const std::filesystem::path& path);
Volume read_tiff(const std::filesystem::path& path);
Volume read_legacy_vtk(const std::filesystem::path& path);
Volume read_vti(const std::filesystem::path& path);
Volume read_dicom(const std::filesystem::path& folder);
Volume read_raw(const std::filesystem::path& path, const RawLayout& layout);

// Meshes in. What comes out may still have indices out of range: read_mesh checks all formats alike.
TriangleMesh read_ply(const std::filesystem::path& path);
TriangleMesh read_stl(const std::filesystem::path& path);
TriangleMesh read_obj(const std::filesystem::path& path);
TriangleMesh read_off(const std::filesystem::path& path);
TriangleMesh read_vtp(const std::filesystem::path& path);

// Meshes out. The mesh has finite positions and indices in range; `info` is free of control characters. The bytes
// depend on the arguments only. The caller commits the file.
void write_ply(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_stl(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_obj(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_off(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);
void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file);

}  // namespace isoatlas::io
