// SPDX-License-Identifier: Apache-2.0
// Parses the constraints of levels from the arguments of the command line.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// A constraint as typed. If its bound is a length in voxels or has a unit, the volume is needed to
/// convert it to world units.
struct TypedConstraint {
  Quantity quantity;
  double bound = 0;
  bool in_voxels = false;
  bool is_default = false;                ///< not typed; in voxels of default_voxel()
  LengthUnit unit = LengthUnit::unknown;  ///< the unit of a length, if it was typed

  /// @throws Error(bad_argument) if the volume states no unit to convert to
  Constraint in_world(const Grid& grid) const;
  friend bool operator==(const TypedConstraint&, const TypedConstraint&) = default;
};

/// Parses the bound of a quantity: "0.5vx", "2mm" or "2" (in the world's unit); "1.1"; "15deg" or
/// "15"; "2000".
/// @throws Error(bad_argument) if the text is not a bound of the quantity
TypedConstraint parse_bound(Quantity quantity, std::string_view text);

/// Parses the value of --refine: METRIC:BOUND[,METRIC:BOUND...]. Throws Error(bad_argument).
std::vector<TypedConstraint> parse_level(std::string_view spec);

/// One --refine of the command line, or one option with a constraint for all levels.
struct GoalArgument {
  bool is_level = false;  ///< true: a --refine; false: an option with one constraint
  std::vector<TypedConstraint> constraints;
};

/// The constraints of all levels, in order of priority.
struct TypedGoals {
  std::vector<TypedConstraint> coarse;               ///< level 0
  std::vector<std::vector<TypedConstraint>> refine;  ///< levels 1, 2, ...
};

/// Collects the constraints of each level in order of priority: the options before its --refine,
/// its own constraints, the options after its --refine.
///
/// Without --refine there is one refined level; unless the options name a metric, its two-sided
/// distance is bounded by half a default_voxel(). With `only_coarse` there is no refined level, and
/// the options are constraints of level 0. With a number of levels (ExtractOptions::levels), the
/// one refined level is the finest of them.
/// @param arguments  in the order of the command line
/// @throws Error(bad_argument) if a level has a quantity twice, `only_coarse` or `levels` is
/// combined
///         with a --refine or with each other, or the finest of `levels` has no bound on the
///         distance
TypedGoals plan_levels(const std::vector<GoalArgument>& arguments, bool only_coarse,
                       std::uint32_t levels = 0);

/// Converts all lengths to world units.
LevelGoal in_world(const std::vector<TypedConstraint>& goal, const Grid& grid);

}  // namespace isoatlas::detail
