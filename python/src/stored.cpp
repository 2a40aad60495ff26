// SPDX-License-Identifier: Apache-2.0
#include "stored.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "isoatlas/error.h"
#include "isoatlas/version.h"

namespace isoatlas::detail::python {
namespace {

// The fields of a type, in the order of their declaration. A structured binding must name all
// fields, so a new field does not compile before it is stored.
#define ISOATLAS_FIELDS(Type, ...) \
  auto fields(Type& it) {          \
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
ISOATLAS_FIELDS(ExtractReport, c_vertices, faces, double_segments, tunnels, coarser_c_vertices,
                reference, kept, dropped, subdivided_c_vertices, added_c_vertices,
                max_subdivision_depth, coarsening, levels, seconds, total_seconds)

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
ISOATLAS_FIELDS(Levels::Extracted, report, context)
ISOATLAS_FIELDS(Levels, hierarchy, info, extracted)

#undef ISOATLAS_FIELDS

/// Without metrics that are functions of C++: Python cannot request them.
auto fields(Constraint& it) {
  auto& [quantity, bound, is_default, in_voxels, custom] = it;
  return std::tie(quantity, bound, is_default, in_voxels);
}

/// Without the list of written files, which is empty: save() makes it in a copy.
auto fields(ReportContext& it) {
  auto& [volume, command, files, options, threads, read_seconds, write_seconds, peak_memory] = it;
  return std::tie(volume, command, options, threads, read_seconds, write_seconds, peak_memory);
}

/// Types that are stored as their bytes. They have no padding.
template <class T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
template <>
struct IsPlain<Vec3> : std::true_type {};
template <>
struct IsPlain<Size3> : std::true_type {};
template <class T, std::size_t N>
struct IsPlain<std::array<T, N>> : IsPlain<T> {};

template <class T>
concept List = requires {
  typename T::allocator_type;
};
template <class T>
concept Optional = requires(T it) {
  it.has_value();
};
template <class T>
concept FixedSize = requires {
  std::tuple_size<T>::value;
};

template <class Archive, class T>
void transfer(Archive& archive, T& it) {
  if constexpr (IsPlain<T>::value) {
    archive.bytes(&it, sizeof it);
  } else if constexpr (List<T>) {
    archive.resize(it);
    if constexpr (IsPlain<typename T::value_type>::value)
      archive.bytes(it.data(), it.size() * sizeof *it.data());
    else
      for (auto& item : it) transfer(archive, item);
  } else if constexpr (Optional<T>) {
    bool has_value = it.has_value();
    transfer(archive, has_value);
    if (has_value && !it) it.emplace();
    if (has_value) transfer(archive, *it);
  } else if constexpr (FixedSize<T>) {
    for (auto& item : it) transfer(archive, item);
  } else {
    std::apply([&](auto&... field) { (transfer(archive, field), ...); }, fields(it));
  }
}

class Writer {
 public:
  void bytes(const void* from, std::size_t count) {
    out_.append(static_cast<const char*>(from), count);
  }
  template <class List>
  void resize(const List& list) {
    const std::size_t size = list.size();
    bytes(&size, sizeof size);
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  void bytes(void* to, std::size_t count) {
    require(count <= rest_.size());
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_.remove_prefix(count);
  }
  template <class List>
  void resize(List& list) {
    std::size_t size = 0;
    bytes(&size, sizeof size);
    require(size <= rest_.size());  // an item has at least one byte
    list.resize(size);
  }
  void require_end() const { require(rest_.empty()); }
  static void require(bool is_complete) {
    if (!is_complete)
      throw Error(ErrorCode::bad_argument, "the pickled data are incomplete or damaged");
  }

 private:
  std::string_view rest_;
};

constexpr std::string_view kVersion = ISOATLAS_VERSION;

template <class T>
std::string stored_bytes(const T& it) {
  Writer writer;
  std::string version(kVersion);
  transfer(writer, version);
  transfer(writer, const_cast<T&>(it));  // a Writer only reads
  return writer.take();
}

template <class T>
T from_bytes(std::string_view bytes) {
  Reader reader(bytes);
  std::string version;
  transfer(reader, version);
  if (version != kVersion)
    throw Error(ErrorCode::bad_argument,
                "the pickled data are from another version of isoatlas, expected " +
                    std::string(kVersion) + ": keep meshes in files, with mesh.save()");
  T it;
  transfer(reader, it);
  reader.require_end();
  return it;
}

/// Corners are indices into arrays that users read.
void require_corners_in_range(const Hierarchy& hierarchy) {
  for (const Hierarchy::Level& level : hierarchy.levels) {
    const std::size_t count =
        level.own_positions.empty() ? hierarchy.positions.size() : level.own_positions.size();
    Reader::require(level.vertex_count <= count);
    Reader::require(level.cap_triangles <= level.triangles.size());
    Reader::require(level.distance.empty() || level.distance.size() == level.vertex_count);
    for (const Triangle& triangle : level.triangles)
      Reader::require(std::ranges::max(triangle) < level.vertex_count);
  }
}

}  // namespace

std::string stored(const Levels& levels) { return stored_bytes(levels); }

std::string stored(const VolumeSource& source) { return stored_bytes(source); }

std::shared_ptr<Levels> levels_from(std::string_view bytes) {
  auto levels = std::make_shared<Levels>(from_bytes<Levels>(bytes));
  require_corners_in_range(levels->hierarchy);
  return levels;
}

VolumeSource volume_source_from(std::string_view bytes) { return from_bytes<VolumeSource>(bytes); }

}  // namespace isoatlas::detail::python
