// SPDX-License-Identifier: Apache-2.0
// Makes one HTML file that shows meshes, their levels and the facts about them. It loads nothing
// from a network. docs/report.md documents its contents.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isoatlas/hierarchy.h"
#include "isoatlas/mesh.h"
#include "isoatlas/mesh_file.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// One result on a page: the levels of a mesh and the facts about them.
struct PageEntry {
  Hierarchy hierarchy;
  /// A JSON object: a result of the schema "isoatlas-page-2" without its geometry.
  std::string facts;
  /// The files that it was read from, including the volume. They may not exist any more.
  std::vector<std::filesystem::path> sources = {};
};

/// Makes an entry from a report and its levels.
/// @param report  JSON of the schema "isoatlas-report-3"
/// @param path  the file of the report, for messages
/// @param marching_cubes  triangle shapes of marching cubes on the same volume, for comparison;
///        absent: not compared
/// @throws Error(bad_file) if the text is not such a report, or is about other levels
PageEntry entry_of_report(const std::string& report, const std::string& path, Hierarchy hierarchy,
                          const std::optional<MeshQuality>& marching_cubes);

/// Makes an entry from levels and the facts that their file states. Facts that are missing, or that
/// do not agree with the triangles, are counted or omitted.
/// @param title  the heading on the page
PageEntry entry_of_levels(HierarchyFile file, const std::string& title);

/// Makes an entry from a file: levels (.glb, .vtm), one mesh (.ply, .stl, ...), or a report
/// (.json). A report names its mesh files and the volume; they are searched at these paths, then in
/// the folder of the report. Facts that are missing are counted (topology, shape) or omitted, and
/// so are facts that do not agree with the triangles.
/// @throws Error(bad_file), Error(unsupported)
PageEntry entry_of_file(const std::filesystem::path& path);

/// Triangle shapes of marching cubes on a volume. Absent if there are no triangles, or if
/// samples near the surface are not finite.
/// @param of  points on components, in sample-index coordinates: only the components of the
/// marching
///        cubes surface next to these points are measured; empty: all
std::optional<MeshQuality> marching_cubes_quality(const VolumeView& volume, double isovalue,
                                                  std::span<const Vec3> of = {});

/// Transforms positions from `space` to sample-index coordinates.
std::vector<Vec3> to_index(std::vector<Vec3> positions, const Grid& grid, Space space);

/// Throws Error(unsupported) if this isoatlas was built without pages (ISOATLAS_BUILD_PAGE).
void require_pages();

/// Makes the page. Positions are rounded to a grid. Every level is decoded again and must be the
/// same mesh: the same triangles and topology, no two vertices at one position, and no vertex moved
/// by more than a tenth of the mean edge length. Otherwise a finer grid is used.
/// @param path  the file of the page, for messages
/// @throws Error(bad_file) if a grid of 2^24 steps is too coarse
/// @throws Error(unsupported) as require_pages()
/// @post the same entries give the same bytes
/// @cost  O(V + T log T) per level and grid, with at most three grids
std::string page_html(std::span<const PageEntry> entries, const std::filesystem::path& path);

/// The page of `isoatlas view`, with its script and style inside. It contains no data: the script
/// fetches "volume" relative to the address of the page, and what the server offers from there.
/// @throws Error(unsupported) as require_pages()
std::string view_html();

}  // namespace isoatlas::detail
