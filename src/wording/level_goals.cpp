// SPDX-License-Identifier: Apache-2.0
#include "wording/level_goals.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <string>

#include "api/resolve_options.h"
#include "isoatlas/error.h"
#include "wording/values.h"

namespace isoatlas::detail {
namespace {

// A closed surface has at least the four vertices of a tetrahedron.
constexpr std::uint32_t kMinVertices = 4;

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::bad_argument, message);
}

std::string in_quotes(std::string_view text) { return std::string("'").append(text).append("'"); }

[[noreturn]] void refuse_bound(Quantity quantity, const std::string& expected,
                               std::string_view text) {
  try {
    unit(quantity) == Unit::count ? refuse_value(expected, text) : refuse_fraction(expected, text);
  } catch (const Error& error) {
    refuse(std::string(name(quantity)) + ": " + error.what());
  }
}

double parse_degrees(Quantity quantity, std::string_view text) {
  const std::string word = plain_word(text);
  std::string_view number = word;
  if (number.ends_with("deg")) number.remove_suffix(3);
  const auto degrees = parse_whole<double>(number);
  if (!degrees || !std::isfinite(*degrees) || *degrees <= 0)
    refuse_bound(quantity, "an angle above 0 like 15deg or 15", text);
  return *degrees;
}

double parse_ratio(Quantity quantity, std::string_view text) {
  const auto ratio = parse_whole<double>(text);
  if (quantity == Quantity::min_aspect) {  // shortest over longest edge
    if (!ratio || !(*ratio > 0 && *ratio < 1))
      refuse_bound(quantity, "a ratio between 0 and 1 like 0.2", text);
  } else if (!ratio || !std::isfinite(*ratio) || *ratio <= 1) {
    refuse_bound(quantity, "a ratio above 1 like 1.1", text);
  }
  return *ratio;
}

double parse_count(Quantity quantity, std::string_view text) {
  const auto count = parse_whole<std::uint32_t>(text);
  if (!count || *count < kMinVertices)
    refuse_bound(quantity, "a whole number, " + std::to_string(kMinVertices) + " or more", text);
  return *count;
}

// Refuses "max-distance:0,5vx", which would otherwise be parsed as a bound of 0 and a second
// constraint.
void require_decimal_points(std::string_view spec) {
  for (std::size_t comma = spec.find(','); comma != std::string_view::npos;
       comma = spec.find(',', comma + 1)) {
    const std::string_view entry = spec.substr(comma + 1, spec.find(',', comma + 1) - comma - 1);
    const bool is_number = !entry.empty() && entry[0] >= '0' && entry[0] <= '9' &&
                           entry.find(':') == std::string_view::npos;
    if (is_number)
      refuse("expected a decimal point before " + in_quotes(entry) + ", not a comma, in " +
             in_quotes(spec));
  }
}

Quantity parse_quantity(std::string_view text) {
  if (const auto quantity = quantity_named(plain_word(text))) return *quantity;
  std::string names;
  for (std::size_t i = 0; i < kQuantityCount; ++i)
    names += (i == 0 ? "" : ", ") + std::string(name(static_cast<Quantity>(i)));
  refuse("there is no constraint " + in_quotes(text) + ", expected one of " + names);
}

void add_default(std::vector<TypedConstraint>& goal) {
  for (const Constraint& c : default_goal())
    goal.push_back({c.quantity, c.bound, c.in_voxels, c.is_default});
}

void require_each_quantity_once(const std::vector<TypedConstraint>& goal, std::size_t level) {
  std::bitset<kQuantityCount> seen;
  for (const TypedConstraint& constraint : goal) {
    const auto index = static_cast<std::size_t>(constraint.quantity);
    if (seen[index])
      refuse(std::string(name(constraint.quantity)) + " is given twice for level " +
             std::to_string(level) + ", expected once");
    seen[index] = true;
  }
}

}  // namespace

