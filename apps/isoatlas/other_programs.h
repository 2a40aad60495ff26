// SPDX-License-Identifier: Apache-2.0
// What people call things who come from other programs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::tool {

/// The commands that do what `word` asks for, most likely first; empty if the word is not known.
std::vector<std::string_view> commands_called(std::string_view word);

/// What stands for an option of another program: an option as it is to be typed ("--iso",
/// "--keep-components 1"), or a sentence where there is none.
struct OtherOption {
  std::string_view text;
  bool is_option() const { return text.starts_with('-'); }
  std::string_view option() const { return text.substr(0, text.find(' ')); }  ///< without a value
};

/// What `name`, in lower case and without dashes, stands for; the first one that a command has is
/// right.
std::vector<OtherOption> options_called(std::string_view name);

}  // namespace isoatlas::detail::tool
