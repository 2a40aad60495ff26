// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling of a surface complex: more c-vertices where it is too coarse, and only there.
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
  SurfaceComplex complex;         ///< the old c-vertices with their numbers and positions, then the new ones
  std::vector<CVertexId> origin;  ///< per new c-vertex, an old one of the same component
  /// Per new c-vertex that divides a side within a grid cell, the ends of that side; else kNone.
  std::vector<std::array<CVertexId, 2>> between;
  /// The corners of the faces that were replaced, each once; only of subdivide_in_place().
  std::vector<CVertexId> touched;
};

/// How near new c-vertices are, at most, to walls of their cell that they are not on; steps of the sample index.
inline constexpr double kWallMargin = 0.03;

/// Few enough binary digits for the middle of two such points in one grid cell, and the middles of these, to be exact: 49, but none below
/// 2^-32. (One more where the exponents of the two differ.)
inline double rounded(double coordinate) {
  constexpr double kScale = 0x1p32, kReach = 0x1p17;
  const double scale = std::fabs(coordinate) < kReach ? kScale : std::ldexp(1.0, 48 - std::ilogb(coordinate));
  return std::round(coordinate * scale) / scale;
}

/// @param position  sample-index coordinates, of the upsampled samples if there are any
inline Vec3 rounded(Vec3 position) { return {rounded(position.x), rounded(position.y), rounded(position.z)}; }

/// Where a c-vertex is that was moved: in sample-index coordinates, to the last bit as everything else has it.
/// @param shift  how far it was moved, spacing applied
inline Vec3 displaced(const SurfaceComplex& complex, CVertexId v, Vec3 shift) {
  const Vec3 p = complex.positions[v], s = complex.spacing;
  return shift == Vec3{} ? p : rounded({p.x + shift.x / s.x, p.y + shift.y / s.y, p.z + shift.z / s.z});
}

/// How the faces around a c-vertex lie in the grid, each step finer than the one before.
enum class Fineness : std::uint8_t {
  faces,   ///< some are as they were parsed
  fans,    ///< triangles about nodes; what of such a triangle is in one cell is a piece of a cone about the cell's c-vertex
  pieces,  ///< triangles that are each in one cell, with its walls
};

/// What subdivision has to know besides the complex.
struct SurfaceInGrid {
  const InterpolatedField& field;         ///< whose zero set the surface is
  std::span<const std::uint8_t> crowded;  ///< per c-vertex, 1 if there are others in its grid cell; those that are missing have none
  const RunControl* control = nullptr;    ///< looked at now and then, if there is one
};

std::vector<Fineness> fineness(const SurfaceComplex& complex, const SurfaceInGrid& in);  ///< per c-vertex; O(F)
/// Of some c-vertices, one by one: cheaper, since only the faces around these are looked at closely. O(F) with a small constant
std::vector<Fineness> fineness(const SurfaceComplex& complex, const SurfaceInGrid& in, std::span<const CVertexId> of);

/// Divides all faces around some c-vertices, to the next fineness; the others stay, so the result is a subdivision, homeomorphic to the
/// input.
///
/// faces -> fans: a face around a node becomes a fan about the node. A side that crosses a wall with two curves, or beside a crowded cell,
/// is divided where the surface crosses the wall half-way between its nodes. fans -> pieces: so are all other sides that cross walls.
/// pieces: sides are divided at their middles, which move onto the surface but not out of their cell or wall.
///
/// @param wanted  c-vertices, in any order
/// @param now     the fineness of all, per c-vertex
/// @cost  O(F), plus the divided faces times the logarithm of their number
Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted, std::span<const Fineness> now,
                      const SurfaceInGrid& in);
inline Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted, const SurfaceInGrid& in) {
  return subdivide(complex, wanted, fineness(complex, in), in);
}

/// The faces around some c-vertices and around their neighbours, as a complex of their own. Numbers are in the order of those of the whole.
struct ComplexPart {
  SurfaceComplex complex;             ///< its rim is no boundary
  std::vector<CVertexId> c_vertex;    ///< per c-vertex of the part, that of the whole
  std::vector<FaceId> face;           ///< the same of faces
  std::vector<std::uint32_t> side;    ///< the same of boundary sides
  std::vector<CVertexId> wanted;      ///< the c-vertices, numbered in the part
  std::vector<Fineness> fineness;     ///< per c-vertex of the part
  std::vector<std::uint8_t> crowded;  ///< per c-vertex of the part

  /// @cost  O(F) with a small constant
  ComplexPart(const SurfaceComplex& whole, std::span<const CVertexId> around, std::span<const Fineness> now,
              std::span<const std::uint8_t> is_crowded, const RunControl* control = nullptr);
  /// subdivide() of the part, around the c-vertices. The same as of the whole, but for the numbers.
  Subdivision subdivided(const SurfaceInGrid& in) const { return subdivide(complex, wanted, fineness, {in.field, crowded, in.control}); }
};

/// subdivide() in place. Faces that were replaced have the number of their first piece; everything new comes last.
/// @return with the numbers of the whole, and without a complex
/// @cost  O(F) with a small constant, plus what is divided
Subdivision subdivide_in_place(SurfaceComplex& whole, std::span<const CVertexId> wanted, std::span<const Fineness> now,
                               const SurfaceInGrid& in);

/// Whether the samples at the corners of a wall have alternating signs, so that two curves cross it.
/// @param point  on the wall, but not on its edges
bool has_two_curves(const InterpolatedField& field, Vec3 point);

}  // namespace isoatlas::detail
