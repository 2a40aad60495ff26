// SPDX-License-Identifier: Apache-2.0
#include "completion.h"

#include <array>
#include <vector>

#include "command_words.h"
#include "isoatlas/error.h"

namespace isoatlas::detail::tool {
namespace {

using ValueWords = std::vector<std::string_view>;

struct OptionWords {
  std::string_view option;
  ValueWords words;
};

const std::array<OptionWords, 13>& option_words() {
  static const std::array<OptionWords, 13> kWords{{
      {"--inside", {"above", "below"}},
      {"--nan", {"above", "below"}},
      {"--topology", {"trilinear", "faces"}},
      {"--interpolation", {"trilinear", "tricubic"}},
      {"--covering", {"sizing-field", "halving"}},
      {"--border", {"open", "closed"}},
      {"--placement", {"surface", "balanced"}},
      {"--space", {"lps", "ras", "voxel"}},
      {"--format", {"ply", "stl", "obj", "off", "vtp", "3mf", "gii", "glb"}},
      {"--style", {"smooth", "hidden-line"}},
      {"--view", {"front", "back", "left", "right", "top", "bottom"}},
      {"--raw-endian", {"little", "big"}},
      {"--raw-type",
       {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32",
        "float64"}},
  }};
  return kWords;
}

std::string joined(std::span<const std::string_view> words) {
  std::string out;
  for (const std::string_view word : words) out.append(out.empty() ? "" : " ").append(word);
  return out;
}

/// All names of an option, with dashes: "-o", "--output".
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> out;
  for (const std::string& name : option.get_snames()) out.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.push_back("--" + name);
  return out;
}

/// The options of a command, without positional arguments.
std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_positional(); });
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// The first sentence of a description, without characters that are special inside single quotes of
/// a shell.
std::string summary(const std::string& description) {
  std::size_t end = description.find_first_of(".;:");
  while (end < description.size() && end + 1 < description.size() &&
         std::string_view(" \n").find(description[end + 1]) == std::string_view::npos)
    end = description.find_first_of(".;:", end + 1);  // a name such as report.md, or 0.5
  std::string out;
  for (const char c : description.substr(0, end)) {
    if (c == '\n' ? out.empty() : c == '\'' || c == '[' || c == ']' || c == '`') continue;
    out += c == '\n' ? ' ' : c;
  }
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

std::string bash_script(const CLI::App& app) {
  std::string commands, options, values;
  for (const CLI::App* command : commands_of(app)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    std::string names;
    for (const CLI::Option* option : options_of(*command))
      for (const std::string& name : names_of(*option)) names += (names.empty() ? "" : " ") + name;
    options += "    " + command->get_name() + ") options=\"" + names + "\" ;;\n";
  }
  for (const OptionWords& option : option_words())
    values += "    " + std::string(option.option) + ") COMPREPLY=($(compgen -W \"" +
              joined(option.words) + "\" -- \"$word\")); return ;;\n";
  return R"(# bash completion for isoatlas
_isoatlas() {
  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}" options=""
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W ")" +
         commands + R"( --help --version" -- "$word"))
    return
  fi
  case "$before" in
)" + values +
         R"(  esac
  case "${COMP_WORDS[1]}" in
)" + options +
         R"(  esac
  case "$word" in
    -*) COMPREPLY=($(compgen -W "$options" -- "$word")) ;;
  esac
}
complete -o default -F _isoatlas isoatlas
)";
}

std::string zsh_script(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += "      '" + command->get_name() + ":" + summary(command->get_description()) + "'\n";
    cases += "    " + command->get_name() + ")\n      _arguments";
    for (const CLI::Option* option : options_of(*command)) {
      const auto words = words_of(*option);
      const std::string value = !takes_value(*option) ? ""
                                : words.empty()       ? ":value:_files"
                                                      : ":value:(" + joined(words) + ")";
      const std::string rest = "[" + summary(option->get_description()) + "]" + value + "'";
      for (const std::string& name : names_of(*option)) cases += " \\\n        '*" + name + rest;
    }
    cases += " \\\n        '*:file:_files'\n      ;;\n";
  }
  return R"(#compdef isoatlas
_isoatlas() {
  if (( CURRENT == 2 )); then
    local -a commands=(
)" + commands +
         R"(    )
    _describe 'command' commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
)" + cases +
         R"(  esac
}
_isoatlas "$@"
)";
}

std::string fish_script(const CLI::App& app) {
  std::string out = "# fish completion for isoatlas\n";
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    out += "complete -c isoatlas -n __fish_use_subcommand -f -a " + name + " -d '" +
           summary(command->get_description()) + "'\n";
    for (const CLI::Option* option : options_of(*command)) {
      out += "complete -c isoatlas -n '__fish_seen_subcommand_from " + name + "'";
      for (const std::string& letter : option->get_snames()) out += " -s " + letter;
      for (const std::string& word : option->get_lnames()) out += " -l " + word;
      if (const auto words = words_of(*option); !words.empty())
        out += " -x -a '" + joined(words) + "'";
      else if (takes_value(*option))
        out += " -r";
      out += " -d '" + summary(option->get_description()) + "'\n";
    }
  }
  return out;
}

}  // namespace

std::span<const std::string_view> words_of(const CLI::Option& option) {
  for (const OptionWords& one : option_words())
    if (option.check_name(std::string(one.option))) return one.words;
  return {};
}

std::string completion_script(const CLI::App& app, std::string_view shell) {
  if (shell == "bash") return bash_script(app);
  if (shell == "zsh") return zsh_script(app);
  if (shell == "fish") return fish_script(app);
  throw Error(ErrorCode::bad_argument,
              "completion: expected bash, zsh or fish, got '" + std::string(shell) + "'");
}

}  // namespace isoatlas::detail::tool
