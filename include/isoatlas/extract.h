// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// Which samples are inside. A sample equal to the isovalue is inside either way:
/// above: value >= isovalue; below: value <= isovalue (the same as negating volume and isovalue).
enum class Inside { above, below };

/// What to do with NaN and infinite samples. `below` and `above` put NaN on that side of the isovalue; infinities then
/// keep the side their sign says.
enum class NonFinite { refuse, below, above };

/// Coordinates of the mesh. lps: the volume's world as ITK gives it; ras: the same with x and y negated;
/// voxel: sample-index coordinates, sample (0,0,0) at the origin.
enum class Space { lps, ras, voxel };

struct ExtractOptions {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
  Space space = Space::lps;
  /// Largest disk radius R_g of the paper's stage one, world units; none: half the longest side of the volume.
  std::optional<double> max_radius;
  /// Topological events that close again within this length do not limit a disk, world units; none: 1.5 voxels.
  std::optional<double> event_persistence;
  /// false puts c-vertices at the plain average of their nodes, as the paper has it (up to 0.2 voxel off the surface).
  bool vertices_on_surface = true;
};

/// Topology of one whole surface.
struct TopologySummary {
  std::size_t components = 0;
  std::int64_t euler_characteristic = 0, genus = 0, boundary_loops = 0;
  struct Kind {
    std::int64_t genus = 0, boundary_loops = 0;
    std::size_t count = 0;
    friend bool operator==(const Kind&, const Kind&) = default;
  };
  std::vector<Kind> kinds;  ///< the multiset of (genus, loops), sorted by genus, then loops
  friend bool operator==(const TopologySummary&, const TopologySummary&) = default;
};

TopologySummary summarize(const std::vector<ComponentTopology>& components);

/// What the certificate looked at, and what it took to pass (docs/theory/02-certificate.md).
struct CertificateReport {
  bool passed = false;
  std::size_t cells_checked = 0;    ///< every one a disk, with a triangle, meeting the boundary in at most one arc
  std::size_t arcs_checked = 0;     ///< pairs of adjacent cells, every pair meeting in exactly one arc
  std::size_t triples_checked = 0;  ///< triples of cells, every triple meeting in exactly one point
  std::size_t repair_rounds = 0;    ///< rounds of check-and-repair until it passed
  std::size_t repair_sites = 0;     ///< sites added by repair
};

struct StageTime {
  std::string stage;
  double seconds = 0;
};

struct ExtractReport {
  std::size_t c_vertices = 0;  ///< of the reference surface complex
  std::size_t faces = 0;
  std::size_t double_segments = 0;              ///< places split so that the dual of G is simplicial
  std::vector<std::size_t> coarser_c_vertices;  ///< sizes of the certified coarser complexes
  TopologySummary reference;                    ///< counted on the reference surface complex
  TopologySummary mesh;                         ///< counted on the finished triangles, independently
  CertificateReport coarsening;                 ///< certificate of the partition into blocks; repair_rounds are the rounds of check and cut
  CertificateReport certificate;                ///< certificate of the final partition
  std::size_t turned_components = 0;  ///< components that still do not face outward on the whole, see docs/theory/02-certificate.md
  MeshQuality quality;                ///< measured in world units, whatever the mesh's space
  std::vector<StageTime> seconds;     ///< in order: surface, components, coarsen, cover, certify, mesh, check
  double total_seconds = 0;           ///< volume in memory to checked mesh
};

struct Extraction {
  TriangleMesh mesh;
  ExtractReport report;
};

/// Meshes the isosurface of a volume: coarse, adaptive, with the topology of the reference surface, checked.
///
/// @throws Error(bad_argument)  size < 2 along an axis, spacing not positive or different by more than 1e6 between axes, origin or
///                              direction not finite, direction singular, isovalue not finite, max_radius <= 0, event_persistence < 0
/// @throws Error(unsupported)   NaN or infinity while non_finite is `refuse` (message: count and first index)
/// @throws Error(empty_surface) no sample, or every sample, is inside (message: the range)
/// @throws Error(internal)      the finished mesh failed its own check: a bug; no mesh is returned
/// @throws Error(cancelled)     control.cancel was set
/// @post   same input, same bytes, for any number of threads
/// @cost   one pass over the volume, then O(C log C) for C c-vertices
/// @source Gavriliu, Carranza, Breen, Barr, IEEE Visualization 2001, sections 3.2, 3.3 and 3.6, with the departures in docs/theory/
Extraction extract(const VolumeView& volume, const ExtractOptions& options, const RunControl& control = {});

/// Moves a mesh from sample-index coordinates into another space, turning triangles over where the map mirrors.
void transform_to(TriangleMesh& mesh, const Grid& grid, Space space);

}  // namespace isoatlas
