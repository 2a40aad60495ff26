// SPDX-License-Identifier: Apache-2.0
// What the levels of detail have to be, from the words of the command line.
#pragma once

#include <string_view>
#include <vector>

#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// A constraint as typed: its bound may be a length in voxels, which needs the volume to become a
/// length.
struct TypedConstraint {
  Quantity quantity;
  double bound = 0;
  bool in_voxels = false;
  bool is_default = false;                ///< nobody typed it; in voxels of default_voxel()
  LengthUnit unit = LengthUnit::unknown;  ///< of a length that states one

  /// @throws Error(bad_argument) if the volume states no unit to convert to
  Constraint in_world(const Grid& grid) const;
  friend bool operator==(const TypedConstraint&, const TypedConstraint&) = default;
};

/// The bound of one quantity: "0.5vx", "2mm" or "2" (the world's unit); "1.1"; "15deg" or "15";
/// "2000".
/// @throws Error(bad_argument) if the quantity cannot have it
TypedConstraint parse_bound(Quantity quantity, std::string_view text);

/// What --refine takes: METRIC:BOUND[,METRIC:BOUND...]. Throws Error(bad_argument).
std::vector<TypedConstraint> parse_level(std::string_view spec);

/// One use of --refine, or one option that holds for all levels (then with a single constraint).
struct GoalArgument {
  bool is_level = false;
  std::vector<TypedConstraint> constraints;
};

struct TypedGoals {
  std::vector<TypedConstraint> coarse;               ///< of level 0
  std::vector<std::vector<TypedConstraint>> refine;  ///< of the levels after it
};

/// Sorts the arguments, which come in the order of the command line, into goals: for each level the
/// options before its
/// --refine, its own constraints, the options after it; earlier means more important.
///
/// Without a --refine there is one level, within half a default_voxel() of the surface unless the
/// options name a metric; with `only_coarse` there is none, and the options are about level 0.
/// @throws Error(bad_argument) if a level has a quantity twice, or only_coarse stands beside a
/// --refine
TypedGoals plan_levels(const std::vector<GoalArgument>& arguments, bool only_coarse);

/// With the lengths of a volume.
LevelGoal in_world(const std::vector<TypedConstraint>& goal, const Grid& grid);

}  // namespace isoatlas::detail
