// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/slack_rows.h"
#include "core/vector_math.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// A half-edge collapse: `vertex` is moved onto `target`, its neighbour, and the triangles with
/// both are removed.
struct Collapse {
  std::uint32_t vertex = kNone, target = kNone;
};

/// A triangle that a collapse has changed, and what it was before.
using ChangedTriangle = std::pair<std::uint32_t, Triangle>;

/// A triangle mesh, an oriented manifold with or without boundary, from which vertices are removed
/// by half-edge collapses. Triangles keep their ids; one that was removed has three equal corners.
class CollapsingMesh {
 public:
  /// @param positions  in sample-index coordinates; must outlive the mesh
  /// @cost  O(V + T)
  CollapsingMesh(std::span<const Vec3> positions, std::vector<Triangle> triangles, Vec3 spacing);

  std::span<const Triangle> triangles() const { return triangles_; }
  const Triangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  static bool is_removed(const Triangle& t) { return t[0] == t[1]; }
  /// The ids of the triangles with a corner at a vertex; none if it was removed.
  std::span<const std::uint32_t> star(std::uint32_t v) const { return star_.row(v); }
  Vec3 point(std::uint32_t v) const { return to_metric(positions_[v], spacing_); }
  std::span<const Vec3> positions() const { return positions_; }
  bool is_on_boundary(std::uint32_t v) const { return is_on_boundary_[v] != 0; }

  /// @return the changed triangles
  std::vector<ChangedTriangle> apply(const Collapse& collapse);
  /// Undoes a collapse. Others that were applied since remain, if no triangle was changed by both.
  void revert(const Collapse& collapse, std::span<const ChangedTriangle> changed);

 private:
  std::span<const Vec3> positions_;
  std::vector<Triangle> triangles_;
  Vec3 spacing_;
  SlackRows<std::uint32_t> star_;
  std::vector<std::uint8_t> is_on_boundary_;
};

/// The link of a vertex: the edges opposite it in its triangles.
class Link {
 public:
  struct Edge {
    std::uint32_t from, to;
  };

  /// Finds the edges opposite `v` in its triangles.
  void set(const CollapsingMesh& mesh, std::uint32_t v);

  std::span<const Edge> edges() const { return edges_; }
  std::span<const std::uint32_t> vertices() const { return vertices_; }  ///< sorted

  /// Whether the mesh remains a manifold of the same topology if the vertex is moved onto
  /// `target`, one of vertices(): the link condition. Vertices of the boundary move along it.
  /// @source Dey, Edelsbrunner, Guha, Nekhayev, Topology preserving edge contraction, 1999
  bool permits(const CollapsingMesh& mesh, std::uint32_t target);

 private:
  std::uint32_t v_ = kNone;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> vertices_, opposite_;
};

}  // namespace isoatlas::detail
