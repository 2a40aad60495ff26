// SPDX-License-Identifier: Apache-2.0
// Mistakes in the options of a command. Each function returns one line about the first mistake, or
// an empty string.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "command_words.h"

namespace isoatlas::detail::tool {

/// Finds an option that the command does not have. Suggests the option that was probably meant:
/// another spelling, the name in another program, or an option of another command.
std::string find_unknown_option(const CLI::App& app, const CLI::App& command,
                                const CommandWords& words);

/// Finds an option without its value, or with an empty value.
std::string find_missing_value(const CLI::App& app, const CLI::App& command,
                               const CommandWords& words);

/// Finds an option that is given twice and takes a single value.
std::string find_repeated_option(const CLI::App& app, const CLI::App& command,
                                 const CommandWords& words);

}  // namespace isoatlas::detail::tool
