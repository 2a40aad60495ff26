// SPDX-License-Identifier: Apache-2.0
// Which of several names somebody meant who mistyped it.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

/// The fewest letters to change, add, leave out or swap with their neighbour to make `to` of
/// `from`.
std::size_t edit_distance(std::string_view from, std::string_view to);

/// The name most like `typed`, compared as plain words (wording/values.h): at most a third of the
/// letters differ, or `typed` is the beginning of this name and of no other. Empty if there is no
/// such name.
std::string nearest_name(std::string_view typed, std::span<const std::string> names);

}  // namespace isoatlas::detail::tool
