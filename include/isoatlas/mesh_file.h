// SPDX-License-Identifier: Apache-2.0
// Meshes from and to files. Needs the isoatlas-io library; the core library does not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"

namespace isoatlas {

/// What a mesh file says about itself besides the triangles.
struct MeshFileInfo {
  std::string space;    ///< "LPS", "RAS" or "voxel"; written into the header or comment where the
                        ///< format has one
  std::string comment;  ///< e.g. "isoatlas 0.1.0"
  LengthUnit unit = LengthUnit::unknown;  ///< of the coordinates; unknown for sample indices. Only
                                          ///< .3mf and .gii keep it
};

/// Throws Error(unsupported) if no writer knows the extension, Error(bad_file) if the folder cannot
/// be written: call it before the work, so that nobody waits for nothing.
ISOATLAS_API void check_mesh_path(const std::filesystem::path& path);

/// What a file makes of the positions it was given. Where it keeps them as float32, this was found
/// by reading the written bytes back.
struct StoredPositions {
  bool single_precision = false;
  double largest_rounding =
      0;  ///< largest distance between a given and a stored position, in the given mesh's units
  std::string space = {};                 ///< of the stored coordinates
  LengthUnit unit = LengthUnit::unknown;  ///< of the stored coordinates
  std::vector<std::string> notes =
      {};  ///< for people: what the format changed or had to state; one line each
};

/// Writes .ply (binary little endian), .stl (binary), .obj, .off, .vtp, .3mf or .gii by extension.
/// The file appears whole or not at all: it is written beside its destination and renamed. What is
/// rounded (.stl, .gii) is read back before that and must be the same mesh: the same triangles, no
/// two vertices at one position, the same topology, no vertex moved by more than a tenth of the
/// mean edge. (A device or a pipe is written directly and cannot be read back.)
///
/// A .3mf states a unit: lengths below micrometres become micrometres; without a unit it says
/// millimetres, unchanged. A .gii is always in RAS and, if the unit is known, in millimetres: space
/// "LPS" is converted; any space but "LPS" and "RAS" is stored as it is, marked as unknown.
/// StoredPositions::notes says what was done. Throws Error(bad_file).
ISOATLAS_API StoredPositions write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path,
                                        const MeshFileInfo& info = {});

/// The largest distance by which write_mesh rounds a position, in the mesh's units, known before it
/// writes; 0 where all digits are kept. Throws Error(bad_file) where a position is out of the range
/// of float32.
ISOATLAS_API double rounding_of_mesh_file(const TriangleMesh& mesh,
                                          const std::filesystem::path& path,
                                          const MeshFileInfo& info = {});

/// The mesh's positions as write_mesh stores them, in the file's space and unit. Throws as
/// rounding_of_mesh_file.
ISOATLAS_API std::vector<Vec3> stored_positions(const TriangleMesh& mesh,
                                                const std::filesystem::path& path,
                                                const MeshFileInfo& info = {});

/// Reads what write_mesh writes (and ascii variants); polygons are split into triangle fans, STL
/// corners at equal positions merged. Coordinates are those of the file: mesh_file_info() says in
/// which space and unit.
ISOATLAS_API TriangleMesh read_mesh(const std::filesystem::path& path);

/// What a mesh file says besides its triangles; empty where it says nothing. A .gii that says
/// nothing is in RAS and millimetres, a .3mf in millimetres. Throws Error(bad_file),
/// Error(unsupported).
ISOATLAS_API MeshFileInfo mesh_file_info(const std::filesystem::path& path);

/// Its space alone.
ISOATLAS_API std::string mesh_space(const std::filesystem::path& path);

/// Positions in one unit become positions in another. Nothing changes if either is unknown.
ISOATLAS_API void convert_unit(TriangleMesh& mesh, LengthUnit from, LengthUnit to);

/// What a file of levels says besides their triangles.
struct HierarchyFileInfo {
  MeshFileInfo mesh;
  Placement placement =
      Placement::surface;  ///< balanced: a vertex may be at another place in each level
  std::vector<std::string>
      levels;  ///< for each level a JSON object with what is known of it; or empty
};

/// Can the file hold several levels (.glb, .vtm)?
ISOATLAS_API bool is_hierarchy_path(const std::filesystem::path& path);

/// The files that writing levels [0, level_count) to `path` makes: `path`, and for .vtm a .vtp for
/// each level in a folder beside it.
ISOATLAS_API std::vector<std::filesystem::path> files_of_hierarchy(
    const std::filesystem::path& path, std::size_t level_count);

/// As check_mesh_path, for write_hierarchy: the folder of a .vtm, if it is there, must be one that
/// can be written.
ISOATLAS_API void check_hierarchy_path(const std::filesystem::path& path, std::size_t level_count);

/// Writes all levels, coarse to fine, to a .glb (glTF 2.0 with the extension MSFT_lod) or a .vtm (a
/// VTK multi-block file and a folder of .vtp files, double precision); docs/reference/files.md
/// tells how. Files appear whole; of a .vtm the .vtp files come first.
///
/// A .glb keeps positions as float32, relative to a translation where coordinates are large. Before
/// it appears it is read back by another reader, and each level must be the same mesh: the same
/// triangles, no two vertices that had different positions at one position, the same topology, no
/// vertex moved by more than a tenth of the mean edge.
/// @throws Error(bad_file)      cannot be written, or float32 would merge or move vertices (nothing
/// is written then)
/// @throws Error(bad_argument)  positions not finite, corners out of range, no levels, a text in
/// info.levels that is no JSON object
/// @throws Error(unsupported)   unknown extension; more than 4 GiB in a .glb
/// @cost   O(vertices + triangles) for each level, some three times the size of the file in memory
/// for a .glb
ISOATLAS_API StoredPositions write_hierarchy(const Hierarchy& hierarchy,
                                             const std::filesystem::path& path,
                                             const HierarchyFileInfo& info = {});

/// As rounding_of_mesh_file, of all levels.
ISOATLAS_API double rounding_of_hierarchy_file(const Hierarchy& hierarchy,
                                               const std::filesystem::path& path);

/// As stored_positions, of one level; in a .glb without its translation.
ISOATLAS_API std::vector<Vec3> stored_positions(const Hierarchy& hierarchy, std::size_t level,
                                                const std::filesystem::path& path);

struct HierarchyFile {
  /// `parent` is empty: files do not keep it. A level whose vertices are not bit by bit the first
  /// ones of the finest level has its own in `own_positions`; in a file with Placement::surface
  /// that is a fault of the file.
  Hierarchy hierarchy;
  HierarchyFileInfo info;
};

/// Reads what write_hierarchy writes. Throws Error(bad_file), Error(unsupported).
ISOATLAS_API HierarchyFile read_hierarchy(const std::filesystem::path& path);

/// The same of any file with meshes: levels of detail, or one mesh, as read_mesh reads it, as the
/// only level.
ISOATLAS_API HierarchyFile read_levels(const std::filesystem::path& path);

}  // namespace isoatlas
