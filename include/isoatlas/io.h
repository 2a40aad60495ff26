// SPDX-License-Identifier: Apache-2.0
// Files in and out. Needs the isoatlas-io library (ITK and VTK); the core library does not.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// How to read a headerless file. Samples run x fastest.
struct RawLayout {
  std::array<std::size_t, 3> size{};
  SampleType type = SampleType::uint8;
  std::array<double, 3> spacing{1, 1, 1};
  bool big_endian = false;
};

/// Reads a 3-D scalar volume in its native sample type, with spacing, origin and direction in LPS as ITK gives them.
/// NRRD/NHDR, NIfTI, MetaImage, TIFF stack, legacy VTK by extension; .vti; a folder is read as a DICOM series;
/// anything with `raw` set is read as headerless samples.
///
/// @throws Error(bad_file)     missing, truncated, header that promises more than there is, sizes that overflow
/// @throws Error(unsupported)  vector, complex or 2-D image, one sample along an axis, unknown extension
Volume read_volume(const std::filesystem::path& path, const std::optional<RawLayout>& raw = std::nullopt);

/// What a mesh file says about itself besides the triangles.
struct MeshFileInfo {
  std::string space;    ///< "LPS", "RAS" or "voxel"; written into the header or comment where the format has one
  std::string comment;  ///< e.g. "isoatlas 0.1.0"
};

/// Throws Error(unsupported) if no writer knows the extension, Error(bad_file) if the folder cannot be written:
/// call it before the work, so that nobody waits for nothing.
void check_mesh_path(const std::filesystem::path& path);

/// Writes .ply (binary little endian), .stl (binary), .obj, .off or .vtp by extension. The file appears whole or not at all:
/// it is written beside its destination and renamed. Throws Error(bad_file).
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path, const MeshFileInfo& info = {});

/// Reads what write_mesh writes (and ascii variants); polygons are split into triangle fans, STL corners at equal positions merged.
TriangleMesh read_mesh(const std::filesystem::path& path);

/// The space that a mesh file says its coordinates are in, as MeshFileInfo has it; empty if it says nothing. Throws Error(bad_file).
std::string mesh_space(const std::filesystem::path& path);

/// Writes text whole or not at all (beside, then rename). Throws Error(bad_file).
void write_text_file(const std::string& text, const std::filesystem::path& path);

}  // namespace isoatlas
