// SPDX-License-Identifier: Apache-2.0
// What is wrong with a command line, in the words of somebody who is asked for help: the first
// thing first, and what to type instead. CLI11 parses what passes here, and its messages remain for
// what is not looked for.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace isoatlas::detail::tool {

/// `words` without the program's name, so that CLI11 understands all ways to ask for help: "help
/// extract", "--help extract" and "extract v.nrrd -h" become "extract --help", "version" becomes
/// "--version".
std::vector<std::string> in_standard_form(const CLI::App& app, std::vector<std::string> words);

/// One line on the first mistake in `words`; empty if there is none to be seen. Checked in this
/// order: the command, unknown options, options without a value, options given twice, words left
/// over, what is missing. Values are not looked at.
std::string find_mistake(const CLI::App& app, const std::vector<std::string>& words);

/// The commands, a line each: what people see who type nothing.
std::string usage(const CLI::App& app);

}  // namespace isoatlas::detail::tool
