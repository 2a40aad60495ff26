// SPDX-License-Identifier: Apache-2.0
// The union of the meshes of all blocks (docs/theory/08-seams.md).
#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>

#include "api/remove_seam_vertices.h"
#include "api/resolve_options.h"
#include "api/shared_planes.h"
#include "core/ids.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "core/vector_math.h"
#include "field/to_space.h"
#include "geometry/box_faces.h"
#include "geometry/output_positions.h"
#include "isoatlas/blocks.h"
#include "levels/mesh_figures.h"

namespace isoatlas {
using namespace detail;
namespace {

std::string text(const Vec3& p) {
  return "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ")";
}

[[noreturn]] void throw_misfit(const std::string& what) {
  throw Error(ErrorCode::bad_argument,
              what + "; make all blocks again from the same samples, with the same options");
}

struct SeamVertex {
  std::array<double, 3> at;
  std::size_t mesh;
  std::uint32_t vertex;
  Vec3 position() const { return {at[0], at[1], at[2]}; }
};

class Merger {
 public:
  Merger(const BlockPlan& plan, std::vector<BlockMesh> meshes, const ExtractOptions& options,
         const RunControl& control, const SamplesOfBlock& samples_of)
      : plan_(plan),
        planes_(plan),
        meshes_(std::move(meshes)),
        options_(in_world(options, plan.grid())),
        control_(control),
        samples_of_(samples_of) {
    ranges::sort(meshes_, {}, &BlockMesh::block);
    for (std::size_t b = 0; b < plan.block_count(); ++b) {
      require(b < meshes_.size() && meshes_[b].block == b,
              (b > 0 && b < meshes_.size() && meshes_[b].block == b - 1)
                  ? "block " + std::to_string(b - 1) + " is there twice"
                  : "block " + std::to_string(b) + " is missing");
    }
    require(meshes_.size() == plan.block_count(),
            "there is no block " + std::to_string(meshes_.back().block) + "; the plan has " +
                std::to_string(plan.block_count()));
    std::erase_if(meshes_, [](const BlockMesh& m) { return m.hierarchy.levels.empty(); });
    if (meshes_.empty())
      throw Error(ErrorCode::empty_surface, "the surface crosses none of the " +
                                                std::to_string(plan.block_count()) + " blocks");
    levels_ = 1 + options_.refine.size();
    for (const BlockMesh& m : meshes_)
      require(m.hierarchy.levels.size() == levels_ && m.report.levels.size() == levels_,
              "block " + std::to_string(m.block) + " has " +
                  std::to_string(m.hierarchy.levels.size()) + " levels, expected " +
                  std::to_string(levels_));
  }

  Extraction run() {
    find_seam_vertices();
    number_vertices();
    make_hierarchy();
    if (samples_of_)
      removed_ =
          remove_seam_vertices(out_.hierarchy, is_on_seam_, plan_, options_, samples_of_, control_);
    make_report();
    return std::move(out_);
  }

 private:
  std::string name_of(const SeamVertex& v) const {
    return "block " + std::to_string(meshes_[v.mesh].block);
  }

  // Sorted by position, then by block.
  void find_seam_vertices() {
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      const std::vector<Vec3>& positions = meshes_[m].hierarchy.positions;
      for (std::uint32_t v = 0; v < positions.size(); ++v) {
        const Vec3& p = positions[v];
        if (planes_.blocks_at(p) > 1) seam_.push_back({{p.x, p.y, p.z}, m, v});
      }
    }
    control_.check_cancelled();
    ranges::sort(seam_, [](const SeamVertex& a, const SeamVertex& b) {
      return std::tie(a.at, a.mesh, a.vertex) < std::tie(b.at, b.mesh, b.vertex);
    });
    for (std::size_t i = 0, end; i < seam_.size(); i = end) {
      for (end = i + 1; end < seam_.size() && seam_[end].at == seam_[i].at;) ++end;
      if (end - i != planes_.blocks_at(seam_[i].position()))
        throw_misfit(name_of(seam_[i]) + " does not fit its neighbours: they have no vertex at " +
                     text(seam_[i].position()));
    }
  }

