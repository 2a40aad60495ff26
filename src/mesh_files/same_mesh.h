// SPDX-License-Identifier: Apache-2.0
// Is what was written what was meant? Asked of every file that rounds positions, before it appears.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "isoatlas/mesh.h"
#include "isoatlas/mesh_file.h"

namespace isoatlas::detail::io {

using Float3 = std::array<float, 3>;

/// The position of a vertex as a file of floats has it.
/// @throws Error(bad_file) if it is out of their range
Float3 rounded(const Vec3& position, std::size_t vertex, const std::filesystem::path& path);

/// All of them, around `translation`, as doubles.
std::vector<Vec3> all_rounded(const std::vector<Vec3>& positions, const Vec3& translation,
                              const std::filesystem::path& path);

/// The largest distance of these positions from what a file of floats around `translation` has.
double largest_rounding(const std::vector<Vec3>& positions, const Vec3& translation,
                        const std::filesystem::path& path);

/// What was said of the rounding before a file was written is true of the file. @throws
/// Error(internal) if not
void require_rounding_within(double expected, double found, const std::filesystem::path& path);

/// Compares a mesh with what another reader made of the file it was written to.
///
/// Triangles must be identical, the topology counted on both the same, and vertices that had
/// different positions must not have become one. With `renumbered` (formats without indices: equal
/// positions are one vertex) triangles are identical up to a one-to-one renumbering of the vertices
/// in use.
/// @param what  "" or which part of the file this is, for messages: "level 2"
/// @return the largest distance of a vertex from where it was
/// @throws Error(bad_file) if rounding merged vertices or moved some by more than a tenth of the
/// mean edge, Error(internal) if anything else differs
double require_same_mesh(const TriangleMesh& written, const TriangleMesh& read, bool renumbered,
                         const std::filesystem::path& path, std::string_view what = {});

}  // namespace isoatlas::detail::io
