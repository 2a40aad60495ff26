// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "complex/components.h"
#include "core/nesting.h"
#include "embedding/caps.h"
#include "embedding/checked_cells.h"
#include "embedding/multi_sheet_cells.h"
#include "embedding/subdivide.h"

namespace isoatlas::detail {

/// The reference surface, with more c-vertices wherever some stage found it too coarse. It stays
/// the same surface: c-vertices keep their ids, and components theirs. If it is subdivided
/// everywhere, it has no self-intersections for all positions of its c-vertices in their grid cells
/// that is_movable() and find_conflicting_moves() allow (docs/theory/06-self-intersections.md).
class AdaptiveSurface {
 public:
  /// @pre the complex is as it was parsed. C-vertices are moved where several surfels of one grid
  ///      cell would intersect.
  /// @param control  for cancellation and progress, here and in subdivide()
  /// @param caps     present if meshes of the surface are closed by caps on the volume boundary
  /// @param shared   faces that the volume shares with other blocks, as in ParseOptions
  AdaptiveSurface(SurfaceComplex complex, Components components, Nesting nesting,
                  InterpolatedField field, const RunControl& control = {},
                  std::optional<CapReference> caps = {}, const SharedBox& shared = {});

  const SurfaceComplex& complex() const { return complex_; }
  const Components& components() const { return components_; }
  const Nesting& nesting() const { return nesting_; }  ///< of the components
  /// What the capped surface has to be; null if the surface stays open.
  const CapReference* caps() const { return caps_ ? &*caps_ : nullptr; }
  const SharedBox& shared_faces() const { return shared_; }
  const InterpolatedField& field() const { return field_; }
  /// Per c-vertex, the position on the surface where it was first placed, before any move;
  /// sample-index coordinates.
  std::span<const Vec3> original_positions() const { return original_positions_; }
  const RunControl& control() const { return control_; }  ///< for work that is part of a stage

  std::vector<Fineness> fineness() const {
    return isoatlas::detail::fineness(complex_, {field_, multi_sheet_cells_.flags(), &control_});
  }  ///< per c-vertex; O(F)
  /// Of some c-vertices. O(F) with a small constant
  std::vector<Fineness> fineness(std::span<const CVertexId> c_vertices) const {
    return isoatlas::detail::fineness(complex_, {field_, multi_sheet_cells_.flags(), &control_},
                                      c_vertices);
  }

  /// See the function of this name in subdivide.h. Everything that was derived from the complex
  /// must be rebuilt. Where smaller pieces would intersect in a grid cell, they are flatter.
  /// C-vertices there that are very close to the walls of their grid cells are moved away from them
  /// a little, for well-shaped triangles.
  /// @param fixed  c-vertices that are not moved. O(F)
  void subdivide(std::span<const CVertexId> wanted, std::span<const CVertexId> fixed = {});
  /// The c-vertices that existed before the last subdivide() and have had other faces or another
  /// position since.
  std::span<const CVertexId> touched() const { return touched_; }

  /// Moves a c-vertex within its grid cell; permanently, once vertices are placed on it.
  void move(CVertexId v, Vec3 position) { complex_.positions[v] = rounded(position); }

  /// Whether a vertex may be displaced from this c-vertex: within the grid cell, or on the wall or
  /// edge that it is on. Callers must also check the result of find_conflicting_moves(). Those on
  /// the boundary of a capped surface and on shared faces are not movable.
  bool is_movable(CVertexId v) const {
    return !fixed_[v] && complex_.on_boundary[v] < (caps_ ? kOnBoundary : kOnSharedFace);
  }
  /// Whether an edge between two vertices at these c-vertices could be on a face of the volume's
  /// box where the mesh must not have other edges than its boundary.
  bool could_be_on_closed_face(CVertexId a, CVertexId b) const {
    const std::uint8_t least = std::min(complex_.on_boundary[a], complex_.on_boundary[b]);
    return least >= (caps_ ? kOnBoundary : kOnSharedFace);
  }
  /// Finds the moves that must be reverted because surfels or pieces in a grid cell would
  /// intersect. After reverting them there are no such intersections, if there were none before.
  /// @param moved      c-vertices, each once
  /// @param before     the position of each of them before the move
  /// @param positions  per c-vertex of the complex, its position after the move; changed during the
  ///                   call and restored at its end
  /// @param check      the grid cells of these are checked: all that have moved since surfels were
  ///                   known not to intersect
  /// @cost  the grid cells around what moved
  std::vector<CVertexId> find_conflicting_moves(std::span<const CVertexId> moved,
                                                std::span<const Vec3> before,
                                                std::span<Vec3> positions,
                                                std::span<const CVertexId> check) const;

  /// Number of c-vertices around which faces were subdivided, counted each time.
  std::size_t subdivision_count() const { return subdivision_count_; }
  std::size_t added_count() const { return added_count_; }  ///< number of added c-vertices
  /// Largest depth of an added c-vertex; those from parsing have depth 0.
  int max_depth() const { return max_depth_; }

 private:
  void update_checked_cells();
  std::vector<CVertexId> with_multi_sheet_grid_cells(std::span<const CVertexId> wanted) const;
  void move_off_walls(std::span<const CVertexId> wanted, std::span<const CVertexId> fixed);
  void subdivide_once(std::span<const CVertexId> wanted, const std::vector<Fineness>& old_fineness);
  void flatten_intersecting_pieces(const Subdivision& subdivision, CVertexId first_new);

  SurfaceComplex complex_;
  Components components_;
  Nesting nesting_;
  InterpolatedField field_;
  RunControl control_;
  std::optional<CapReference> caps_;
  SharedBox shared_;
  MultiSheetCells multi_sheet_cells_;
  CheckedCells checked_cells_;
  std::vector<GridCell> grid_cells_with_small_pieces_;  // grid cells with pieces of pieces
  std::vector<Vec3> original_positions_;
  std::vector<CVertexId> touched_;
  CVertexId parsed_count_;           // c-vertices before this one come from parsing
  std::vector<std::uint8_t> depth_;  // per c-vertex, the subdivision depth at which it was added
  std::vector<std::uint8_t> fixed_;  // per c-vertex
  // Per c-vertex, 1 if it is inside a multi-sheet grid cell that is not subdivided into pieces yet.
  std::vector<std::uint8_t> is_in_unsplit_grid_cell_;
  std::size_t subdivision_count_ = 0, added_count_ = 0;
  int max_depth_ = 0;
};

}  // namespace isoatlas::detail
