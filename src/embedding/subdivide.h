// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling of a surface complex: adds c-vertices only where it is too coarse.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "field/interpolated_field.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

struct Subdivision {
  SurfaceComplex complex;  ///< the old c-vertices with their ids and positions, then the new ones
  std::vector<CVertexId> origin;  ///< per new c-vertex, an old one of the same component
  /// Per new c-vertex that splits a side within a grid cell, the ends of that side; otherwise
  /// kNone.
  std::vector<std::array<CVertexId, 2>> between;
  /// The corners of the replaced faces, each once; only set by subdivide_in_place().
  std::vector<CVertexId> touched;
};

/// The smallest distance of new c-vertices from walls of their grid cell that they are not on; in
/// sample-index units.
inline constexpr double kWallMargin = 0.03;

/// Rounds to so few binary digits that the midpoint of two such points in one grid cell, and the
/// midpoints of these, are exact: 49 digits, but none below 2^-32. (One more digit where the
/// exponents of the two points differ.)
inline double rounded(double coordinate) {
  constexpr double kScale = 0x1p32, kReach = 0x1p17;
  const double scale =
      std::fabs(coordinate) < kReach ? kScale : std::ldexp(1.0, 48 - std::ilogb(coordinate));
  return std::round(coordinate * scale) / scale;
}

/// @param position  sample-index coordinates, of the upsampled samples if there are any
inline Vec3 rounded(Vec3 position) {
  return {rounded(position.x), rounded(position.y), rounded(position.z)};
}

/// The position of a c-vertex after a displacement, in sample-index coordinates, rounded exactly as
/// everywhere else.
/// @param displacement  metric: spacing applied
inline Vec3 displaced_position(const SurfaceComplex& complex, CVertexId v, Vec3 displacement) {
  const Vec3 p = complex.positions[v], s = complex.spacing;
  return displacement == Vec3{} ? p
                                : rounded({p.x + displacement.x / s.x, p.y + displacement.y / s.y,
                                           p.z + displacement.z / s.z});
}

/// How the faces around a c-vertex lie in the grid; each value is finer than the previous one.
enum class Fineness : std::uint8_t {
  faces,   ///< some faces are as they were parsed
  fans,    ///< triangles about nodes; the part of such a triangle in one grid cell is a piece of a
           ///< cone about the grid cell's c-vertex
  pieces,  ///< triangles that each lie in one grid cell, walls included
};

/// The input of a subdivision in addition to the complex.
struct SurfaceInGrid {
  const InterpolatedField& field;             ///< the surface is its zero set
  std::span<const std::uint8_t> multi_sheet;  ///< per c-vertex, 1 if its grid cell has several;
                                              ///< entries that are missing count as 0
  const RunControl* control = nullptr;        ///< tested for cancellation, if there is one
};

std::vector<Fineness> fineness(const SurfaceComplex& complex,
                               const SurfaceInGrid& in);  ///< per c-vertex; O(F)
/// Of some c-vertices; cheaper, since only the faces around these are examined. O(F) with a small
/// constant
std::vector<Fineness> fineness(const SurfaceComplex& complex, const SurfaceInGrid& in,
                               std::span<const CVertexId> c_vertices);

/// Subdivides all faces around some c-vertices to the next fineness and keeps the others. The
/// result is a subdivision of the input, homeomorphic to it.
///
/// faces -> fans: a face around a node becomes a fan about the node. A side that crosses a wall
/// with two curves, or is next to a multi-sheet grid cell, is split where the surface crosses the
/// wall half-way between its nodes. fans -> pieces: all other sides that cross walls are split as
/// well. pieces: sides are split at their midpoints, which move onto the surface but stay in their
/// grid cell or wall.
///
/// @param wanted    c-vertices, in any order
/// @param current   per c-vertex, its current fineness
/// @cost  O(F), plus the split faces times the logarithm of their number
Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted,
                      std::span<const Fineness> current, const SurfaceInGrid& in);
inline Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted,
                             const SurfaceInGrid& in) {
  return subdivide(complex, wanted, fineness(complex, in), in);
}

/// The faces around some c-vertices and around their neighbours, as a complex of its own, with ids
/// in the same order.
struct ComplexPart {
  SurfaceComplex complex;           ///< the outer sides of the part are not boundary sides of it
  std::vector<CVertexId> c_vertex;  ///< per c-vertex of the part, its id in the whole complex
  std::vector<FaceId> face;         ///< per face of the part, its id in the whole complex
  std::vector<std::uint32_t>
      side;                       ///< per boundary side of the part, its index in the whole complex
  std::vector<CVertexId> wanted;  ///< the c-vertices to subdivide around, as ids in the part
  std::vector<Fineness> fineness;         ///< per c-vertex of the part
  std::vector<std::uint8_t> multi_sheet;  ///< per c-vertex of the part

  /// @cost  O(F) with a small constant
  ComplexPart(const SurfaceComplex& whole, std::span<const CVertexId> around,
              std::span<const Fineness> current, std::span<const std::uint8_t> is_multi_sheet,
              const RunControl* control = nullptr);
  /// subdivide() of the part. The same result as for the whole complex, except for ids.
  Subdivision subdivided(const SurfaceInGrid& in) const {
    return subdivide(complex, wanted, fineness, {in.field, multi_sheet, in.control});
  }
};

/// subdivide() in place. The first piece of a replaced face keeps its id; all new faces and
/// c-vertices are appended.
/// @return with ids of the whole complex, and with an empty complex
/// @cost  O(F) with a small constant, plus what is subdivided
Subdivision subdivide_in_place(SurfaceComplex& whole, std::span<const CVertexId> wanted,
                               std::span<const Fineness> current, const SurfaceInGrid& in);

/// Whether the samples at the corners of a wall have alternating signs, so that two curves cross
/// it.
/// @param point  on the wall, but not on its edges
bool has_two_curves(const InterpolatedField& field, Vec3 point);

}  // namespace isoatlas::detail
