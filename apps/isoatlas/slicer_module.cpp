// SPDX-License-Identifier: Apache-2.0
#include "slicer_module.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "arguments.h"
#include "command_words.h"
#include "commands.h"
#include "exit_status.h"
#include "filter_progress.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "nearest_name.h"
#include "slicer_parameters.h"
#include "text.h"
#include "wording/values.h"

namespace isoatlas::detail::tool {
namespace {

/// The flags that every module has: those without a value, and those with one.
const std::set<std::string> kStandardFlags{"xml", "help", "version", "echo", "logo"};
const std::set<std::string> kStandardValues{"returnparameterfile", "processinformationaddress"};

[[noreturn]] void refuse_call(const std::string& message) {
  throw Error(ErrorCode::bad_argument, message);
}

const SlicerParameter* find_parameter(std::string_view name) {
  for (const SlicerGroup& group : slicer_groups()) {
    for (const SlicerParameter& parameter : group.parameters)
      if (parameter.name == name && !parameter.is_file()) return &parameter;
  }
  return nullptr;
}

[[noreturn]] void refuse_flag(const std::string& name) {
  std::vector<std::string> names(kStandardFlags.begin(), kStandardFlags.end());
  names.insert(names.end(), kStandardValues.begin(), kStandardValues.end());
  for (const SlicerGroup& group : slicer_groups()) {
    for (const SlicerParameter& parameter : group.parameters)
      if (!parameter.is_file()) names.emplace_back(parameter.name);
  }
  const std::string nearest = nearest_name(name, names);
  refuse_call("unknown flag --" + name +
              (nearest.empty() ? "; --xml lists the flags" : "; did you mean --" + nearest + "?"));
}

/// A command line of the module.
struct ModuleWords {
  std::map<std::string, std::string> values;  ///< by the name of the flag, without dashes
  std::vector<std::string> files;             ///< volume and model

