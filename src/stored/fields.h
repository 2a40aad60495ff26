// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "isoatlas/blocks.h"
#include "isoatlas/extract.h"
#include "isoatlas/mesh_file.h"
#include "isoatlas/volume_source.h"
#include "report/report.h"

namespace isoatlas::detail {

// The fields of a type, in the order of their declaration. A structured binding must name all
// fields, so a new field does not compile before it is stored.
#define ISOATLAS_FIELDS(Type, ...) \
  inline auto fields(Type& it) {   \
    auto& [__VA_ARGS__] = it;      \
    return std::tie(__VA_ARGS__);  \
  }

ISOATLAS_FIELDS(Hierarchy::Level, vertex_count, triangles, own_positions, distance, cap_triangles)
ISOATLAS_FIELDS(Hierarchy, positions, parent, levels, float32_origin)
ISOATLAS_FIELDS(MeshFileInfo, space, comment, unit, cap_triangles)
ISOATLAS_FIELDS(HierarchyFileInfo, mesh, placement, levels)

ISOATLAS_FIELDS(TopologySummary::Kind, genus, boundary_loops, count)
ISOATLAS_FIELDS(TopologySummary, components, euler_characteristic, genus, boundary_loops, kinds)
ISOATLAS_FIELDS(CertificateReport, passed, cells_checked, arcs_checked, triples_checked,
                repair_rounds, repair_sites)
ISOATLAS_FIELDS(MeshQuality, triangles, aspect_min, aspect_p01, aspect_median,
                aspect_share_below_third, aspect_histogram, angle_min, angle_max, angles_above_150,
                dihedral_min, dihedral_max, edge_min, edge_max, zero_area_triangles)
ISOATLAS_FIELDS(MetricSummary, maximum, mean)
ISOATLAS_FIELDS(ConstraintResult, constraint, reached, satisfied, reason)
ISOATLAS_FIELDS(CellAtLimit, position, excess)
ISOATLAS_FIELDS(BadTriangle, position, aspect_ratio, largest_angle, obstacle)
ISOATLAS_FIELDS(OneSidedDistance, samples, samples_per_voxel_face, maximum, mean, root_mean_square,
                p50, p99, farthest)
ISOATLAS_FIELDS(Measurement, voxel, mesh_to_surface, surface_to_mesh, normal_mean, normal_p99,
                normal_maximum, surface_area, mesh_area)
ISOATLAS_FIELDS(ComponentTopology, euler_characteristic, boundary_loops)
ISOATLAS_FIELDS(BoundingBox, low, high)
ISOATLAS_FIELDS(ComponentExtent, component, triangles, bounds, area, volume, topology)
ISOATLAS_FIELDS(MeshExtent, bounds, area, volume, components, open_components, largest)
ISOATLAS_FIELDS(CapSummary, triangles, area)
ISOATLAS_FIELDS(LevelReport, vertices, triangles, topology, certificate, caps, inverted_components,
                quality, extent, metrics, constraints, distance_at_most, at_limit, refine_rounds,
                flips, moves, displacements, bad_triangles, self_intersections,
                self_intersection_positions, sites_for_intersections, measured, rounding, seconds)
ISOATLAS_FIELDS(RankedComponent, position, part, size, c_vertices, topology)
ISOATLAS_FIELDS(StageTime, stage, seconds)
ISOATLAS_FIELDS(BlockSummary, block_size, counts, with_surface, seam_vertices, seam_edges,
                removed_vertices)
ISOATLAS_FIELDS(ExtractReport, c_vertices, faces, double_segments, tunnels, coarser_c_vertices,
                reference, kept, dropped, subdivided_c_vertices, added_c_vertices,
                max_subdivision_depth, coarsening, blocks, levels, seconds, total_seconds)
ISOATLAS_FIELDS(BlockMesh, block, hierarchy, report)

ISOATLAS_FIELDS(SurfaceOptions, isovalue, inside, non_finite, topology, interpolation)
ISOATLAS_FIELDS(ComponentChoice, min_size, keep_largest, keep_near, drop_near)
ISOATLAS_FIELDS(Length, value, in_voxels)
ISOATLAS_FIELDS(CoveringChoice, strategy, max_radius, event_persistence)
ISOATLAS_FIELDS(ExtractOptions, surface, supersample, adaptive_supersample, vertices_on_surface,
                components, border, covering, coarse, refine, levels, placement,
                allow_self_intersections, space, measure_samples)

ISOATLAS_FIELDS(Grid, size, spacing, origin, direction, unit)
ISOATLAS_FIELDS(FileChoice, name, entries, selected)
ISOATLAS_FIELDS(ReadDecision, key, value)
ISOATLAS_FIELDS(VolumeSource, format, reader, decisions, warnings, choices, has_spacing,
                origin_in_samples)
ISOATLAS_FIELDS(VolumeReport, path, source, sample_digest, grid, sample_type)

/// Without metrics that are functions of C++.
inline auto fields(Constraint& it) {
  auto& [quantity, bound, is_default, in_voxels, custom] = it;
  return std::tie(quantity, bound, is_default, in_voxels);
}

/// Without what was written.
inline auto fields(ReportContext& it) {
  auto& [volume, command, files, neuroglancer, options, threads, read_seconds, write_seconds,
         peak_memory] = it;
  return std::tie(volume, command, options, threads, read_seconds, write_seconds, peak_memory);
}

}  // namespace isoatlas::detail
