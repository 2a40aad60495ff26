// SPDX-License-Identifier: Apache-2.0
#include "option_mistakes.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <vector>

#include "man_page.h"
#include "nearest_name.h"
#include "other_programs.h"
#include "wording/values.h"

namespace isoatlas::detail::tool {
namespace {

using Names = std::vector<std::string>;

std::string without_dashes(const std::string& name) {
  return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

/// The long names of the options of a command, without dashes.
Names names_of_options(const CLI::App& command) {
  Names names;
  for (const CLI::Option* option : command.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

bool has_option(const CLI::App& command, std::string_view name) {
  const CLI::Option* option = command.get_option_no_throw(std::string(name));
  return option != nullptr && !option->get_positional();
}

/// Whether the options of a command are those of extract, which messages name instead.
bool repeats_extract(const CLI::App& command) { return command.get_name() == "blocks-plan"; }

/// The other commands that have the option: "isoatlas extract and check".
std::string others_with(const CLI::App& app, const CLI::App& command, const std::string& name) {
  Names others;
  for (const CLI::App* other : app.get_subcommands([](const CLI::App*) { return true; }))
    if (other != &command && !repeats_extract(*other) && has_option(*other, name))
      others.push_back(typed_name(*other));
  std::string list;
  for (std::size_t i = 0; i < others.size(); ++i)
    list += (i == 0 ? "isoatlas " : i + 1 < others.size() ? ", " : " and ") + others[i];
  return list;
}

/// Advice if other programs use `name`; empty if the name is unknown or the command has no such
/// option.
std::string advice_of_other_programs(const CLI::App& command, const std::string& name) {
  for (const OtherOption& other : options_called(plain_word(name))) {
    if (!other.is_option()) return ": " + std::string(other.text);
    if (has_option(command, other.option()))
      return ", did you mean " + std::string(other.text) + "?";
  }
  return "";
}

/// The letters at the start of `name`: "iso" of "iso100" and "iso:100".
std::string leading_name(const std::string& name) {
  const auto end = std::ranges::find_if(
      name, [](unsigned char c) { return std::isalpha(c) == 0 && c != '-' && c != '_'; });
  return {name.begin(), end};
}

std::string advice_on(const CLI::App& app, const CLI::App& command, const std::string& typed) {
  const std::string name = without_dashes(typed);
  const Names own = names_of_options(command);
  const auto did_you_mean = [](const std::string& nearest) {
    return ", did you mean --" + nearest + "?";
  };
  for (const std::string& known : own)
    if (plain_word(known) == plain_word(name)) return did_you_mean(known);
  if (const std::string advice = advice_of_other_programs(command, name); !advice.empty())
    return advice;
  if (const std::string others = others_with(app, command, typed); !others.empty())
    return ", it is an option of " + others;
  for (const std::string& part : {name, leading_name(name)})
    if (const std::string nearest = nearest_name(part, own); !nearest.empty())
      return did_you_mean(nearest);
  for (const CLI::App* other : app.get_subcommands([](const CLI::App*) { return true; }))
    if (const std::string nearest = nearest_name(name, names_of_options(*other)); !nearest.empty())
      return ", did you mean --" + nearest + " of isoatlas " + typed_name(*other) + "?";
  return "";
}

/// Advice if the word is a file name that begins with a dash.
std::string advice_on_file(const OptionWord& word) {
  std::error_code ignored;
  const bool is_file = std::filesystem::exists(word.typed, ignored);
  const bool is_like_a_name =
      !word.typed.starts_with("--") && std::filesystem::path(word.typed).has_extension();
  return is_file || is_like_a_name ? "; the file of that name is ./" + word.typed : "";
}

std::string with_value(const OptionWord& word, const std::string& value) {
  return word.name + " " + value;
}

}  // namespace

std::string find_unknown_option(const CLI::App& app, const CLI::App& command,
                                const CommandWords& words) {
  for (const OptionWord& word : words.options) {
    if (word.option != nullptr) continue;
    const bool has_one_dash = !word.name.starts_with("--");
    if (has_one_dash && has_option(command, "-" + word.name))
      return word.name + " has one dash, expected two: -" + word.name;
    const std::string file = advice_on_file(word);
    return "isoatlas " + typed_name(command) + " has no option " +
           (file.empty() ? word.name + advice_on(app, command, word.name) : word.typed + file);
  }
  return "";
}

std::string find_missing_value(const CLI::App&, const CLI::App&, const CommandWords& words) {
  for (std::size_t i = 0; i < words.options.size(); ++i) {
    const OptionWord& word = words.options[i];
    if (word.option == nullptr || !takes_value(*word.option)) continue;
    const std::string expected = "expected " + with_value(word, word.option->get_type_name());
    if (!word.value) {
      if (i + 1 == words.options.size()) return word.name + " has no value, " + expected;
      const OptionWord& next = words.options[i + 1];
      const std::string file = advice_on_file(next);
      return word.name + " has no value, " + expected + ", found " +
             (file.empty() ? next.name : next.typed + file);
    }
    if (word.value->empty())
      return word.name + " has an empty value, " + expected + ": is a shell variable not set?";
    if (!word.name.starts_with("--") && word.value->starts_with('='))
      return word.name + *word.value + ": an option of one letter takes no '=', expected " +
             with_value(word, word.value->substr(1));
  }
  return "";
}

std::string find_repeated_option(const CLI::App&, const CLI::App&, const CommandWords& words) {
  for (std::size_t i = 0; i < words.options.size(); ++i) {
    const OptionWord& word = words.options[i];
    const bool is_single =
        word.option != nullptr && takes_value(*word.option) &&
        word.option->get_multi_option_policy() != CLI::MultiOptionPolicy::TakeAll;
    for (std::size_t k = 0; is_single && k < i; ++k) {
      if (words.options[k].option != word.option) continue;
      return word.name + " is given twice, with " + words.options[k].value.value_or("") + " and " +
             word.value.value_or("") + ", expected once";
    }
  }
  return "";
}

}  // namespace isoatlas::detail::tool