  // Vertices of the merged mesh: by level, then by block.
  void number_vertices() {
    for (const BlockMesh& m : meshes_) number_.emplace_back(m.hierarchy.positions.size(), kNone);
    std::vector<std::uint32_t> group(seam_.size());  // its first entry in seam_
    for (std::uint32_t i = 0; i < seam_.size(); ++i) {
      group[i] = i > 0 && seam_[i - 1].at == seam_[i].at ? group[i - 1] : i;
      number_[seam_[i].mesh][seam_[i].vertex] = i;  // until it gets its number
    }
    std::vector<std::uint32_t> number_of_group(seam_.size(), kNone);
    std::size_t next = 0;
    for (std::size_t l = 0; l < levels_; ++l) {
      for (std::size_t m = 0; m < meshes_.size(); ++m) {
        const Hierarchy& own = meshes_[m].hierarchy;
        const std::uint32_t begin = l == 0 ? 0 : own.levels[l - 1].vertex_count;
        for (std::uint32_t v = begin; v < own.levels[l].vertex_count; ++v) {
          std::uint32_t& number = number_[m][v];
          if (number == kNone) {
            number = checked_id(next++, "vertices");
            continue;
          }
          std::uint32_t& shared = number_of_group[group[number]];
          if (shared == kNone) shared = checked_id(next++, "vertices");
          number = shared;
        }
      }
      vertex_count_.push_back(checked_id(next, "vertices"));
    }
    is_on_seam_.assign(next, 0);
    for (const SeamVertex& v : seam_) is_on_seam_[number_[v.mesh][v.vertex]] = 1;
    seam_vertices_ = static_cast<std::size_t>(ranges::count(is_on_seam_, std::uint8_t{1}));
    duplicates_ = seam_.size() - seam_vertices_;
  }

