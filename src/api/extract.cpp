// SPDX-License-Identifier: Apache-2.0
// The place to start reading: volume -> surface complex -> coarser complex -> covering -> certified
// dual -> checked mesh -> finer levels.
#include "isoatlas/extract.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <new>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "api/choose_components.h"
#include "api/extract_block.h"
#include "api/ladder.h"
#include "api/resolve_options.h"
#include "complex/coarsen.h"
#include "complex/component_sizes.h"
#include "complex/components.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/adaptive_surface.h"
#include "field/check_volume.h"
#include "field/dense_volume.h"
#include "isosurface/parse_surface.h"
#include "isosurface/surface_nesting.h"
#include "levels/coarse_mesher.h"
#include "levels/level.h"
#include "levels/level_maker.h"

namespace isoatlas {
using namespace detail;
namespace {

// The coarser complex consists of blocks of four voxels, but its blocks stay well below the largest
// radius so that the covering can choose among its c-vertices. Below one and a half voxels blocks
// save nothing, and the covering uses the full complex.
constexpr double kBlockVoxels = 4;
constexpr double kBlocksPerRadius = 4;
constexpr double kMinBlockVoxels = 1.5;

class StageClock {
 public:
  explicit StageClock(ExtractReport& report)
      : report_(report), start_(Clock::now()), last_(start_) {}
  void finished(const char* stage) {
    const auto now = Clock::now();
    report_.seconds.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    report_.total_seconds = std::chrono::duration<double>(now - start_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  ExtractReport& report_;
  Clock::time_point start_, last_;
};

void check_planned_levels(const ExtractOptions& options) {
  if (options.levels == 0) return;
  require(options.levels <= kMaxLevels, "at most " + std::to_string(kMaxLevels) + " levels");
  require(options.refine.size() == 1,
          "with a number of levels, expected one goal to refine to: that of the finest level");
  require(options.coarse.empty(),
          "with a number of levels, expected no constraints of the coarse level: it is omitted");
  require(ranges::any_of(options.refine.front(),
                         [](const Constraint& c) { return c.quantity == Quantity::max_distance; }),
          "a number of levels needs a bound on max-distance for the finest level");
}

void check_options(const ExtractOptions& options) {
  require(!options.covering.max_radius || (std::isfinite(options.covering.max_radius->value) &&
                                           options.covering.max_radius->value > 0),
          "the largest radius must be a positive length");
  require(!options.covering.event_persistence ||
              (std::isfinite(options.covering.event_persistence->value) &&
               options.covering.event_persistence->value >= 0),
          "the event persistence must be a length >= 0");
  require(std::isfinite(options.components.min_size) && options.components.min_size >= 0,
          "the smallest component must have a size >= 0");
  require(options.supersample >= 1, "the factor of supersampling must be at least 1");
  require(options.adaptive_supersample <= kMaxSubdivisions,
          "adaptive supersampling may subdivide the surface at most 8 times");
  require(
      options.border == Border::open || !options.allow_self_intersections,
      "a mesh with self-intersections cannot be closed on the volume boundary; leave the border "
      "open or do not allow self-intersections");
  check_planned_levels(options);
  std::vector<const LevelGoal*> goals{&options.coarse};
  for (const LevelGoal& goal : options.refine) goals.push_back(&goal);
  for (const LevelGoal* goal : goals) {
    std::array<bool, kQuantityCount> seen{};
    for (const Constraint& c : *goal) {
      const std::string what(name(c));
      const bool is_ratio = is_metric(c.quantity) && unit(c.quantity) == Unit::ratio;
      require(std::isfinite(c.bound) && c.bound > 0, what + " needs a bound above 0");
      require(!is_ratio || c.bound > 1,
              what + " needs a bound above 1: it is a ratio that is 1 at best");
      require(c.quantity != Quantity::min_aspect || c.bound < 1, what + " needs a bound below 1");
      if (c.custom) continue;  // several are permitted
      require(c.quantity != Quantity::custom, "a custom constraint needs a metric");
      require(!std::exchange(seen[static_cast<std::size_t>(c.quantity)], true),
              what + " is given twice for one level");
    }
  }
}

// The paper's figure 4 has no persistence.
float default_persistence(CoveringStrategy strategy) {
  return strategy == CoveringStrategy::halving ? 0.0f : 1.5f;
}

// Whether some component of the closed surface is not part of the open one: it is the whole surface
// of the volume's box.
bool contains_whole_box(const Components& parts, std::span<const std::uint32_t> part_of) {
  std::vector<std::uint8_t> has_component(parts.topology.size(), 0);
  for (const std::uint32_t part : part_of) has_component[part] = 1;
  return ranges::count(has_component, std::uint8_t{0}) > 0;
}

// Removes the components that the options exclude, from the surface and from what was derived from
// it. @return what the caps of the others have to be, if the options close the surface
std::optional<CapReference> choose_and_cap(SurfaceComplex& whole, Components& components,
                                           Nesting& nesting, const VolumeView& volume_in_voxels,
                                           const ParseOptions& parse, const VolumeView& volume,
                                           const ExtractOptions& options, ExtractReport& report,
                                           const RunControl& control) {
  const bool is_closed = options.border == Border::closed;
  SurfaceComplex capped;
  Components parts;
  const bool is_capped = is_closed || !whole.boundary.empty();
  if (is_capped) {
    ParseOptions with_caps = parse;
    with_caps.closed = true;
    capped = parse_surface(volume_in_voxels, with_caps, control);
    parts = find_components(capped);
  }
  const ComponentSizes sizes = is_capped ? component_sizes(whole, components, capped, parts)
                                         : component_sizes(whole, components, whole, components);
  control.check_cancelled();
  std::vector<std::uint8_t> is_dropped;
  if (options.components.selects()) {
    if (is_closed && contains_whole_box(parts, sizes.part_of))
      throw Error(ErrorCode::unsupported,
                  "the whole volume boundary is inside, so the largest component is the surface of "
                  "the volume's box; keep all components, or leave the border open");
    ChosenComponents chosen = choose_components(whole, components, sizes, options, volume.grid);
    report.kept = std::move(chosen.kept);
    report.dropped = std::move(chosen.dropped);
    is_dropped = std::move(chosen.is_dropped);
    if (whole.faces.empty()) {
      throw Error(ErrorCode::empty_surface,
                  "every component is dropped: the largest has a size of " +
                      std::to_string(report.dropped.front().size) + " cubic units");
    }
    control.check_cancelled();
    if (!report.dropped.empty()) {
      components = find_components(whole);
      nesting = without(nesting, is_dropped);
    }
  }
  if (!is_closed) return std::nullopt;
  const auto last = [&](std::size_t axis) {
    return static_cast<double>((volume.grid.size[axis] - 1) * options.supersample);
  };
  return make_cap_reference(capped, parts, sizes.part_of, is_dropped,
                            {{last(0), last(1), last(2)}});
}

// Measured on medical scans: all stages up to the coarse mesh take about a third of the time of a
// refined level.
std::vector<StageShare> stage_shares(const ExtractOptions& options) {
  const auto refined =
      static_cast<double>(options.levels > 0 ? options.levels : options.refine.size());
  return {{"surface", 2}, {"components", 2}, {"coarsen", 2}, {"cover", 2},
          {"certify", 2}, {"mesh", 9},       {"check", 1},   {"refine", 60 * refined}};
}

// Removes level 0, which has no bound on its error, from planned levels. The next level becomes
// level 0.
void omit_coarse_level(Extraction& extraction) {
  Hierarchy& hierarchy = extraction.hierarchy;
  hierarchy.levels.erase(hierarchy.levels.begin());
  extraction.report.levels.erase(extraction.report.levels.begin());
  std::iota(hierarchy.parent.begin(),
            hierarchy.parent.begin() + hierarchy.levels.front().vertex_count, 0u);
}

void check_options_of_block(const ExtractOptions& options) {
  const auto require_whole = [](bool possible, const char* what) {
    if (!possible)
      throw Error(ErrorCode::unsupported, std::string(what) + " cannot be had in blocks");
  };
  require_whole(options.surface.interpolation == Interpolation::trilinear,
                "tricubic interpolation, which needs samples beyond a block,");
  require_whole(options.supersample == 1, "supersampling");
  require_whole(options.covering.strategy != CoveringStrategy::halving,
                "a covering by halving, which has no vertices that are given,");
  require_whole(options.border == Border::open, "a surface closed on the volume boundary");
  require_whole(!options.components.selects(), "a choice of components");
  require_whole(!options.allow_self_intersections, "a mesh with self-intersections");
  require_whole(options.levels == 0, "a number of levels");
  require_whole(options.measure_samples == 0, "a measurement of distances");
  require_whole(options.space == Space::voxel, "another space than that of the samples");
  for (const LevelGoal& goal : options.refine)
    require_whole(ranges::none_of(goal,
                                  [](const Constraint& c) {
                                    return c.quantity == Quantity::max_vertices ||
                                           c.quantity == Quantity::min_vertices;
                                  }),
                  "a bound on the number of vertices");
}

// @param block  null: the volume is whole
Extraction extract_any(const VolumeView& any_volume, const ExtractOptions& any_options,
                       const BlockPlace* block, const RunControl& caller_control) try {
  ExtractOptions options = in_world(any_options, any_volume.grid);
  const RunControl control = with_whole_progress(caller_control, stage_shares(options));
  check_volume(any_volume, options.surface.isovalue);
  const Volume dense = dense_volume(any_volume);
  const VolumeView& volume = dense.view;
  check_options(options);
  if (block) check_options_of_block(options);
  // Bounds and distances are world lengths; the coarse mesh alone needs none.
  const bool only_coarse =
      options.refine.empty() && options.measure_samples == 0 && options.coarse.empty();
  if (!only_coarse) require_orthonormal(volume.grid);
  const ThreadLimit threads(control.threads);
  Extraction out;
  ExtractReport& report = out.report;
  StageClock clock(report);
  // The unit of length is the smallest spacing, so that no length leaves the range of float.
  const Grid& grid = volume.grid;
  const double voxel = grid.smallest_spacing();
  VolumeView in_voxels = volume;
  in_voxels.grid.spacing = {grid.spacing.x / voxel, grid.spacing.y / voxel, grid.spacing.z / voxel};
  const auto voxels = [&](double world) {
    return static_cast<float>(std::min(world / voxel, 1e30));
  };

  control.report("surface", 0);
  ParseOptions parse;
  parse.rule = {options.surface.isovalue, options.surface.inside, options.surface.non_finite};
  parse.topology = options.surface.topology;
  parse.interpolation = options.surface.interpolation;
  parse.supersample = options.supersample;
  parse.vertices_on_surface = options.vertices_on_surface;
  SharedBox shared;
  if (block) {
    const auto last = [&](std::size_t axis) { return static_cast<double>(grid.size[axis] - 1); };
    shared = {{{last(0), last(1), last(2)}}, bits_of(block->shared)};
    parse.shared = block->shared;
  }
  std::vector<VerticalNode> nodes;
  SurfaceComplex whole = parse_surface(in_voxels, parse, control, &nodes);
  if (whole.faces.empty() && block) return out;
  if (whole.faces.empty()) throw_empty_surface(volume, options.surface.isovalue);
  clock.finished("surface");

  control.report("components", 0);
  Components reference = find_components(whole);
  report_continuing(control);
  Nesting nesting = surface_nesting(reference, nodes);
  nodes = {};
  control.check_cancelled();
  std::optional<CapReference> caps;
  if (options.components.selects() || options.border == Border::closed) {
    caps = choose_and_cap(whole, reference, nesting, in_voxels, parse, volume, options, report,
                          control);
  }
  if (options.levels > 0) options.refine = planned_levels(options, whole, reference, voxel);
  report.c_vertices = whole.positions.size();
  report.faces = whole.faces.size();
  report.double_segments = whole.double_segments;
  report.tunnels = whole.tunnels;
  report.reference = summarize(caps ? caps->topology : reference.topology);
  const std::unique_ptr<const Isosurface> isosurface =
      only_coarse ? nullptr
                  : std::make_unique<const Isosurface>(in_voxels, parse.rule, whole,
                                                       options.surface.interpolation,
                                                       options.supersample, control);
  report_continuing(control);
  AdaptiveSurface surface(
      std::move(whole), std::move(reference), std::move(nesting),
      InterpolatedField(in_voxels, parse.rule, options.surface.interpolation, options.supersample),
      control, std::move(caps), shared);
  clock.finished("components");

  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 s = in_voxels.grid.spacing;
    longest = std::max(longest, static_cast<double>(grid.size[a] - 1) * (a == 0   ? s.x
                                                                         : a == 1 ? s.y
                                                                                  : s.z));
  }
  const double max_radius = options.covering.max_radius
                                ? std::max(1e-4f, voxels(options.covering.max_radius->value))
                                : longest / 2;

  control.report("coarsen", 0);
  const double cell = 1.0 / options.supersample;  // side of a cell of the parsed grid, in voxels
  const double side = std::min(kBlockVoxels * cell, max_radius / kBlocksPerRadius);
  Coarsened coarser;
  if (side >= kMinBlockVoxels * cell) {
    coarser = coarsen(surface.complex(), side, control);
    report.coarsening = coarser.certificate;
    report.coarser_c_vertices.push_back(coarser.complex.positions.size());
  }
  clock.finished("coarsen");

  control.report("cover", 0);
  CoveringOptions cover;
  cover.max_radius = static_cast<float>(max_radius);
  cover.event_persistence = options.covering.event_persistence
                                ? voxels(options.covering.event_persistence->value)
                                : default_persistence(options.covering.strategy);
  cover.first_stage = static_cast<float>(4 * cell);
  const OutputPositions output_positions =
      block ? OutputPositions(block->whole, block->space, 1, block->first)
            : OutputPositions(grid, options.space, options.supersample);
  auto mesher = std::make_unique<CoarseMesher>(surface, coarser, cover, options, output_positions);
  mesher->cover(control);
  clock.finished("cover");

  control.report("certify", 0);
  LevelReport& coarse = report.levels.emplace_back();  // the only one until the refinement starts
  mesher->certify(coarse, control);
  clock.finished("certify");

  control.report("mesh", 0);
  mesher->mesh(coarse, control);
  const CoarseLevel level = mesher->take_level();
  mesher.reset();
  clock.finished("mesh");

  control.report("check", 0);
  TriangleMesh mesh = level.mesh;
  const std::vector<ShapeObstacle> obstacles_of_level = obstacles(level.placement, surface, 0);
  finish_level(mesh, level.topology, level.placement.anchor, surface, obstacles_of_level,
               options.coarse, grid, options, coarse, control);
  clock.finished("check");

  Hierarchy& hierarchy = out.hierarchy;
  if (const Vec3 origin = float32_origin(grid, options.space); origin != Vec3{})
    hierarchy.float32_origin = origin;
  hierarchy.positions = std::move(mesh.positions);
  Hierarchy::Level& level_0 = hierarchy.levels.emplace_back();
  level_0.vertex_count = checked_id(hierarchy.positions.size(), "vertices");
  level_0.triangles = std::move(mesh.triangles);
  level_0.cap_triangles = cap_count(coarse);
  hierarchy.parent.resize(hierarchy.positions.size());
  std::iota(hierarchy.parent.begin(), hierarchy.parent.end(), 0u);
  const auto fill_subdivision_report = [&] {
    report.subdivided_c_vertices = surface.subdivision_count();
    report.added_c_vertices = surface.added_count();
    report.max_subdivision_depth = surface.max_depth();
  };
  fill_subdivision_report();
  if (only_coarse) return out;

  control.report("refine", 0);
  LevelMaker maker({grid, surface, *isosurface, coarser, cover, level, output_positions}, options,
                   control);
  maker.describe_coarse(hierarchy, report.levels.front());
  for (const LevelGoal& goal : options.refine) maker.add_level(goal, hierarchy, report.levels);
  fill_subdivision_report();
  if (options.levels > 0) omit_coarse_level(out);
  clock.finished("refine");
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for this surface");
} catch (const std::length_error&) {
  throw Error(ErrorCode::out_of_memory, "this surface is too large for memory");
}

}  // namespace

Extraction extract(const VolumeView& volume, const ExtractOptions& options,
                   const RunControl& control) {
  return extract_any(volume, options, nullptr, control);
}

}  // namespace isoatlas

namespace isoatlas::detail {

Extraction extract_block(const VolumeView& block, const ExtractOptions& options,
                         const BlockPlace& place, const RunControl& control) {
  return extract_any(block, options, &place, control);
}

}  // namespace isoatlas::detail
