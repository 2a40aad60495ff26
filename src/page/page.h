// SPDX-License-Identifier: Apache-2.0
// One HTML file that shows meshes with their levels and what is known of them, without a network.
// docs/report.md says what is in it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isoatlas/hierarchy.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// One result of a page.
struct PageEntry {
  Hierarchy hierarchy;
  std::string
      facts;  ///< a JSON object with what "isoatlas-page-1" says of a result, but for its geometry
  std::vector<std::filesystem::path> sources =
      {};  ///< the files that it was read from, the volume among them; some may not be there
};

/// From a report ("isoatlas-report-2") and the levels it is about.
/// @param marching_cubes  the shape of marching cubes' triangles on the same volume, to compare
/// with; none: not compared
/// @throws Error(bad_file) if it is no such report or is about other levels; `path` is for messages
PageEntry entry_of_report(const std::string& report, const std::string& path, Hierarchy hierarchy,
                          const std::optional<MeshQuality>& marching_cubes);

/// From a file: levels (.glb, .vtm), one mesh (.ply, .stl, ...), or a report (.json), which names
/// the files of its meshes and the volume. They are looked for where it says, then beside it. What
/// a file does not say is counted (topology, shape) or left out; so is what it says of a level
/// whose triangles are others.
/// @throws Error(bad_file), Error(unsupported)
PageEntry entry_of_file(const std::filesystem::path& path);

/// Shape of the triangles that marching cubes (VTK's) makes of a volume. None if there are none, or
/// samples near the surface are not finite.
/// @param of  points of components, sample-index coordinates: only the components of marching cubes
/// next to them count; none: all
std::optional<MeshQuality> marching_cubes_quality(const VolumeView& volume, double isovalue,
                                                  std::span<const Vec3> of = {});

/// Positions of a mesh in sample-index coordinates.
std::vector<Vec3> to_index(std::vector<Vec3> positions, const Grid& grid, Space space);

/// Throws Error(unsupported) if this isoatlas was built without pages (ISOATLAS_BUILD_PAGE).
void require_pages();

/// The page. Positions are rounded to a grid, and every level is decoded again and must be the same
/// mesh: the same triangles, the same topology, no two vertices at one position, none moved by more
/// than a tenth of the mean edge; else the grid is made finer.
/// @throws Error(bad_file) if a grid of 2^24 steps does not do; `path` is for messages
/// @throws Error(unsupported) as require_pages()
/// @post the same entries give the same bytes
/// @cost  O(vertices + triangles) for each level, for each of at most three grids
std::string page_html(std::span<const PageEntry> entries, const std::filesystem::path& path);

}  // namespace isoatlas::detail
