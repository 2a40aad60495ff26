// SPDX-License-Identifier: Apache-2.0
#include "api/remove_seam_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "api/shared_planes.h"
#include "core/ids.h"
#include "core/ranges.h"
#include "core/sort_once.h"
#include "core/vector_math.h"
#include "field/dense_volume.h"
#include "geometry/output_positions.h"
#include "isosurface/parse_surface.h"
#include "simplify/remove_vertices.h"

namespace isoatlas::detail {
namespace {

// Triangles that extend from a shared face farther than this share of a block, or this many voxels
// if that is more, are left as they are: the samples around a face need little more memory than
// those of a block.
constexpr double kReach = 0.25, kMinReach = 16;
constexpr double kBoundRounding = 1e-9;

// @return absent if the goal has a bound that cannot be tested
std::optional<CollapseLimits> limits_of(const LevelGoal& goal, double voxel) {
  CollapseLimits out;
  for (const Constraint& c : goal) {
    switch (c.quantity) {
      case Quantity::max_distance:
        out.max_distance = (1 - kBoundRounding) * c.bound / voxel;
        break;
      case Quantity::max_edge:
        out.max_edge = c.bound / voxel;
        break;
      case Quantity::min_aspect:
        out.shape = ShapeGoal::of(c.bound);
        break;
      case Quantity::min_edge:
        break;
      default:
        return std::nullopt;
    }
  }
  return out;
}

// Vertices whose triangles are near one shared face.
struct FaceGroup {
  std::array<std::size_t, 4> face;  // axis, number of the plane, and of the face along the others
  std::vector<std::uint32_t> vertices;
};

class SeamPass {
 public:
  SeamPass(Hierarchy& hierarchy, std::span<const std::uint8_t> is_on_seam, const BlockPlan& plan,
           const ExtractOptions& options, const SamplesOfBlock& samples_of,
           const RunControl& control)
      : hierarchy_(hierarchy),
        is_on_seam_(is_on_seam),
        plan_(plan),
        planes_(plan),
        options_(options),
        samples_of_(samples_of),
        control_(control),
        voxel_(plan.grid().smallest_spacing()) {
    const Vec3 spacing = plan.grid().spacing;
    spacing_ = {spacing.x / voxel_, spacing.y / voxel_, spacing.z / voxel_};
    const auto last = [&](std::size_t a) { return static_cast<double>(plan.grid().size[a] - 1); };
    box_ = {{last(0), last(1), last(2)}};
  }

  std::size_t run() {
    for (std::size_t l = 0; l < hierarchy_.levels.size(); ++l) simplify_level(l);
    return renumber();
  }

 private:
  const LevelGoal& goal(std::size_t level) const {
    return level == 0 ? options_.coarse : options_.refine[level - 1];
  }

  void simplify_level(std::size_t l) {
    Hierarchy::Level& level = hierarchy_.levels[l];
    std::vector<std::uint32_t>& onto = onto_.emplace_back(level.vertex_count, kNone);
    const std::optional<CollapseLimits> limits = limits_of(goal(l), voxel_);
    if (!limits) return;
    const std::span<const Vec3> positions =
        level.own_positions.empty()
            ? std::span<const Vec3>(hierarchy_.positions).first(level.vertex_count)
            : level.own_positions;
    CollapsingMesh mesh(positions, std::move(level.triangles), spacing_);
    IntersectionTracker tracker(OutputPositions(plan_.grid(), options_.space, 1));
    tracker.start(positions, mesh.triangles(), control_);
    VertexRemoval removal(mesh, tracker, box_, *limits, control_);
    const std::vector<std::uint32_t> candidates = candidates_of(l, mesh);
    const auto remove = [&](std::span<const std::uint32_t> vertices, NearbyIsosurface* isosurface) {
      for (const Collapse& c : removal.remove(vertices, isosurface)) onto[c.vertex] = c.target;
    };
    if (std::isinf(limits->max_distance)) {
      remove(candidates, nullptr);
    } else {
      for (const FaceGroup& group : groups_of(candidates, mesh))
        simplify_near_face(group, mesh, *limits, level, remove);
    }
    for (std::uint32_t v = 0; v < onto.size(); ++v) {
      if (onto[v] == kNone) continue;
      while (onto[onto[v]] != kNone) onto[v] = onto[onto[v]];
    }
    level.triangles.assign(mesh.triangles().begin(), mesh.triangles().end());
    std::erase_if(level.triangles, [](const Triangle& t) { return CollapsingMesh::is_removed(t); });
  }

