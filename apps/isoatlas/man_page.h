// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas::detail::tool {

/// The name of a command as it is typed: "blocks plan" for the command blocks-plan.
std::string typed_name(const CLI::App& command);

/// The commands of the tool with their descriptions, one per line.
std::string command_list(const CLI::App& app, std::size_t indent);

/// Formats --help of a command like a manual page: the options that CLI11 knows, with texts before
/// and after them. The description of the command is the NAME line.
class ManPage : public CLI::FormatterBase {
 public:
  struct Text {
    std::string synopsis;             ///< preformatted
    std::string common_options = {};  ///< preformatted; fits on the first screen
    std::string description;          ///< paragraphs separated by empty lines; will be filled
    std::vector<std::string> groups;  ///< groups of options, in the order of the page
    /// Sections after the options: title and preformatted lines.
    std::vector<std::pair<std::string, std::string>> sections;
  };

  explicit ManPage(Text text) : text_(std::move(text)) {}
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  const Text& text() const { return text_; }

 private:
  Text text_;
};

}  // namespace isoatlas::detail::tool
