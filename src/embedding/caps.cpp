// SPDX-License-Identifier: Apache-2.0
#include "embedding/caps.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/ranges.h"
#include "embedding/edges_on_box.h"
#include "geometry/triangulate_region.h"

namespace isoatlas::detail {
namespace {

// Caps the six faces of the box.
class Capper {
 public:
  Capper(std::span<const Vec3> positions, std::span<const Triangle> triangles,
         std::span<const ComponentId> component_of, const CapReference& reference, Vec3 spacing)
      : positions_(positions),
        triangles_(triangles),
        component_of_(component_of),
        reference_(reference),
        spacing_(spacing),
        faces_of_(faces_of_vertices(positions, reference.box)) {}

  Caps run() {
    corner_id_.fill(kNone);
    for (unsigned k = 0; k < 8; ++k) {
      if (!reference_.corner_is_inside[k]) continue;
      corner_id_[k] = static_cast<std::uint32_t>(positions_.size() + out_.corners.size());
      out_.corners.push_back(reference_.box.corner(k));
    }
    for (const EdgeOnBox& edge : edges_on_box(faces_of_, triangles_)) {
      if (!edge.is_boundary) continue;
      const unsigned face = faces_of_[edge.from] & faces_of_[edge.to];
      sides_[static_cast<std::size_t>(std::countr_zero(face))].push_back({edge.to, edge.from});
    }
    for (int face = 0; face < 6; ++face) cap(face);
    if (out_.faulty.empty()) check_parts();
    ranges::sort_unique(out_.faulty);
    return std::move(out_);
  }

 private:
  Vec3 position(std::uint32_t v) const {
    return v < positions_.size() ? positions_[v] : out_.corners[v - positions_.size()];
  }
  // The axes of a face's plane, in the order in which the box is on the far side of the plane.
  static std::pair<int, int> axes(int face) {
    const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
    return face % 2 == 1 ? std::pair(u, v) : std::pair(v, u);
  }

  void cap(int face) {
    const auto f = static_cast<std::size_t>(face);
    std::vector<RegionSide> sides = sides_[f];
    if (!add_perimeter(face, sides)) return fail(f);
    if (sides.empty()) return;
    // The points of this face alone, renumbered.
    std::vector<std::uint32_t> vertices;
    for (const RegionSide& side : sides) vertices.insert(vertices.end(), side.begin(), side.end());
    ranges::sort_unique(vertices);
    const auto number = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(ranges::lower_bound(vertices, v) - vertices.begin());
    };
    for (RegionSide& side : sides) side = {number(side[0]), number(side[1])};
    const auto [u, v] = axes(face);
    std::vector<PlanePoint> points;
    for (const std::uint32_t p : vertices)
      points.push_back({coordinate(position(p), u), coordinate(position(p), v)});
    const auto found =
        triangulate_region(points, sides, {coordinate(spacing_, u), coordinate(spacing_, v)});
    if (!found) return fail(f);
    for (const Triangle& t : *found)
      out_.triangles.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
  }

  // The mesh must be finer along its boundary on this face.
  void fail(std::size_t face) {
    for (const RegionSide& side : sides_[face])
      out_.faulty.insert(out_.faulty.end(), side.begin(), side.end());
    if (!sides_[face].empty()) return;
    for (std::uint32_t v = 0; v < faces_of_.size(); ++v) {
      if (faces_of_[v] >> face & 1) out_.faulty.push_back(v);
    }
  }

  // Adds the parts of the face's four edges that are inside, counter-clockwise as seen from outside
  // the box. Each vertex of the mesh on such an edge is a place where the surface crosses it.
  // @return false if these crossings contradict the corners
  bool add_perimeter(int face, std::vector<RegionSide>& sides) const {
    const auto [u, v] = axes(face);
    const unsigned level = face % 2 == 1 ? 1u << (face / 2) : 0;
    const std::array<unsigned, 4> corners{level, level | 1u << u, level | 1u << u | 1u << v,
                                          level | 1u << v};
    for (std::size_t k = 0; k < 4; ++k) {
      const unsigned a = corners[k], b = corners[(k + 1) % 4];
      std::uint32_t last = corner_id_[a];
      bool is_inside = last != kNone;
      for (const std::uint32_t crossing : crossings_between(a, b)) {
        if (is_inside) sides.push_back({last, crossing});
        is_inside = !is_inside;
        last = crossing;
      }
      if (is_inside != (corner_id_[b] != kNone)) return false;
      if (is_inside) sides.push_back({last, corner_id_[b]});
    }
    return true;
  }
  // The vertices of the mesh on an edge of the box, in the order from a to b.
  std::vector<std::uint32_t> crossings_between(unsigned a, unsigned b) const {
    const int axis = std::countr_zero(a ^ b);
    const unsigned faces = reference_.box.containing(reference_.box.corner(a)) &
                           reference_.box.containing(reference_.box.corner(b));
    std::vector<std::uint32_t> out;
    for (std::uint32_t p = 0; p < faces_of_.size(); ++p) {
      if ((faces_of_[p] & faces) == faces) out.push_back(p);
    }
    const bool runs_up = (b >> axis & 1) != 0;
    ranges::sort(out, [&](std::uint32_t p, std::uint32_t q) {
      const double x = coordinate(positions_[p], axis), y = coordinate(positions_[q], axis);
      return runs_up ? x < y : y < x;
    });
    return out;
  }