  // A vertex may be removed from a level if no coarser level has it. On seams all may, and in
  // refined levels those next to seams.
  std::vector<std::uint32_t> candidates_of(std::size_t l, const CollapsingMesh& mesh) const {
    const std::uint32_t before = l == 0 ? 0 : hierarchy_.levels[l - 1].vertex_count;
    const auto is_free = [&](std::uint32_t v) {
      return l == 0 || v >= before || onto_[l - 1][v] != kNone;
    };
    std::vector<std::uint32_t> out;
    for (std::uint32_t v = 0; v < hierarchy_.levels[l].vertex_count; ++v) {
      if (is_on_seam_[v] == 0) continue;
      if (is_free(v)) out.push_back(v);
      if (l == 0) continue;
      for (const std::uint32_t t : mesh.star(v)) {
        for (const std::uint32_t w : mesh.triangle(t)) {
          if (is_on_seam_[w] == 0 && is_free(w)) out.push_back(w);
        }
      }
    }
    sort_unique_ids(out);
    return out;
  }

  // The shared face that contains a vertex: the first one in the order of axes.
  std::array<std::size_t, 4> face_of(const Vec3& p) const {
    const auto block_along = [&](std::size_t a, double x) {
      return std::min(static_cast<std::size_t>(x) / plan_.block_size()[a], plan_.counts()[a] - 1);
    };
    std::array<std::size_t, 4> out{};
    for (std::size_t a = 0; a < 3; ++a) {
      if (!planes_.is_on_plane(p, static_cast<int>(a))) continue;
      const std::size_t u = (a + 1) % 3, v = (a + 2) % 3;
      out = {a, block_along(a, coordinate(p, static_cast<int>(a))),
             block_along(u, coordinate(p, static_cast<int>(u))),
             block_along(v, coordinate(p, static_cast<int>(v)))};
      break;
    }
    return out;
  }

  std::vector<FaceGroup> groups_of(std::span<const std::uint32_t> candidates,
                                   const CollapsingMesh& mesh) const {
    std::vector<std::pair<std::array<std::size_t, 4>, std::uint32_t>> all;
    for (const std::uint32_t v : candidates) {
      std::uint32_t on_seam = is_on_seam_[v] != 0 ? v : kNone;
      for (const std::uint32_t t : mesh.star(v)) {
        for (const std::uint32_t w : mesh.triangle(t)) {
          if (is_on_seam_[v] == 0 && is_on_seam_[w] != 0) on_seam = std::min(on_seam, w);
        }
      }
      all.emplace_back(face_of(mesh.positions()[on_seam]), v);
    }
    ranges::sort(all);
    std::vector<FaceGroup> out;
    for (const auto& [face, v] : all) {
      if (out.empty() || out.back().face != face) out.push_back({face, {}});
      out.back().vertices.push_back(v);
    }
    return out;
  }

  struct Extent {
    Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    void include(const Vec3& p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    bool contains(const Vec3& p) const {
      return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z &&
             p.z <= high.z;
    }
  };

  // The shared face, larger on all sides.
  Extent reach_of(const std::array<std::size_t, 4>& face) const {
    std::array<double, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (face[0] + k) % 3;
      const auto size = static_cast<double>(plan_.block_size()[a]);
      const double reach = std::max(kReach * size, kMinReach);
      const double first = static_cast<double>(face[1 + k]) * size;
      low[a] = first - reach;
      high[a] = first + (k == 0 ? 0 : size) + reach;
    }
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

  // The samples around a box, with a margin for the bound.
  BlockBox samples_around(const Extent& extent, double bound) const {
    BlockBox out;
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      const double margin = 2 + std::ceil(bound / coordinate(spacing_, axis));
      const double last = coordinate(box_.high, axis);
      const double low = std::floor(coordinate(extent.low, axis)) - margin,
                   high = std::ceil(coordinate(extent.high, axis)) + margin;
      out.first[a] = static_cast<std::size_t>(std::clamp(low, 0.0, last));
      out.last[a] = static_cast<std::size_t>(std::clamp(high, 0.0, last));
    }
    return out;
  }

  template <class Remove>
  void simplify_near_face(const FaceGroup& group, const CollapsingMesh& mesh,
                          const CollapseLimits& limits, Hierarchy::Level& level, Remove remove) {
    const Extent reach = reach_of(group.face);
    std::vector<std::uint32_t> vertices, region;
    Extent extent;
    for (const std::uint32_t v : group.vertices) {
      const std::span<const std::uint32_t> star = mesh.star(v);
      const auto is_inside = [&](std::uint32_t t) {
        return ranges::all_of(mesh.triangle(t),
                              [&](std::uint32_t w) { return reach.contains(mesh.positions()[w]); });
      };
      if (star.empty() || !ranges::all_of(star, is_inside)) continue;
      vertices.push_back(v);
      region.insert(region.end(), star.begin(), star.end());
    }
    if (vertices.empty()) return;
    sort_unique_ids(region);
    for (const std::uint32_t t : region) {
      for (const std::uint32_t v : mesh.triangle(t)) extent.include(mesh.positions()[v]);
    }
    const BlockBox box = samples_around(extent, limits.max_distance);
    const Volume samples = samples_of_(box);
    const Volume dense = dense_volume(samples);
    VolumeView view = dense.view;
    view.grid = {};
    view.grid.size = dense.view.grid.size;
    view.grid.spacing = spacing_;
    ParseOptions parse;
    parse.rule = {options_.surface.isovalue, options_.surface.inside, options_.surface.non_finite};
    parse.topology = options_.surface.topology;
    parse.vertices_on_surface = options_.vertices_on_surface;
    const SurfaceComplex surface = parse_surface(view, parse, control_);
    const Isosurface isosurface(view, parse.rule, surface, Interpolation::trilinear, 1, control_);
    const auto first = [&](std::size_t a) { return static_cast<double>(box.first[a]); };
    NearbyIsosurface nearby(mesh, {{first(0), first(1), first(2)}, surface, isosurface}, region,
                            limits.max_distance, control_);
    remove(vertices, &nearby);
    for (std::uint32_t cell = 0; cell < nearby.cell_count(); ++cell) {
      const NearbyIsosurface::Sample sample = nearby.farthest_c_vertex(cell);
      if (sample.vertex == kNone || level.distance.empty()) continue;
      float& distance = level.distance[sample.vertex];
      // Rounded down: the bound is satisfied.
      distance =
          std::max(distance, std::nextafter(static_cast<float>(sample.distance * voxel_), 0.0f));
    }
  }