TypedConstraint parse_bound(Quantity quantity, std::string_view text) {
  switch (unit(quantity)) {
    case Unit::length: {
      const auto length = length_of(text);
      if (!length || length->value == 0)
        refuse_bound(quantity, "a length above 0 like 0.5vx, 2mm or 2", text);
      return {quantity, length->value, length->in_voxels, false, length->unit};
    }
    case Unit::ratio:
      return {quantity, parse_ratio(quantity, text)};
    case Unit::degrees:
      return {quantity, parse_degrees(quantity, text)};
    case Unit::count:
      return {quantity, parse_count(quantity, text)};
    case Unit::number:  // the unit of custom metrics, which cannot be typed
      break;
  }
  return {quantity};
}

std::vector<TypedConstraint> parse_level(std::string_view spec) {
  require_decimal_points(spec);
  std::vector<TypedConstraint> constraints;
  for (std::string_view rest = spec;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view entry = rest.substr(0, comma);
    const std::size_t colon = entry.find(':');
    if (colon == std::string_view::npos)
      refuse("expected METRIC:BOUND[,METRIC:BOUND...] like max-distance:0.5vx, got " +
             in_quotes(entry) + (entry == spec ? "" : " in " + in_quotes(spec)));
    constraints.push_back(
        parse_bound(parse_quantity(entry.substr(0, colon)), entry.substr(colon + 1)));
    if (comma == std::string_view::npos) return constraints;
    rest.remove_prefix(comma + 1);
  }
}

TypedGoals plan_levels(const std::vector<GoalArgument>& arguments, bool only_coarse,
                       std::uint32_t levels) {
  // The goal of the level whose --refine is argument number `own`; kNone: only the options.
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  const auto goal_of = [&](std::size_t own, std::size_t level) {
    std::vector<TypedConstraint> goal;
    for (std::size_t i = 0; i < arguments.size(); ++i)
      if (!arguments[i].is_level || i == own)
        goal.insert(goal.end(), arguments[i].constraints.begin(), arguments[i].constraints.end());
    require_each_quantity_once(goal, level);
    return goal;
  };

  TypedGoals goals;
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if (arguments[i].is_level) goals.refine.push_back(goal_of(i, goals.refine.size() + 1));
  if (levels > 0 && only_coarse)
    refuse("--levels makes refined levels, expected it without --coarse");
  if (levels > 0 && !goals.refine.empty())
    refuse("--levels chooses the bounds of all levels, expected it without --refine");
  if (only_coarse) {
    if (!goals.refine.empty())
      refuse("--coarse makes only the coarsest level, expected it without --refine");
    goals.coarse = goal_of(kNone, 0);
  } else if (goals.refine.empty()) {
    std::vector<TypedConstraint> goal = goal_of(kNone, 1);
    // The default comes last, because requested constraints have priority.
    if (std::none_of(goal.begin(), goal.end(),
                     [](const TypedConstraint& c) { return is_metric(c.quantity); }))
      add_default(goal);
    if (levels > 0 && std::none_of(goal.begin(), goal.end(), [](const TypedConstraint& c) {
          return c.quantity == Quantity::max_distance;
        }))
      refuse("levels: the finest level has no bound on max-distance, expected one");
    goals.refine.push_back(std::move(goal));
  }
  return goals;
}

Constraint TypedConstraint::in_world(const Grid& grid) const {
  if (in_voxels)
    return detail::in_world(LevelGoal{Constraint{quantity, bound, is_default, true}}, grid).front();
  try {
    return {quantity, world_length(bound, unit, grid), is_default};
  } catch (const Error& error) {
    refuse(std::string(name(quantity)) + ": " + error.what());
  }
}

LevelGoal in_world(const std::vector<TypedConstraint>& goal, const Grid& grid) {
  LevelGoal result;
  for (const TypedConstraint& constraint : goal) result.push_back(constraint.in_world(grid));
  return result;
}

}  // namespace isoatlas::detail
