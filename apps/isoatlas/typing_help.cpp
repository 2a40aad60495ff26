// SPDX-License-Identifier: Apache-2.0
#include "typing_help.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "command_words.h"
#include "file_kinds.h"
#include "man_page.h"
#include "nearest_name.h"
#include "option_mistakes.h"
#include "other_programs.h"
#include "positional_mistakes.h"
#include "text.h"
#include "wording/values.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

Words names_of_commands(const CLI::App& app) {
  Words names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(typed_name(*command));
  return names;
}

const CLI::App* command_named(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == name || typed_name(*command) == name) return command;
  return nullptr;
}

/// "extract, info or check"
std::string listed(const Words& names, const std::string& last = "or") {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += (i == 0 ? "" : i + 1 < names.size() ? ", " : " " + last + " ") + names[i];
  return list;
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Length in bytes of a typographic hyphen, dash or minus sign at the start of `word`; 0 for
/// another start.
std::size_t typographic_dash(std::string_view word) {
  // U+2010 to U+2015, U+2212, U+FE58, U+FE63, U+FF0D
  for (const std::string_view dash : {"\u2010", "\u2011", "\u2012", "\u2013", "\u2014", "\u2015",
                                      "\u2212", "\uFE58", "\uFE63", "\uFF0D"})
    if (word.starts_with(dash)) return dash.size();
  return 0;
}

bool starts_with_typographic_quote(std::string_view word) {
  constexpr std::array<std::string_view, 8> kQuotes{"\u2018", "\u2019", "\u201A", "\u201C",
                                                    "\u201D", "\u201E", "\u00AB", "\u00BB"};
  return std::ranges::any_of(kQuotes,
                             [word](std::string_view quote) { return word.starts_with(quote); });
}

/// Finds typographic dashes and quotes, which text editors and web pages put in place of - and ".
std::string find_typography(const Words& words) {
  for (const std::string& word : words) {
    if (exists(word)) continue;
    const std::string_view rest = std::string_view(word).substr(word.starts_with('-') ? 1 : 0);
    if (typographic_dash(rest) > 0) {
      std::string_view name = word;
      while (name.starts_with('-') || typographic_dash(name) > 0)
        name.remove_prefix(std::max<std::size_t>(1, typographic_dash(name)));
      const bool is_long = name.substr(0, name.find('=')).size() > 1 && !name.starts_with('.') &&
                           name.find_first_of("0123456789") != 0;
      return "'" + word + "' begins with a typographic dash, expected " + (is_long ? "--" : "-") +
             std::string(name);
    }
    if (starts_with_typographic_quote(word))
      return "'" + word + "' has typographic quotation marks, expected ' or \"";
  }
  return "";
}

bool has_option(const Words& words, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::find(names, std::string_view(word).substr(0, word.find('='))) !=
           names.end();
  });
}

/// The value of -o; empty without this option.
fs::path output_of(const Words& words) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "-o" || words[i] == "--output") return words[i + 1];
  return {};
}

/// The command that was probably meant if none was given; empty if it cannot be guessed.
std::string guessed_command(const Words& words) {
  const bool extracts = has_option(words, {"--iso", "--refine", "--max-distance", "--coarse"});
  std::string file;
  for (std::size_t i = 0; i < words.size() && file.empty(); ++i)
    if (!is_option_like(words[i]) && (i == 0 || !is_option_like(words[i - 1]))) file = words[i];
  const FileKind kind = kind_of_file(file), output = kind_of_name(output_of(words));
  switch (kind) {
    case FileKind::volume:
    case FileKind::folder:
      return extracts || has_option(words, {"-o", "--output"}) ? "extract" : "info";
    case FileKind::mesh:
    case FileKind::levels:
    case FileKind::json:
      if (output == FileKind::page) return "report";
      if (output == FileKind::picture) return "picture";
      return kind == FileKind::mesh ? "check" : "levels";
    default:
      return extracts ? "extract" : "";
  }
}

bool looks_like_file(const std::string& word) {
  return word.find('/') != std::string::npos || kind_of_name(word) != FileKind::unknown ||
         fs::path(word).has_extension() || exists(word);
}

Words with_command_first(const std::string& command, Words words) {
  words.insert(words.begin(), command);
  return words;
}

std::string forgotten_command(const CLI::App& app, const Words& words) {
  const std::string command = guessed_command(words);
  return "the command is missing, expected one of " + listed(names_of_commands(app)) +
         (command.empty() ? ""
                          : "; did you mean: " + command_text(with_command_first(command, words)));
}

/// The message if the first word is an option that the tool itself does not have.
std::string option_before_command(const CLI::App& app, const Words& words) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (command_named(app, words[i]) == nullptr) continue;
    Words sorted = words;
    std::rotate(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(i),
                sorted.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    return "the command comes first, expected: " + command_text(sorted);
  }
  if (words.size() == 1) {
    const bool wants_version = plain_word(words[0]) == "-v";
    return "there is no option " + words[0] +
           (wants_version ? ", did you mean --version?" : " without a command");
  }
  return forgotten_command(app, words);
}

std::string wrong_command(const CLI::App& app, const Words& words) {
  const std::string& word = words.front();
  if (is_option_like(word))
    return app.get_option_no_throw(word) != nullptr ? "" : option_before_command(app, words);
  const Words names = names_of_commands(app);
  const std::string nearest = nearest_name(word, names);
  const std::vector<std::string_view> meant = commands_called(plain_word(word));
  if (meant.empty() && nearest.empty() && looks_like_file(word))
    return forgotten_command(app, words);
  const std::string list = nearest.empty() ? listed(Words(meant.begin(), meant.end())) : nearest;
  return "there is no command '" + word + "'" +
         (list.empty() ? "" : ", did you mean " + list + "?") + (list.empty() ? "; the" : " The") +
         " commands are " + listed(names, "and");
}

bool requests_help(const CommandWords& words) {
  const bool has_help_word =
      !words.positionals.empty() && words.positionals.front().text == "help" && !exists("help");
  return has_help_word || std::ranges::any_of(words.options, [](const OptionWord& word) {
           return word.name == "-h" || word.name == "--help";
         });
}

}  // namespace

std::vector<std::string> in_standard_form(const CLI::App& app, Words words) {
  if (words.empty()) return words;
  const std::string first = words.front();
  if (first == "version" || first == "-V") return {"--version"};
  if (first == "help" || first == "--help" || first == "-h") {
    if (words.size() == 1) return {"--help"};
    words.erase(words.begin());
    if (command_named(app, words.front()) == nullptr) return words;
    return {words.front(), "--help"};
  }
  const CLI::App* command = command_named(app, first);
  if (command != nullptr && requests_help(read_words(*command, {words.begin() + 1, words.end()})))
    return {first, "--help"};
  return words;
}

std::string find_mistake(const CLI::App& app, const Words& words) {
  if (std::string typography = find_typography(words); !typography.empty()) return typography;
  const CLI::App* command = command_named(app, words.front());
  if (command == nullptr) return wrong_command(app, words);
  const CommandWords read = read_words(*command, {words.begin() + 1, words.end()});
  if (requests_help(read)) return "";
  for (const auto find : {find_unknown_option, find_missing_value, find_repeated_option,
                          find_leftover_word, find_missing_word})
    if (std::string mistake = find(app, *command, read); !mistake.empty()) return mistake;
  return "";
}

std::string usage(const CLI::App& app) {
  return "usage: isoatlas COMMAND ...\n\n" + command_list(app, 2) +
         "\n`isoatlas help COMMAND` explains a command, `isoatlas help` all of them.\n";
}

}  // namespace isoatlas::detail::tool
