// SPDX-License-Identifier: Apache-2.0
// Checks that a written file holds the mesh that was to be written. Done for every file with
// rounded positions, before it gets its name.
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

/// The position of a vertex as a file of floats stores it.
/// @throws Error(bad_file) if it is out of the range of float
Float3 rounded(const Vec3& position, std::size_t vertex, const std::filesystem::path& path);

/// All positions rounded to float relative to `translation`, as doubles.
std::vector<Vec3> all_rounded(const std::vector<Vec3>& positions, const Vec3& translation,
                              const std::filesystem::path& path);

/// The largest distance between a position and its rounded position in a file of floats relative to
/// `translation`.
double largest_rounding(const std::vector<Vec3>& positions, const Vec3& translation,
                        const std::filesystem::path& path);

/// Checks that the rounding found in a file is at most the rounding stated before it was written.
/// @throws Error(internal) if it is larger
void require_rounding_within(double expected, double found, const std::filesystem::path& path);

/// Compares a mesh with the mesh that a reader of its own found in the written file.
///
/// Triangles and topology must be identical, and different positions must not have become equal.
/// With `renumbered` (formats without indices: equal positions are one vertex), triangles must be
/// identical up to a one-to-one renumbering of the vertices in use.
/// @param what  for messages: "" or the part of the file, e.g. "level 2"
/// @return the largest distance of a vertex from its original position
/// @throws Error(bad_file) if rounding merged vertices or moved some by more than a tenth of the
/// mean edge, Error(internal) if anything else differs
double require_same_mesh(const TriangleMesh& written, const TriangleMesh& read, bool renumbered,
                         const std::filesystem::path& path, std::string_view what = {});

}  // namespace isoatlas::detail::io
