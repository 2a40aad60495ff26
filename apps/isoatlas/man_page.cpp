// SPDX-License-Identifier: Apache-2.0
#include "man_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace isoatlas::detail::tool {
namespace {

constexpr std::size_t kColumns = 80, kIndent = 4, kDeepIndent = 10, kCommandWidth = 14;

/// Fills lines with the words of `text`; an empty line in it separates paragraphs.
std::string filled(const std::string& text, std::size_t indent) {
  std::istringstream lines(text);
  std::string result, filling;
  const auto end_line = [&] {
    if (!filling.empty()) result += std::string(indent, ' ') + filling + "\n";
    filling.clear();
  };
  for (std::string line, word; std::getline(lines, line);) {
    if (line.empty()) {
      end_line();
      if (!result.empty()) result += "\n";
    }
    for (std::istringstream words(line); words >> word;) {
      if (!filling.empty() && indent + filling.size() + 1 + word.size() > kColumns) end_line();
      filling += (filling.empty() ? "" : " ") + word;
    }
  }
  end_line();
  return result;
}

/// Preformatted lines, indented.
std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string line, result;
  while (std::getline(lines, line))
    result += (line.empty() ? "" : std::string(kIndent, ' ')) + line + "\n";
  return result;
}

std::string section(std::string title, const std::string& body) {
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  return title + "\n" + body + "\n";
}

std::string option_entry(const CLI::Option& option) {
  std::string names =
      option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  for (std::size_t comma = names.find(','); comma != std::string::npos;
       comma = names.find(',', comma + 2))
    names.replace(comma, 1, ", ");
  if (!option.get_positional() && option.get_expected_max() > 0)
    names += " " + option.get_type_name();
  return std::string(kIndent, ' ') + names + "\n" + filled(option.get_description(), kDeepIndent);
}

}  // namespace

std::string typed_name(const CLI::App& command) {
  std::string name = command.get_name();
  if (const std::size_t dash = name.find('-'); dash != std::string::npos) name[dash] = ' ';
  return name;
}

std::string command_list(const CLI::App& app, std::size_t indent) {
  std::string lines;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    std::string name = typed_name(*command);
    name.resize(std::max(kCommandWidth, name.size() + 1), ' ');
    lines += std::string(indent, ' ') + name + command->get_description() + "\n";
  }
  return lines;
}

std::string ManPage::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const {
  const bool is_of_tool = app->get_parent() == nullptr;
  name = is_of_tool ? app->get_name() : app->get_parent()->get_name() + " " + typed_name(*app);
  const std::string indent(kIndent, ' ');
  std::string page = section("Name", indent + name + " - " + app->get_description() + "\n");
  page += section("Synopsis", indented(text_.synopsis));
  if (!text_.common_options.empty())
    page += section("Common options", indented(text_.common_options));
  page += section("Description", filled(text_.description, kIndent));

  if (const std::string commands = command_list(*app, kIndent); !commands.empty())
    page += section("Commands", commands);

  for (const std::string& group : text_.groups) {
    std::string entries;
    for (const CLI::Option* option :
         app->get_options([&](const CLI::Option* o) { return o->get_group() == group; }))
      entries += option_entry(*option);
    page += section(group, entries);
  }
  for (const auto& [title, lines] : text_.sections) page += section(title, indented(lines));
  page.pop_back();
  return page;
}

}  // namespace isoatlas::detail::tool