  // Compares the parts with the reference: which components they consist of, and their Euler
  // characteristics.
  void check_parts() {
    const std::size_t n = reference_.topology.size();
    const auto vertices = static_cast<std::uint32_t>(positions_.size() + out_.corners.size());
    DisjointSets connected(vertices);
    for (const std::span<const Triangle> list :
         {triangles_, std::span(std::as_const(out_.triangles))}) {
      for (const Triangle& t : list) {
        connected.unite(t[0], t[1]);
        connected.unite(t[1], t[2]);
      }
    }
    std::vector<std::uint32_t> part_of_set(vertices, kNone);  // per representative
    std::vector<std::uint32_t> set_of_part(n, kNone);
    std::vector<std::uint8_t> is_wrong(n, 0);
    const auto part_of_vertex = [&](std::uint32_t v) {
      return reference_.part_of[component_of_[v]];
    };
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      const std::uint32_t part = part_of_vertex(v), set = connected.find(v);
      if (part_of_set[set] == kNone) part_of_set[set] = part;
      if (set_of_part[part] == kNone) set_of_part[part] = set;
      if (part_of_set[set] != part) is_wrong[part] = is_wrong[part_of_set[set]] = 1;
      if (set_of_part[part] != set) is_wrong[part] = 1;
    }
    const auto part_with = [&](std::uint32_t v) {
      const std::uint32_t part = part_of_set[connected.find(v)];
      return part != kNone ? part : reference_.whole_box;
    };
    std::vector<std::int64_t> euler(n, 0);
    for (std::uint32_t v = 0; v < vertices; ++v) {
      if (const std::uint32_t part = part_with(v); part != kNone) ++euler[part];
    }
    // A closed mesh has 3/2 edges per triangle: V - E + F = V - F / 2.
    std::vector<std::int64_t> count(n, 0);
    const auto count_triangles = [&](std::span<const Triangle> triangles) {
      for (const Triangle& t : triangles) {
        if (const std::uint32_t part = part_with(t[0]); part != kNone) ++count[part];
      }
    };
    count_triangles(triangles_);
    count_triangles(out_.triangles);
    for (std::size_t part = 0; part < n; ++part) {
      if (2 * euler[part] - count[part] != 2 * reference_.topology[part].euler_characteristic)
        is_wrong[part] = 1;
    }
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      if (faces_of_[v] != 0 && is_wrong[part_of_vertex(v)] != 0) out_.faulty.push_back(v);
    }
  }

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  std::span<const ComponentId> component_of_;
  const CapReference& reference_;
  Vec3 spacing_;
  std::vector<std::uint8_t> faces_of_;  // per vertex, the faces that contain it
  std::array<std::uint32_t, 8> corner_id_{};
  std::array<std::vector<RegionSide>, 6> sides_;
  Caps out_;
};

}  // namespace

CapReference make_cap_reference(const SurfaceComplex& closed, const Components& parts,
                                std::span<const std::uint32_t> part_of,
                                std::span<const std::uint8_t> is_dropped, const BoxFaces& box) {
  const auto is_kept = [&](std::size_t c) { return is_dropped.empty() || is_dropped[c] == 0; };
  CapReference out;
  out.box = box;
  constexpr std::uint32_t kDropped = kNone - 1;
  std::vector<std::uint32_t> number(parts.topology.size(), kNone);  // of kept parts
  std::vector<std::uint8_t> has_component(parts.topology.size(), 0);
  for (const std::uint32_t part : part_of) {
    number[part] = kDropped;
    has_component[part] = 1;
  }
  for (std::size_t c = 0; c < part_of.size(); ++c) {
    if (is_kept(c)) number[part_of[c]] = kNone;
  }
  for (std::size_t part = 0; part < number.size(); ++part) {
    if (number[part] == kDropped) continue;
    number[part] = static_cast<std::uint32_t>(out.topology.size());
    if (has_component[part] == 0) out.whole_box = number[part];
    out.topology.push_back(parts.topology[part]);
  }
  for (std::size_t c = 0; c < part_of.size(); ++c) {
    if (is_kept(c)) out.part_of.push_back(number[part_of[c]]);
  }
  for (CVertexId v = 0; v < closed.c_vertex_count(); ++v) {
    if (std::popcount(box.containing(closed.positions[v])) < 3) continue;
    for (unsigned k = 0; k < 8; ++k) {
      if (closed.positions[v] == box.corner(k) && number[parts.of_c_vertex[v]] != kDropped)
        out.corner_is_inside[k] = true;
    }
  }
  return out;
}

std::vector<std::uint32_t> vertices_that_prevent_caps(std::span<const Vec3> positions,
                                                      std::span<const Triangle> triangles,
                                                      const BoxFaces& box) {
  const std::vector<std::uint8_t> faces_of = faces_of_vertices(positions, box);
  std::vector<std::uint32_t> out;
  for (const EdgeOnBox& edge : edges_on_box(faces_of, triangles)) {
    const int faces = std::popcount(static_cast<unsigned>(faces_of[edge.from] & faces_of[edge.to]));
    if (edge.is_boundary ? faces == 1 : faces == 0) continue;
    out.push_back(edge.from);
    out.push_back(edge.to);
  }
  // A triangle with three boundary edges would be its own cap.
  for (const auto& [a, b, c] : triangles) {
    if ((faces_of[a] & faces_of[b] & faces_of[c]) != 0) out.insert(out.end(), {a, b, c});
  }
  ranges::sort_unique(out);
  return out;
}

Caps make_caps(std::span<const Vec3> positions, std::span<const Triangle> triangles,
               std::span<const ComponentId> component_of, const CapReference& reference,
               Vec3 spacing) {
  return Capper(positions, triangles, component_of, reference, spacing).run();
}

}  // namespace isoatlas::detail
