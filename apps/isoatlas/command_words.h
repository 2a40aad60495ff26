// SPDX-License-Identifier: Apache-2.0
// The words after a command as CLI11 will take them, before it does: mistakes can then be named in
// the order in which people want to hear of them.
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
  std::optional<std::string> value = {};  ///< none: a flag, or nothing was there
  std::string typed = {};                 ///< the whole word that the name is in
};

struct PositionalWord {
  std::string text;
  std::optional<std::size_t> after_value_of =
      {};  ///< it stands right behind the value of this one of the options
};

struct CommandWords {
  std::vector<OptionWord> options;
  std::vector<PositionalWord> positionals;
};

/// "-o", "--iso", but not "-", "-300" and "-.5,1,0".
bool is_option_like(std::string_view word);

/// Does the option stand with a value?
bool takes_value(const CLI::Option& option);

/// What `words`, those behind its name, are to `command`. An option takes the next word as its
/// value unless that is option-like.
CommandWords read_words(const CLI::App& command, const std::vector<std::string>& words);

}  // namespace isoatlas::detail::tool