  void make_hierarchy() {
    Hierarchy& to = out_.hierarchy;
    to.positions.resize(vertex_count_.back());
    to.parent.resize(vertex_count_.back());
    const bool is_balanced = options_.placement == Placement::balanced;
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      control_.check_cancelled();
      const Hierarchy& from = meshes_[m].hierarchy;
      for (std::uint32_t v = 0; v < from.positions.size(); ++v) {
        to.positions[number_[m][v]] = from.positions[v];
        to.parent[number_[m][v]] = number_[m][from.parent[v]];
      }
    }
    for (std::size_t l = 0; l < levels_; ++l) {
      Hierarchy::Level& level = to.levels.emplace_back();
      level.vertex_count = vertex_count_[l];
      if (is_balanced && l > 0) level.own_positions.resize(level.vertex_count);
      for (std::size_t m = 0; m < meshes_.size(); ++m) {
        control_.check_cancelled();
        Hierarchy::Level& from = meshes_[m].hierarchy.levels[l];
        for (const Triangle& t : from.triangles)
          level.triangles.push_back({number_[m][t[0]], number_[m][t[1]], number_[m][t[2]]});
        if (!from.distance.empty()) level.distance.resize(level.vertex_count, 0);
        for (std::uint32_t v = 0; v < from.distance.size(); ++v) {
          float& distance = level.distance[number_[m][v]];
          distance = std::max(distance, from.distance[v]);
        }
        for (std::uint32_t v = 0; v < from.own_positions.size(); ++v)
          level.own_positions[number_[m][v]] = from.own_positions[v];
        from = {};
      }
    }
    check_seams();
  }

  // Every edge on a shared face has a triangle on both sides.
  void check_seams() {
    const std::vector<Vec3>& positions = out_.hierarchy.positions;
    for (const Hierarchy::Level& level : out_.hierarchy.levels) {
      std::vector<std::array<std::uint32_t, 2>> edges;
      for (const Triangle& t : level.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = t[k], b = t[(k + 1) % 3];
          if (is_on_seam_[a] != 0 && is_on_seam_[b] != 0 &&
              planes_.have_common_plane(positions[a], positions[b]))
            edges.push_back({a, b});
        }
      }
      control_.check_cancelled();
      ranges::sort(edges);
      seam_edges_ = edges.size() / 2;
      for (const auto& [a, b] : edges) {
        if (!std::binary_search(edges.begin(), edges.end(), std::array{b, a}))
          throw_misfit("two blocks do not fit: only one of them has the edge from " +
                       text(positions[a]) + " to " + text(positions[b]));
      }
    }
  }

  void make_report() {
    ExtractReport& to = out_.report;
    BlockSummary& blocks = to.blocks.emplace();
    blocks = {plan_.block_size(), plan_.counts(), meshes_.size(),
              seam_vertices_,     seam_edges_,    removed_};
    std::int64_t euler = 0;
    for (const BlockMesh& m : meshes_) {
      const ExtractReport& from = m.report;
      to.c_vertices += from.c_vertices;
      to.faces += from.faces;
      to.double_segments += from.double_segments;
      to.tunnels += from.tunnels;
      to.coarser_c_vertices.resize(
          std::max(to.coarser_c_vertices.size(), from.coarser_c_vertices.size()));
      for (std::size_t i = 0; i < from.coarser_c_vertices.size(); ++i)
        to.coarser_c_vertices[i] += from.coarser_c_vertices[i];
      to.subdivided_c_vertices += from.subdivided_c_vertices;
      to.added_c_vertices += from.added_c_vertices;
      to.max_subdivision_depth = std::max(to.max_subdivision_depth, from.max_subdivision_depth);
      add(from.coarsening, to.coarsening);
      add_times(from, to);
      euler += from.reference.euler_characteristic;
    }
    to.c_vertices -= duplicates_;
    // Vertices and edges of a seam are counted in each of their blocks.
    euler += static_cast<std::int64_t>(seam_edges_) - static_cast<std::int64_t>(duplicates_);
    for (std::size_t l = 0; l < levels_; ++l) {
      control_.report("check", static_cast<double>(l) / static_cast<double>(levels_));
      describe_level(l, euler, to.levels.emplace_back());
    }
    to.reference = to.levels.front().topology;
    to_output_space(out_.hierarchy.positions);
    for (Hierarchy::Level& level : out_.hierarchy.levels) {
      to_output_space(level.own_positions);
      if (options_.space != Space::voxel && plan_.grid().mirrored()) {
        for (Triangle& t : level.triangles) std::swap(t[1], t[2]);
      }
    }
    if (const Vec3 origin = float32_origin(plan_.grid(), options_.space); origin != Vec3{})
      out_.hierarchy.float32_origin = origin;
  }

  static void add(const CertificateReport& from, CertificateReport& to) {
    to.passed = from.passed && (to.passed || to.cells_checked == 0);
    to.cells_checked += from.cells_checked;
    to.arcs_checked += from.arcs_checked;
    to.triples_checked += from.triples_checked;
    to.repair_rounds = std::max(to.repair_rounds, from.repair_rounds);
    to.repair_sites += from.repair_sites;
  }

  static void add_times(const ExtractReport& from, ExtractReport& to) {
    to.total_seconds += from.total_seconds;
    for (const StageTime& time : from.seconds) {
      const auto same = ranges::find(to.seconds, time.stage, &StageTime::stage);
      if (same == to.seconds.end())
        to.seconds.push_back(time);
      else
        same->seconds += time.seconds;
    }
  }

  Vec3 in_space(const Vec3& index) const { return to_space(plan_.grid(), options_.space, index); }
  void to_output_space(std::vector<Vec3>& positions) const {
    if (options_.space == Space::voxel) return;
    for (Vec3& p : positions) p = in_space(p);
  }

  // Checks a level of the merged mesh and adds up the reports of the blocks about it.
  void describe_level(std::size_t l, std::int64_t euler, LevelReport& to) {
    TriangleMesh mesh = out_.hierarchy.mesh(l);
    const MeshTopology topology = mesh_topology(mesh, control_);
    if (!topology.is_manifold() || !topology.is_oriented() || topology.unused_vertices > 0 ||
        topology.euler_characteristic() != euler)
      throw Error(ErrorCode::internal,
                  "the merged mesh of level " + std::to_string(l) +
                      " does not have the topology of the isosurface; please report the volume, "
                      "the options and the blocks");
    to.topology = summarize(topology.components);
    to.vertices = mesh.positions.size();
    to.triangles = mesh.triangles.size();
    const Space space = options_.space;
    TriangleMesh world = space == Space::voxel ? mesh : TriangleMesh{};
    TriangleMesh& measured = space == Space::voxel ? world : mesh;
    transform_to(measured, plan_.grid(), space == Space::voxel ? Space::lps : space);
    to.quality = mesh_quality(measured, control_);
    to.extent = summarize(extents_of(measured, mesh, topology, control_));
    fill_self_intersections(mesh, to, control_);
    std::vector<ShapeObstacle> obstacles(mesh.positions.size(), ShapeObstacle::none);
    if (l > 0)
      std::fill_n(obstacles.begin(), out_.hierarchy.levels[l - 1].vertex_count,
                  ShapeObstacle::earlier_level);
    const LevelGoal& goal = l == 0 ? options_.coarse : options_.refine[l - 1];
    to.bad_triangles = bad_triangles(measured, mesh, obstacles, goal);
    for (const BlockMesh& m : meshes_) add_level(m.report.levels[l], to);
    include_distances(out_.hierarchy.levels[l].distance, to);
    finish_sums(l, to);
  }

  void add_level(const LevelReport& from, LevelReport& to) const {
    add(from.certificate, to.certificate);
    to.inverted_components += from.inverted_components;
    to.refine_rounds = std::max(to.refine_rounds, from.refine_rounds);
    to.flips += from.flips;
    to.moves += from.moves;
    to.displacements += from.displacements;
    to.sites_for_intersections += from.sites_for_intersections;
    to.seconds += from.seconds;
    for (CellAtLimit cell : from.at_limit) {
      cell.position = in_space(cell.position);
      to.at_limit.push_back(cell);
    }
    if (from.metrics) {
      if (!to.metrics) to.metrics.emplace();
      for (std::size_t k = 0; k < kMetricCount; ++k) {
        MetricSummary& sum = (*to.metrics)[k];
        sum.maximum = std::max(sum.maximum, (*from.metrics)[k].maximum);
        sum.mean += (*from.metrics)[k].mean * static_cast<double>(from.vertices);
      }
    }
    add_constraints(from.constraints, to.constraints);
  }

  // Distances can have become larger near removed vertices, but not larger than their bounds.
  static void include_distances(std::span<const float> distance, LevelReport& to) {
    if (distance.empty()) return;
    const double largest = *std::max_element(distance.begin(), distance.end());
    constexpr auto kMaxDistance = static_cast<std::size_t>(Quantity::max_distance);
    if (to.metrics) {
      double& maximum = (*to.metrics)[kMaxDistance].maximum;
      maximum = std::max(maximum, largest);
    }
    for (ConstraintResult& result : to.constraints) {
      if (result.constraint.quantity == Quantity::max_distance)
        result.reached = std::max(result.reached, largest);
    }
  }

  // The result of the block that is farthest from satisfying a constraint is that of the whole.
  static void add_constraints(const std::vector<ConstraintResult>& from,
                              std::vector<ConstraintResult>& to) {
    to.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
      const bool is_lower = is_lower_bound(from[i].constraint.quantity);
      const bool is_first = to[i].constraint.bound == 0;
      const bool is_worse =
          is_lower ? from[i].reached < to[i].reached : from[i].reached > to[i].reached;
      if (is_first || is_worse) to[i] = from[i];
    }
  }

  void finish_sums(std::size_t l, LevelReport& to) const {
    double cells = 0;
    bool is_proved = true;
    double at_most = 0;
    for (const BlockMesh& m : meshes_) {
      const LevelReport& from = m.report.levels[l];
      cells += static_cast<double>(from.vertices);
      is_proved = is_proved && from.distance_at_most.has_value();
      at_most = std::max(at_most, from.distance_at_most.value_or(0));
    }
    if (is_proved) to.distance_at_most = at_most;
    if (to.metrics) {
      for (MetricSummary& sum : *to.metrics) sum.mean /= cells;
    }
    std::stable_sort(
        to.at_limit.begin(), to.at_limit.end(),
        [](const CellAtLimit& a, const CellAtLimit& b) { return a.excess > b.excess; });
  }

  const BlockPlan& plan_;
  SharedPlanes planes_;
  std::vector<BlockMesh> meshes_;  // by block; only those with a surface
  ExtractOptions options_;
  const RunControl& control_;
  const SamplesOfBlock& samples_of_;
  std::size_t levels_ = 0;
  std::vector<SeamVertex> seam_;
  std::vector<std::vector<std::uint32_t>> number_;  // per mesh and vertex, its vertex of the result
  std::vector<std::uint32_t> vertex_count_;         // per level
  std::vector<std::uint8_t> is_on_seam_;            // per vertex of the result
  std::size_t seam_vertices_ = 0, duplicates_ = 0, seam_edges_ = 0, removed_ = 0;
  Extraction out_;
};

}  // namespace

Extraction merge_blocks(const BlockPlan& plan, std::vector<BlockMesh> meshes,
                        const ExtractOptions& options, const RunControl& control,
                        const SamplesOfBlock& samples_of) {
  const ThreadLimit threads(control.threads);
  return Merger(plan, std::move(meshes), options, control, samples_of).run();
}

}  // namespace isoatlas
