// SPDX-License-Identifier: Apache-2.0
// Mistakes in the options of a command. Each function returns one line, or nothing.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "command_words.h"

namespace isoatlas::detail::tool {

/// With the option that was meant: another spelling, another program's name for it, or another
/// command's option.
std::string find_unknown_option(const CLI::App& app, const CLI::App& command,
                                const CommandWords& words);

std::string find_missing_value(const CLI::App& app, const CLI::App& command,
                               const CommandWords& words);

std::string find_repeated_option(const CLI::App& app, const CLI::App& command,
                                 const CommandWords& words);

}  // namespace isoatlas::detail::tool
