// SPDX-License-Identifier: Apache-2.0
#include "man_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace isoatlas::tool {
namespace {

constexpr std::size_t kColumns = 80, kIndent = 4, kDeepIndent = 10;

/// Fills lines with the words of `text`; a line break in it starts a new paragraph.
std::string wrapped(const std::string& text, std::size_t indent, const std::string& between_paragraphs = "\n") {
  std::istringstream paragraphs(text);
  std::string paragraph, result;
  while (std::getline(paragraphs, paragraph)) {
    if (!result.empty()) result += between_paragraphs;
    std::istringstream words(paragraph);
    std::string word, line;
    while (words >> word) {
      if (!line.empty() && indent + line.size() + 1 + word.size() > kColumns) {
        result += std::string(indent, ' ') + line + "\n";
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    result += std::string(indent, ' ') + line + "\n";
  }
  return result;
}

/// Lines as they stand, moved to the right.
std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string line, result;
  while (std::getline(lines, line)) result += (line.empty() ? "" : std::string(kIndent, ' ')) + line + "\n";
  return result;
}

std::string section(std::string title, const std::string& body) {
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  return title + "\n" + body + "\n";
}

std::string option_entry(const CLI::Option& option) {
  std::string names = option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  for (std::size_t comma = names.find(','); comma != std::string::npos; comma = names.find(',', comma + 2))
    names.replace(comma, 1, ", ");
  if (!option.get_positional() && option.get_expected_max() > 0) names += " " + option.get_type_name();
  return std::string(kIndent, ' ') + names + "\n" + wrapped(option.get_description(), kDeepIndent, "");
}

}  // namespace

std::string ManPage::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const {
  if (name.empty()) name = app->get_name();
  const std::string indent(kIndent, ' ');
  std::string page = section("Name", indent + name + " - " + app->get_description() + "\n");
  page += section("Synopsis", indented(text_.synopsis));
  page += section("Description", wrapped(text_.description, kIndent));

  std::string commands;
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
    commands += indent + command->get_name() + std::string(kDeepIndent - command->get_name().size(), ' ') +
                command->get_description() + "\n";
  if (!commands.empty()) page += section("Commands", commands);

  for (const std::string& group : text_.groups) {
    std::string entries;
    for (const CLI::Option* option : app->get_options([&](const CLI::Option* o) { return o->get_group() == group; }))
      entries += option_entry(*option);
    page += section(group, entries);
  }
  for (const auto& [title, lines] : text_.sections) page += section(title, indented(lines));
  page.pop_back();
  return page;
}

}  // namespace isoatlas::tool
