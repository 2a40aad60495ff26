// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "complex/components.h"
#include "core/nesting.h"
#include "embedding/crowded_cells.h"
#include "embedding/subdivide.h"
#include "embedding/watched_cells.h"

namespace isoatlas::detail {

/// The reference surface, with more c-vertices wherever some stage found it too coarse. It stays the same surface: c-vertices keep their
/// numbers, components theirs. Divided everywhere it does not meet itself, wherever in their cells its c-vertices are moved, as far as
/// may_roam() and stray() allow that (docs/theory/06-self-intersections.md).
class AdaptiveSurface {
 public:
  /// @pre the complex is as it was parsed. Its c-vertices are moved where several surfels of one cell would meet.
  /// @param control  asked whether to stop, and told that the work goes on, here and in divide()
  AdaptiveSurface(SurfaceComplex complex, Components components, Nesting nesting, InterpolatedField field, const RunControl& control = {});

  const SurfaceComplex& complex() const { return complex_; }
  const Components& components() const { return components_; }
  const Nesting& nesting() const { return nesting_; }  ///< of the components
  const InterpolatedField& field() const { return field_; }
  /// Per c-vertex, the place of the surface where it was found, before it was moved; sample-index coordinates.
  std::span<const Vec3> found() const { return found_; }
  const RunControl& control() const { return control_; }  ///< for work that is part of a stage

  std::vector<Fineness> fineness() const {
    return isoatlas::detail::fineness(complex_, {field_, crowded_.flags(), &control_});
  }  ///< per c-vertex; O(F)
  /// Of some c-vertices, one by one. O(F) with a small constant
  std::vector<Fineness> fineness(std::span<const CVertexId> of) const {
    return isoatlas::detail::fineness(complex_, {field_, crowded_.flags(), &control_}, of);
  }

  /// See subdivide(). What was derived from the complex has to be made anew. Where smaller pieces would meet each other in a cell, they are
  /// left flat. C-vertices there that hardly keep off the walls of their cells, for good triangles, are moved a little.
  /// @param pinned  these are not. O(F)
  void divide(std::span<const CVertexId> wanted, std::span<const CVertexId> pinned = {});
  /// The c-vertices that were there before the last divide() and have other faces or another place since.
  std::span<const CVertexId> touched() const { return touched_; }

  /// Gives a c-vertex another place in its grid cell; for good, if vertices are there.
  void move(CVertexId v, Vec3 position) { complex_.positions[v] = rounded(position); }

  /// Whether a vertex may leave its c-vertex, within the grid cell, or on the wall or edge that it is on. Callers must also
  /// check the result of stray().
  bool may_roam(CVertexId v) const { return !held_[v]; }
  /// Those of the moved c-vertices that must not be where they are: surfels or pieces in their cells would intersect. With these back where
  /// they were, none do, if none did before.
  /// @param moved      c-vertices, each once
  /// @param before     where each of them was
  /// @param positions  per c-vertex of the complex, where it is now; the same again at the end
  /// @param look       the cells of these are looked at: those that have moved since no surfels intersected
  /// @cost  the cells around what moved
  std::vector<CVertexId> stray(std::span<const CVertexId> moved, std::span<const Vec3> before, std::span<Vec3> positions,
                               std::span<const CVertexId> look) const;

  std::size_t divided() const { return divided_; }  ///< c-vertices around which the faces were divided, every time counted
  std::size_t added() const { return added_; }      ///< c-vertices
  int deepest() const { return deepest_; }          ///< how often faces were divided where that was done most often

 private:
  void watch();
  std::vector<CVertexId> with_crowded_cells(std::span<const CVertexId> wanted) const;
  void keep_off_walls(std::span<const CVertexId> wanted, std::span<const CVertexId> pinned);
  void divide_once(std::span<const CVertexId> wanted, const std::vector<Fineness>& was);
  void flatten_where_pieces_meet(const Subdivision& divided, CVertexId first_new);

  SurfaceComplex complex_;
  Components components_;
  Nesting nesting_;
  InterpolatedField field_;
  RunControl control_;
  CrowdedCells crowded_;
  WatchedCells watched_;
  std::vector<WatchedCells::Cell> deep_cells_;  // with pieces of pieces
  std::vector<Vec3> found_;
  std::vector<CVertexId> touched_;
  CVertexId parsed_;                     // c-vertices before this one were parsed
  std::vector<std::uint8_t> depth_;      // per c-vertex, which division brought it
  std::vector<std::uint8_t> held_;       // per c-vertex
  std::vector<std::uint8_t> is_closed_;  // per c-vertex, 1 if inside a crowded cell that is not in pieces yet
  std::size_t divided_ = 0, added_ = 0;
  int deepest_ = 0;
};

}  // namespace isoatlas::detail
