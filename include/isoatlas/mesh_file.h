// SPDX-License-Identifier: Apache-2.0
// Reads and writes meshes. Link CMake target isoatlas::io; the core library has no file formats.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"

namespace isoatlas {

/// The metadata of a mesh file.
struct MeshFileInfo {
  /// The space of the coordinates: "LPS", "RAS" or "voxel"; empty: unknown. It is written to the
  /// header or a comment, if the format has one.
  std::string space;
  std::string comment;  ///< the program that wrote the file, e.g. "isoatlas 0.1.0"
  /// The unit of the coordinates; unknown for sample indices. Only .3mf, .gii and .stl store it.
  LengthUnit unit = LengthUnit::unknown;
  /// The number of triangles at the end of the mesh that are caps on the volume boundary
  /// (Hierarchy::Level::cap_triangles). If it is not 0, .ply and .vtp mark them by a property "cap"
  /// of the faces, 1 for caps. It is not read back.
  std::size_t cap_triangles = 0;
};

/// Checks that write_mesh() can write to a path. Call it before a long computation.
/// @throws Error(unsupported) if no writer has the extension
/// @throws Error(bad_file) if the folder does not exist or is not writable
ISOATLAS_API void check_mesh_path(const std::filesystem::path& path);

/// How a file stores positions. For formats with float32, the values are computed from the written
/// file.
struct StoredPositions {
  bool single_precision = false;  ///< whether the file stores float32
  /// Largest distance between a position of the mesh and the stored one, in the mesh's units.
  double largest_rounding = 0;
  std::string space = {};                 ///< space of the stored coordinates
  LengthUnit unit = LengthUnit::unknown;  ///< unit of the stored coordinates
  /// What the format required to change or to add, for display; one line each.
  std::vector<std::string> notes = {};
};

/// Writes a mesh in the format of the extension: .ply (binary little endian), .stl (binary), .obj,
/// .off, .vtp, .3mf or .gii.
///
/// The file is written completely or not at all: a temporary file next to `path` is renamed when it
/// is complete. Formats that round positions (.stl, .gii) are read back first and must contain the
/// same mesh: the same triangles and topology, no two vertices at one position, and no vertex moved
/// by more than a tenth of the mean edge length. A device or a pipe is written directly and not
/// read back.
///
/// A .3mf file always states a unit: units below a micrometre are converted to micrometres, and if
/// `info.unit` is unknown, the file states millimetres with unchanged coordinates. An .stl file is
/// in millimetres if the unit is known, as programs for printing expect. A .gii file is
/// in RAS and in millimetres: space "LPS" is converted, and so is a known unit. Coordinates in a
/// space other than "LPS" and "RAS" are stored unchanged and marked as unknown.
/// StoredPositions::notes lists such changes.
/// @param info  the space and unit of the mesh, and the comment
/// @throws Error(unsupported) if no writer has the extension
/// @throws Error(bad_file) if the file cannot be written, or rounding would change the mesh
/// @cost   O(V + T); O(T log T) for formats that are read back
ISOATLAS_API StoredPositions write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path,
                                        const MeshFileInfo& info = {});

/// Computes the largest distance by which write_mesh() will round a position, without writing.
/// @return in the mesh's units; 0 for formats that keep all digits
/// @throws Error(unsupported) if no writer has the extension
/// @throws Error(bad_file) if a position is outside the range of float32
/// @cost   O(V)
ISOATLAS_API double rounding_of_mesh_file(const TriangleMesh& mesh,
                                          const std::filesystem::path& path,
                                          const MeshFileInfo& info = {});

/// Computes the positions that write_mesh() will store, V x 3, in the space and unit of the file.
/// @throws Error as rounding_of_mesh_file()
/// @cost   O(V)
ISOATLAS_API std::vector<Vec3> stored_positions(const TriangleMesh& mesh,
                                                const std::filesystem::path& path,
                                                const MeshFileInfo& info = {});

/// Reads a mesh in one of the formats of write_mesh(), including their ASCII variants. Polygons are
/// split into fans of triangles. Corners of an .stl file at equal positions become one vertex.
/// @return coordinates of the file; mesh_file_info() returns their space and unit
/// @throws Error(bad_file) if the file is missing or malformed
/// @throws Error(unsupported) if no reader has the extension, or the file has unsupported contents
ISOATLAS_API TriangleMesh read_mesh(const std::filesystem::path& path);

