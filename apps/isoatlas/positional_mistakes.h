// SPDX-License-Identifier: Apache-2.0
// Mistakes in the words that stand without an option, and what is missing. Each function returns
// one line, or nothing.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "command_words.h"

namespace isoatlas::detail::tool {

/// A word for which the command has no place, with the option that it belongs behind.
std::string find_leftover_word(const CLI::App& app, const CLI::App& command,
                               const CommandWords& words);

/// A word or an option that the command cannot do without.
std::string find_missing_word(const CLI::App& app, const CLI::App& command,
                              const CommandWords& words);

}  // namespace isoatlas::detail::tool
