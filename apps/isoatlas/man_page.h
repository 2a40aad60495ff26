// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas::detail::tool {

/// The commands of the tool with their descriptions, one per line.
std::string command_list(const CLI::App& app, std::size_t indent);

/// Makes --help of a command read like a manual page: what CLI11 knows of the options, between
/// prose. The command's description is the NAME line.
class ManPage : public CLI::FormatterBase {
 public:
  struct Text {
    std::string synopsis;             ///< as it stands
    std::string common_options = {};  ///< as it stands: what most people need, on the first screen
    std::string description;          ///< paragraphs with empty lines between them; filled
    std::vector<std::string> groups;  ///< of options, in the order of the page
    std::vector<std::pair<std::string, std::string>>
        sections;  ///< after the options: title, lines as they stand
  };

  explicit ManPage(Text text) : text_(std::move(text)) {}
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  const Text& text() const { return text_; }

 private:
  Text text_;
};

}  // namespace isoatlas::detail::tool
