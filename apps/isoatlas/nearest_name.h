// SPDX-License-Identifier: Apache-2.0
// The name that a mistyped word most likely means.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

/// The smallest number of letters to change, add, remove or swap with their neighbour that turns
/// `from` into `to`.
std::size_t edit_distance(std::string_view from, std::string_view to);

/// The name most similar to `typed`, compared as plain words (wording/values.h): at most a third of
/// the letters differ, or `typed` is the beginning of this name only. Empty if no name is similar.
std::string nearest_name(std::string_view typed, std::span<const std::string> names);

}  // namespace isoatlas::detail::tool