  // The level in which a vertex appears first now.
  std::size_t first_level(std::uint32_t v) const {
    std::size_t l = 0;
    while (l < onto_.size() && (v >= onto_[l].size() || onto_[l][v] != kNone)) ++l;
    return l;
  }

  // Orders the vertices by the first level that contains them, then as before.
  // @return the number of vertices that no level contains
  std::size_t renumber() {
    const auto count = static_cast<std::uint32_t>(hierarchy_.positions.size());
    std::vector<std::uint32_t> order(count), number(count, kNone);
    std::vector<std::uint8_t> first(count);
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t v = 0; v < count; ++v) first[v] = static_cast<std::uint8_t>(first_level(v));
    ranges::stable_sort(order, std::less<>(), [&](std::uint32_t v) { return first[v]; });
    const auto end = ranges::lower_bound(order, hierarchy_.levels.size(), std::less<>(),
                                         [&](std::uint32_t v) { return std::size_t{first[v]}; });
    const std::size_t removed = static_cast<std::size_t>(order.end() - end);
    order.erase(end, order.end());
    for (std::uint32_t i = 0; i < order.size(); ++i) number[order[i]] = i;
    std::vector<std::uint32_t> parent(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const std::uint32_t v = order[i];
      parent[i] = first[v] == 0 ? i : number[parent_of(v, first[v] - std::size_t{1})];
    }
    hierarchy_.parent = std::move(parent);
    hierarchy_.positions = in_order(hierarchy_.positions, order);
    for (std::size_t l = 0; l < hierarchy_.levels.size(); ++l) {
      Hierarchy::Level& level = hierarchy_.levels[l];
      const auto last = ranges::lower_bound(order, l + 1, std::less<>(),
                                            [&](std::uint32_t v) { return std::size_t{first[v]}; });
      const std::span<const std::uint32_t> of_level(order.data(),
                                                    static_cast<std::size_t>(last - order.begin()));
      level.vertex_count = static_cast<std::uint32_t>(of_level.size());
      if (!level.own_positions.empty())
        level.own_positions = in_order(level.own_positions, of_level);
      if (!level.distance.empty()) level.distance = in_order(level.distance, of_level);
      for (Triangle& t : level.triangles) {
        for (std::uint32_t& v : t) v = number[v];
      }
    }
    return removed;
  }

  template <class T>
  static std::vector<T> in_order(const std::vector<T>& values,
                                 std::span<const std::uint32_t> order) {
    std::vector<T> out;
    out.reserve(order.size());
    for (const std::uint32_t v : order) out.push_back(values[v]);
    return out;
  }

  // @param level  the last one without the vertex
  std::uint32_t parent_of(std::uint32_t v, std::size_t level) const {
    const std::uint32_t parent = v < onto_[level].size() ? v : hierarchy_.parent[v];
    return onto_[level][parent] == kNone ? parent : onto_[level][parent];
  }

  Hierarchy& hierarchy_;
  std::span<const std::uint8_t> is_on_seam_;
  const BlockPlan& plan_;
  SharedPlanes planes_;
  const ExtractOptions& options_;
  const SamplesOfBlock& samples_of_;
  const RunControl& control_;
  double voxel_;
  Vec3 spacing_;  // in voxels
  BoxFaces box_;
  std::vector<std::vector<std::uint32_t>> onto_;  // per level and vertex: where it was moved
};

}  // namespace

std::size_t remove_seam_vertices(Hierarchy& hierarchy, std::span<const std::uint8_t> is_on_seam,
                                 const BlockPlan& plan, const ExtractOptions& options,
                                 const SamplesOfBlock& samples_of, const RunControl& control) {
  return SeamPass(hierarchy, is_on_seam, plan, options, samples_of, control).run();
}

}  // namespace isoatlas::detail
