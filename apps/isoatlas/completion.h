// SPDX-License-Identifier: Apache-2.0
// Scripts for shell completion of isoatlas command lines.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

/// The words that an option takes, if it takes only these; empty for other options.
std::span<const std::string_view> words_of(const CLI::Option& option);

/// A script for `shell` ("bash", "zsh" or "fish") that completes the commands and options of `app`,
/// and the words of options. Other values are completed as file names. @throws Error(bad_argument)
/// for another shell
std::string completion_script(const CLI::App& app, std::string_view shell);

}  // namespace isoatlas::detail::tool