/// Reads the metadata of a mesh file. A member is empty or unknown if the file does not state it;
/// the defaults of a .gii file are RAS and millimetres, that of a .3mf file is millimetres.
/// @throws Error as read_mesh()
ISOATLAS_API MeshFileInfo mesh_file_info(const std::filesystem::path& path);

/// The `space` of mesh_file_info().
ISOATLAS_API std::string mesh_space(const std::filesystem::path& path);

/// Converts positions from one unit to another. Nothing changes if either is unknown. O(V)
ISOATLAS_API void convert_unit(TriangleMesh& mesh, LengthUnit from, LengthUnit to);

/// The metadata of a file with several levels.
struct HierarchyFileInfo {
  MeshFileInfo mesh;
  /// With `balanced`, a vertex can have different positions in different levels.
  Placement placement = Placement::surface;
  /// Per level, a JSON object with the facts about it; or empty.
  std::vector<std::string> levels;
};

/// True if the extension is that of a format for several levels: .glb or .vtm.
ISOATLAS_API bool is_hierarchy_path(const std::filesystem::path& path);

/// The paths of the files that write_hierarchy() creates for a number of levels: `path`, and for a
/// .vtm also one .vtp per level in a folder next to it.
ISOATLAS_API std::vector<std::filesystem::path> files_of_hierarchy(
    const std::filesystem::path& path, std::size_t level_count);

/// Checks that write_hierarchy() can write to a path. If the folder of a .vtm exists, it must be
/// writable.
/// @throws Error as check_mesh_path()
ISOATLAS_API void check_hierarchy_path(const std::filesystem::path& path, std::size_t level_count);

/// Writes all levels, coarse to fine, to a .glb file (glTF 2.0 with the extension MSFT_lod) or to a
/// .vtm file (a VTK multi-block file and a folder of .vtp files in double precision). The layouts
/// are in docs/reference/files.md. Each file is written completely or not at all; the .vtp files
/// are written before their .vtm.
///
/// A .glb file stores positions as float32, relative to a translation if coordinates are large.
/// Before it appears, an independent reader reads it back, and each level must be the same mesh:
/// the same triangles and topology, no two distinct vertices at one position, and no vertex moved
/// by more than a tenth of the mean edge length.
/// @throws Error(bad_file)  a file cannot be written, or float32 would change the mesh; no .glb is
///   written then
/// @throws Error(bad_argument)  no levels, a position that is not finite, a corner out of range, or
///   a text in `info.levels` that is not a JSON object
/// @throws Error(unsupported)  no writer has the extension, or a .glb would exceed 4 GiB
/// @cost   O(V + T log T) per level; for a .glb, memory of about three times the size of the file
ISOATLAS_API StoredPositions write_hierarchy(const Hierarchy& hierarchy,
                                             const std::filesystem::path& path,
                                             const HierarchyFileInfo& info = {});

/// Computes the largest distance by which write_hierarchy() will round a position of any level.
/// @return in the mesh's units; 0 for a .vtm
/// @throws Error as rounding_of_mesh_file()
/// @cost   O(V) per level
ISOATLAS_API double rounding_of_hierarchy_file(const Hierarchy& hierarchy,
                                               const std::filesystem::path& path);

/// Computes the positions of a level that write_hierarchy() will store, V x 3. For a .glb they do
/// not include its translation.
/// @throws Error as rounding_of_mesh_file()
/// @cost   O(V)
ISOATLAS_API std::vector<Vec3> stored_positions(const Hierarchy& hierarchy, std::size_t level,
                                                const std::filesystem::path& path);

/// The contents of a file with several levels.
struct HierarchyFile {
  /// `parent` is empty, because files do not store it. A level has `own_positions` unless its
  /// vertices are, bit by bit, a prefix of the vertices of the finest level. In a file with
  /// Placement::surface, `own_positions` means that the levels in the file are not nested.
  Hierarchy hierarchy;
  HierarchyFileInfo info;
};

/// Reads a file of write_hierarchy(), .glb or .vtm.
/// @throws Error(bad_file) if a file is missing or malformed
/// @throws Error(unsupported) if no reader has the extension, or the file has unsupported contents
ISOATLAS_API HierarchyFile read_hierarchy(const std::filesystem::path& path);

/// Reads any mesh file: all levels of a file that read_hierarchy() reads, or the mesh of a file
/// that read_mesh() reads as the only level.
/// @throws Error as read_hierarchy() and read_mesh()
ISOATLAS_API HierarchyFile read_levels(const std::filesystem::path& path);

}  // namespace isoatlas
