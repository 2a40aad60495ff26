// SPDX-License-Identifier: Apache-2.0
#include "positional_mistakes.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/file_name.h"
#include "file_kinds.h"
#include "man_page.h"
#include "wording/values.h"

namespace isoatlas::detail::tool {
namespace {

using Positionals = std::vector<PositionalWord>;

const CLI::Option* positional_of(const CLI::App& command) {
  const auto options =
      command.get_options([](const CLI::Option* option) { return option->get_positional(); });
  return options.empty() ? nullptr : options.front();
}

bool is_given(const CommandWords& words, const CLI::Option* option) {
  return std::ranges::any_of(words.options,
                             [option](const OptionWord& word) { return word.option == option; });
}

/// The option `name`, if the command has it and it was not given; otherwise null.
const CLI::Option* free_option(const CLI::App& command, const CommandWords& words,
                               const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  return option == nullptr || is_given(words, option) ? nullptr : option;
}

bool is_number(const std::string& text) { return parse_whole<double>(text).has_value(); }

/// Finds words that belong to the value before them: "0.5 mm", "64 64 64".
std::string value_in_pieces(const CommandWords& words) {
  constexpr std::array kUnits{"mm", "vx", "um", "nm", "cm", "m", "mm3", "deg"};
  for (std::size_t i = 0; i < words.positionals.size(); ++i) {
    const PositionalWord& piece = words.positionals[i];
    if (!piece.after_value_of) continue;
    const OptionWord& option = words.options[*piece.after_value_of];
    const auto whole = [&](const std::string& between) {
      return option.name + " " + *option.value + between + piece.text;
    };
    const std::string problem =
        "'" + piece.text + "' is separated from the value of " + option.name + ", expected ";
    if (std::ranges::find(kUnits, piece.text) != kUnits.end()) return problem + whole("");
    if (option.name == "--refine" && piece.text.find(':') != std::string::npos)
      return problem + whole(",") + " for one level, or --refine again for another level";
    if (option.option->get_type_name().find(',') == std::string::npos || !is_number(piece.text))
      continue;
    std::string value = whole(",");
    for (std::size_t k = i + 1;
         k < words.positionals.size() && is_number(words.positionals[k].text); ++k)
      value += "," + words.positionals[k].text;
    return problem + "commas: " + value;
  }
  return "";
}

/// Finds the name of an existing file with blanks that was typed without quotes.
std::string name_in_pieces(const Positionals& words) {
  for (std::size_t first = 0; first + 1 < words.size(); ++first) {
    std::string name = words[first].text;
    for (std::size_t last = first + 1; last < words.size(); ++last) {
      name += " " + words[last].text;
      std::error_code ignored;
      if (std::filesystem::exists(name, ignored))
        return "a name with blanks needs quotes, expected \"" + name + "\"";
    }
  }
  return "";
}

/// Advice if all slices of a folder were given, as the shell expands FOLDER/*.
std::string advice_on_slices(const CLI::App& command, const Positionals& words) {
  if (command.get_name() != "extract" && command.get_name() != "info") return "";
  const std::filesystem::path folder = std::filesystem::path(words.front().text).parent_path();
  const bool are_slices = std::ranges::all_of(words, [&](const PositionalWord& word) {
    const std::filesystem::path path = word.text;
    return path.parent_path() == folder &&
           (has_extension(path, ".tif .tiff .png") || kind_of_file(path) == FileKind::volume);
  });
  if (!are_slices) return "";
  return "; slices are read as a folder: isoatlas " + command.get_name() + " " +
         (folder.empty() ? "." : folder.string());
}

/// Finds the option that is missing before `word`.
std::string missing_option(const CLI::App& command, const CommandWords& words,
                           const std::string& word) {
  const auto needs = [&](const char* what, const std::string& option) {
    return "'" + word + "' is given without an option: the " + what + " needs " + option +
           ", expected " + option + " " + word;
  };
  const FileKind kind = kind_of_name(word);
  const bool is_mesh = kind == FileKind::mesh || kind == FileKind::levels;
  const bool is_extract = command.get_name() == "extract";
  if (is_number(word) && free_option(command, words, "--iso") != nullptr)
    return needs("isovalue", "--iso");
  if (is_extract && is_mesh && free_option(command, words, "-o") != nullptr)
    return needs("output", "-o");
  if (is_extract && kind == FileKind::page && free_option(command, words, "--html") != nullptr)
    return needs("page", "--html");
  if (is_extract && kind == FileKind::json && free_option(command, words, "--report") != nullptr)
    return needs("report", "--report");
  const bool is_output = (command.get_name() == "picture" && kind == FileKind::picture) ||
                         (command.get_name() == "report" && kind == FileKind::page);
  if (is_output && free_option(command, words, "-o") != nullptr) return needs("output", "-o");
  if (kind == FileKind::volume && free_option(command, words, "--volume") != nullptr)
    return needs("volume", "--volume");
  return "";
}

std::string synopsis_of(const CLI::App& command) {
  const auto page = std::dynamic_pointer_cast<ManPage>(command.get_formatter());
  const std::string synopsis = page ? page->text().synopsis : "";
  return synopsis.substr(0, synopsis.find('\n'));
}

/// The meaning of a missing option, with an example that uses the name of the given file.
std::string explained(const std::string& command, const std::string& option,
                      const std::string& file) {
  const std::string name = file.empty() ? "head" : name_without_extensions(file);
  if (option == "iso")
    return ": the isovalue; `isoatlas info " + (file.empty() ? "head.nrrd" : file) +
           "` suggests values";
  if (option != "output") return "";
  if (command == "extract") return ": the mesh to write, like -o " + name + ".ply";
  return command == "report" ? ": the page to write, like -o " + name + ".html"
                             : ": the picture to write, like -o " + name + ".png";
}

}  // namespace

std::string find_leftover_word(const CLI::App&, const CLI::App& command,
                               const CommandWords& words) {
  const CLI::Option* positional = positional_of(command);
  const Positionals& found = words.positionals;
  if (positional == nullptr || found.empty()) return "";
  const bool reads_streams = command.get_name() == "extract" || command.get_name() == "info";
  if (!reads_streams && std::ranges::find(found, "-", &PositionalWord::text) != found.end())
    return "isoatlas " + command.get_name() +
           " does not read standard input, expected the name of a file";
  const bool takes_many = positional->get_items_expected_max() > 1;
  if (takes_many && !(found.size() > 1 && kind_of_name(found.back().text) == FileKind::page))
    return "";
  if (takes_many) return missing_option(command, words, found.back().text);
  if (found.size() == 1) return "";
  for (const PositionalWord& word : found) {
    const bool is_option =
        is_option_like(word.text) && command.get_option_no_throw(word.text) != nullptr;
    if (is_option)
      return word.text +
             " is given after --, which ends the options; expected -- after all options, before a "
             "name like -a.nii";
  }
  if (std::string pieces = value_in_pieces(words); !pieces.empty()) return pieces;
  if (std::string pieces = name_in_pieces(found); !pieces.empty()) return pieces;
  // The first word is checked last: it is the most likely to be in the right place.
  for (std::size_t i = 1; i <= found.size(); ++i)
    if (std::string mistake = missing_option(command, words, found[i % found.size()].text);
        !mistake.empty())
      return mistake;
  return "isoatlas " + command.get_name() + " takes one " + positional->get_name(true) +
         ", found '" + found[0].text + "' and '" + found[1].text + "'" +
         advice_on_slices(command, found);
}

std::string find_missing_word(const CLI::App&, const CLI::App& command, const CommandWords& words) {
  const CLI::Option* positional = positional_of(command);
  const bool has_positional = !words.positionals.empty();
  if (positional != nullptr && positional->get_required() && !has_positional)
    return positional->get_name(true) + " is missing, expected: " + synopsis_of(command);
  if (has_positional && words.positionals.front().text.empty())
    return positional->get_name(true) + " is empty: is a shell variable not set?";
  for (const CLI::Option* option : command.get_options()) {
    if (option == positional || !option->get_required() || is_given(words, option)) continue;
    if (std::ranges::any_of(option->get_excludes(), [&](const CLI::Option* replacing) {
          return is_given(words, replacing);
        }))
      continue;
    const std::string name = option->get_single_name();
    const bool has_letter = !option->get_snames().empty();
    return (has_letter ? "-" + option->get_snames().front() + " (--" + name + ")" : "--" + name) +
           " is missing" +
           explained(command.get_name(), name,
                     has_positional ? words.positionals.front().text : "");
  }
  return "";
}

}  // namespace isoatlas::detail::tool
