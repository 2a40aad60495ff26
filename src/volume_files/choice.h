// SPDX-License-Identifier: Apache-2.0
// Taking one entry of a list in a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// The entry of `choice` that `wanted` names. A list of one entry needs no option. The choice, with
/// what was selected, is appended to `source.choices`.
///
/// @param choice  `name` and `entries`, not empty
/// @param wanted  the option's value; none: not given
/// @throws ChoiceNeeded         several entries and nothing wanted; its message lists them
/// @throws Error(bad_argument)  there is no such entry
std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        std::optional<std::size_t> wanted);

/// The same where entries have names: `wanted` is a name or a number; empty: not given. A name
/// comes before a number.
std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        const std::string& wanted);

/// A choice of `count` entries without names of their own: "0", "1", ...
FileChoice numbered_choice(const std::string& name, std::size_t count);

/// numbered_choice() of no more entries than a person could look through: a header may state any
/// number.
/// @throws Error(unsupported) if there are more than 65536
FileChoice checked_choice(const std::filesystem::path& path, const std::string& name,
                          std::uint64_t count);

}  // namespace isoatlas::detail::io
