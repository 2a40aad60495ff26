// SPDX-License-Identifier: Apache-2.0
// Finds mistakes in a command line and suggests what to type instead. CLI11 parses the command
// lines without such mistakes, and reports all other errors.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace isoatlas::detail::tool {

/// Replaces all ways to request help by the one that CLI11 knows: "help extract", "--help extract"
/// and "extract v.nrrd -h" become "extract --help", "version" becomes "--version".
/// @param words  the command line without the name of the program
std::vector<std::string> in_standard_form(const CLI::App& app, std::vector<std::string> words);

/// One line about the first mistake in `words`; empty if none is found. The order of the checks is:
/// the command, unknown options, options without a value, repeated options, extra words, missing
/// arguments. Values are not checked.
std::string find_mistake(const CLI::App& app, const std::vector<std::string>& words);

/// The list of commands, one line each. Printed if no argument is given.
std::string usage(const CLI::App& app);

}  // namespace isoatlas::detail::tool
