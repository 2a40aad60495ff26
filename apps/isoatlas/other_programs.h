// SPDX-License-Identifier: Apache-2.0
// Names of commands and options in other programs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::tool {

/// The commands for which other programs use `word`, most likely first; empty if it is unknown.
std::vector<std::string_view> commands_called(std::string_view word);

/// The replacement for an option of another program: an option as it is typed ("--iso",
/// "--keep-components 1"), or a sentence if isoatlas has no such option.
struct OtherOption {
  std::string_view text;
  bool is_option() const { return text.starts_with('-'); }
  std::string_view option() const { return text.substr(0, text.find(' ')); }  ///< without a value
};

/// The replacements for the option `name`, given in lower case and without dashes. The first one
/// that the command has is the right one.
std::vector<OtherOption> options_called(std::string_view name);

}  // namespace isoatlas::detail::tool
