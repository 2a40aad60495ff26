// SPDX-License-Identifier: Apache-2.0
// The words after a command, read as CLI11 will read them. This allows mistakes to be reported in a
// useful order before CLI11 parses the words.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::tool {

struct OptionWord {
  std::string name;                       ///< as typed, with its dashes
  const CLI::Option* option = nullptr;    ///< null: the command has no such option
  std::optional<std::string> value = {};  ///< none: a flag, or the value is missing
  std::string typed = {};                 ///< the whole word that contains the name
};

struct PositionalWord {
  std::string text;
  /// The index of the option whose value is the previous word; none: there is no such option.
  std::optional<std::size_t> after_value_of = {};
};

struct CommandWords {
  std::vector<OptionWord> options;
  std::vector<PositionalWord> positionals;
};

/// True for "-o" and "--iso", false for "-", "-300" and "-.5,1,0".
bool is_option_like(std::string_view word);

/// True if the option takes a value.
bool takes_value(const CLI::Option& option);

/// Reads the words after the name of `command`. An option takes the next word as its value, unless
/// that word is option-like.
CommandWords read_words(const CLI::App& command, const std::vector<std::string>& words);

}  // namespace isoatlas::detail::tool
