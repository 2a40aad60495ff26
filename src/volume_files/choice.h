// SPDX-License-Identifier: Apache-2.0
// The choice of one entry of a list in a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// The index of the entry of `choice` that `wanted` names. A list of one entry needs no option.
/// Appends the choice and its selected entry to `source.choices`.
///
/// @param choice  its `name` and `entries`, which must not be empty
/// @param wanted  the option's value; nothing if the option was not given
/// @throws ChoiceNeeded         if there are several entries and no option; the message lists them
/// @throws Error(bad_argument)  if there is no such entry
std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        std::optional<std::size_t> wanted);

/// The same for entries with names: `wanted` is a name or a number, empty if the option was not
/// given. If it is both, the name counts.
std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        const std::string& wanted);

/// A choice of `count` entries without names: "0", "1", ...
FileChoice numbered_choice(const std::string& name, std::size_t count);

/// numbered_choice() with a limit, since a header may state any number of entries.
/// @throws Error(unsupported) if there are more than 65536
FileChoice checked_choice(const std::filesystem::path& path, const std::string& name,
                          std::uint64_t count);

}  // namespace isoatlas::detail::io
