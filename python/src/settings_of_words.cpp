// SPDX-License-Identifier: Apache-2.0
#include "settings_of_words.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "isoatlas/error.h"

namespace isoatlas::detail::python {
namespace {

[[noreturn]] void refuse_levels(const std::string& message) {
  throw Error(ErrorCode::bad_argument, message);
}

std::string python_name(std::string name) {
  std::ranges::replace(name, '-', '_');
  return name;
}

/// Runs `work`; an error is reported for the option, by its name in Python.
template <class Work>
auto with_option_name(const std::string& name, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(error.code(), python_name(name) + ": " + error.what());
  }
}

/// Errors of parse_bound() begin with the name of the quantity on the command line.
TypedConstraint constraint_of(const std::string& name, const std::string& text) {
  const auto quantity = quantity_named(name);
  if (!quantity) return parse_level(name + ":" + text).front();  // throws: lists the quantities
  return parse_bound(*quantity, text);
}

TypedGoals goals_of(const ExtractWords& words, std::uint32_t levels) {
  if (levels > 0 && (words.coarse || !words.refine.empty()))
    refuse_levels("levels chooses the bounds of all levels, expected it without refine and coarse");
  if (words.coarse && !words.refine.empty())
    refuse_levels("coarse keeps only the coarsest level, expected it without refine");
  std::vector<GoalArgument> arguments;
  for (const auto& [name, text] : words.constraints) {
    try {
      arguments.push_back({false, {constraint_of(name, text)}});
    } catch (const Error& error) {
      const std::string message = error.what();
      throw Error(error.code(), message.starts_with(name)
                                    ? python_name(name) + message.substr(name.size())
                                    : message);
    }
  }
  for (const auto& level : words.refine) {
    GoalArgument argument{true, {}};
    with_option_name("refine", [&] {
      if (const auto* text = std::get_if<std::string>(&level))
        argument.constraints = parse_level(*text);
      if (const auto* pairs = std::get_if<Words>(&level))
        for (const auto& [name, text] : *pairs)
          argument.constraints.push_back(constraint_of(name, text));
    });
    arguments.push_back(std::move(argument));
  }
  return plan_levels(arguments, words.coarse, levels);
}

}  // namespace

ExtractSettings settings_of(const ExtractWords& words) {
  ExtractSettings settings;
  for (const auto& [name, text] : words.settings)
    with_option_name(name, [&, &name = name, &text = text] { set(settings, name, text); });
  settings.options.allow_self_intersections = words.allow_self_intersections;
  settings.goals = goals_of(words, settings.options.levels);
  return settings;
}

}  // namespace isoatlas::detail::python
