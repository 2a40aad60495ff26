// SPDX-License-Identifier: Apache-2.0
// Mistakes in the positional arguments, and missing arguments. Each function returns one line about
// the first mistake, or an empty string.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "command_words.h"

namespace isoatlas::detail::tool {

/// Finds a word that the command cannot use. Suggests the option that is missing before it.
std::string find_leftover_word(const CLI::App& app, const CLI::App& command,
                               const CommandWords& words);

/// Finds a required argument or option that is missing.
std::string find_missing_word(const CLI::App& app, const CLI::App& command,
                              const CommandWords& words);

}  // namespace isoatlas::detail::tool