  bool has(const std::string& name) const { return values.contains(name); }
};

ModuleWords parse(const std::vector<std::string>& words) {
  ModuleWords parsed;
  bool only_files = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string word = words[i];
    if (only_files || !is_option_like(word)) {
      parsed.files.push_back(word);
      continue;
    }
    if (word == "--" || word == "--ignore_rest") {
      only_files = true;
      continue;
    }
    if (word == "-h") word = "--help";
    const std::size_t equals = word.find('=');
    const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
    const std::string name = word.substr(begin, equals - begin);
    const SlicerParameter* parameter = find_parameter(name);
    const bool is_flag = kStandardFlags.contains(name) || (parameter && parameter->is_flag());
    if (!word.starts_with("--") || (!is_flag && !parameter && !kStandardValues.contains(name)))
      refuse_flag(name);
    if (is_flag && equals != std::string::npos) refuse_call("--" + name + " takes no value");
    if (parsed.has(name)) refuse_call("--" + name + " is given twice");
    std::string& value = parsed.values[name];
    if (is_flag) {
      value = "true";
    } else if (equals != std::string::npos) {
      value = word.substr(equals + 1);
    } else {
      if (i + 1 == words.size()) refuse_call("--" + name + " has no value");
      value = words[++i];
    }
  }
  return parsed;
}

std::string usage() {
  std::string text =
      "isoatlas as a command-line module of 3D Slicer; --xml describes it.\n"
      "Usage: IsoAtlas [flags] INPUT_VOLUME OUTPUT_MODEL\n";
  for (const SlicerGroup& group : slicer_groups()) {
    text += "\n" + std::string(group.label) + "\n";
    for (const SlicerParameter& parameter : group.parameters) {
      if (parameter.is_file()) continue;
      text += "  --" + std::string(parameter.name);
      if (!parameter.is_flag()) text += " <" + std::string(parameter.type) + ">";
      text += "\n      " + std::string(parameter.description) + ".";
      if (!parameter.default_value.empty() && !parameter.is_flag())
        text += " Default: " + std::string(parameter.default_value) + ".";
      text += "\n";
    }
  }
  return text +
         "\nStandard flags\n  --xml, --help, --version, --echo, --returnparameterfile <file>,\n"
         "  --processinformationaddress <address> (no effect)\n";
}

/// "0", "0.0" and "0.00" are the same number.
bool is_unset(const SlicerParameter& parameter, const std::string& value) {
  if (value.empty() || value == parameter.unset) return true;
  return parameter.unset == "0" && value.find_first_not_of("0.") == std::string::npos &&
         std::ranges::count(value, '.') <= 1;
}

/// Sets the options of the parameters, and the constraints in the order of the table.
void set_options(const ModuleWords& words, ExtractArguments& arguments) {
  std::vector<GoalArgument> goals;
  for (const SlicerGroup& group : slicer_groups()) {
    for (const SlicerParameter& parameter : group.parameters) {
      const std::string name(parameter.name);
      if (parameter.option.empty()) continue;
      const std::string value =
          words.has(name) ? words.values.at(name) : std::string(parameter.default_value);
      if (is_unset(parameter, value)) continue;
      try {
        if (const auto quantity = quantity_named(parameter.option))
          goals.push_back({false, {parse_bound(*quantity, value)}});
        else
          set(arguments, parameter.option, value);
      } catch (const Error& error) {
        // Some messages begin with the name on the command line of isoatlas extract.
        std::string problem = error.problem();
        const std::string theirs = std::string(parameter.option) + ": ";
        if (problem.starts_with(theirs)) problem.erase(0, theirs.size());
        throw Error(error.code(), "--" + name + ": " + problem, error.remedy());
      }
    }
  }
  arguments.goals = plan_levels(goals, arguments.coarse, arguments.options.levels);
}

ExtractArguments arguments_of(const ModuleWords& words) {
  if (words.files.size() != 2)
    refuse_call("expected two files, the volume and the model, got " +
                std::to_string(words.files.size()) + "; --xml describes the command line");
  ExtractArguments arguments;
  arguments.volume.path = words.files[0];
  arguments.mesh = words.files[1];
  for (const std::filesystem::path& file : {arguments.volume.path, arguments.mesh})
    if (file == "-") refuse_call("expected two files, got '-': a module has no standard streams");
  arguments.coarse = words.has("coarse");
  arguments.options.allow_self_intersections = words.has("allowSelfIntersections");
  if (words.has("measure")) arguments.options.measure_samples = kMeasureSamples;
  if (words.has("label")) {
    const auto label = parse_whole<std::int64_t>(words.values.at("label"));
    if (!label)
      refuse_call("--label: expected a whole number, got '" + words.values.at("label") + "'");
    if (*label != 0) arguments.labels = {*label};
  }
  if (words.has("levelFolder") && !words.values.at("levelFolder").empty())
    arguments.level_files =
        std::filesystem::path(words.values.at("levelFolder")) / "level-{level}.vtp";
  if (words.has("returnparameterfile"))
    arguments.returned_values = words.values.at("returnparameterfile");
  set_options(words, arguments);
  return arguments;
}

}  // namespace

int run_slicer_module(const std::vector<std::string>& words, Interruption& interruption) {
  const ModuleWords parsed = parse(words);
  if (parsed.has("xml")) {
    std::cout << slicer_xml();
    return kSuccess;
  }
  if (parsed.has("help")) {
    std::cout << usage();
    return kSuccess;
  }
  if (parsed.has("version")) {
    std::cout << "isoatlas " ISOATLAS_VERSION "\n";
    return kSuccess;
  }
  if (parsed.has("logo")) return kSuccess;  // it has none
  if (parsed.has("echo")) {
    std::cout << "Command line arguments:\n";
    for (const auto& [name, value] : parsed.values)
      std::cout << "    " << name << ": " << value << "\n";
    for (const std::string& file : parsed.files) std::cout << "    " << file << "\n";
  }
  const ExtractArguments arguments = arguments_of(parsed);
  FilterProgress progress("isoatlas");
  const int status = run_extract(arguments, interruption, {progress, std::cout});
  return status == kUnsatisfied ? kSuccess : status;
}

}  // namespace isoatlas::detail::tool
