// SPDX-License-Identifier: Apache-2.0
#include "tool.h"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "completion.h"
#include "error_text.h"
#include "exit_status.h"
#include "file_kinds.h"
#include "filter_progress.h"
#include "interruption.h"
#include "isoatlas/error.h"
#include "man_page.h"
#include "slicer_module.h"
#include "text.h"
#include "typing_help.h"

namespace isoatlas::detail::tool {
namespace {

int fail(int status, const std::string& message) {
  std::cerr << "isoatlas: error: " << one_line(message) << std::endl;
  return status;
}

int fail_internal(const std::string& message) {
  return fail(
      kInternal,
      message +
          "; nothing was written. This is a bug of isoatlas: please report it with the input");
}

int interrupted(const Interruption& interruption) {
  std::cerr << "isoatlas: " << interruption.message() << std::endl;
  return interruption.exit_status();
}

/// " (see isoatlas extract --help)": the help page of the command that was typed.
std::string see_help(const CLI::App& app, const std::vector<std::string>& words) {
  const auto is_typed = [&](const CLI::App* command) {
    return !words.empty() && command->get_name() == words.front();
  };
  const auto commands = app.get_subcommands(is_typed);
  return " (see isoatlas " + (commands.empty() ? "" : typed_name(*commands.front()) + " ") +
         "--help)";
}

/// An input file, and the name of the command that reads it, as in advice_for_file().
struct Input {
  std::string command;
  std::filesystem::path path;
};

/// Advice on the input file that `error` is about: the command that reads files of its kind.
std::string advice(const Error& error, const std::vector<Input>& inputs) {
  const std::string message = error.what();
  for (const Input& input : inputs) {
    if (!message.starts_with(input.path.string() + ": ")) continue;
    const std::string text = advice_for_file(input.command, input.path);
    return text.empty() || message.find(text) != std::string::npos ? "" : "; " + text;
  }
  return "";
}

std::string advice_on_isovalue(const std::vector<Input>& inputs) {
  if (inputs.size() != 1 || inputs.front().path == "-") return "";
  return "; `isoatlas info " + inputs.front().path.string() + "` suggests isovalues";
}

int run(const std::function<int()>& command, Interruption& interruption,
        const std::vector<Input>& inputs) {
  // Every handler calls finish() first: after it, only this thread prints.
  try {
    const int status = command();
    interruption.finish();
    std::cout.flush();
    return std::cout ? status : fail(kBadInput, "cannot write to standard output");
  } catch (const Error& error) {
    interruption.finish();
    switch (error.code()) {
      case ErrorCode::cancelled:
        return interrupted(interruption);
      case ErrorCode::internal:
        return fail_internal(error.what());
      case ErrorCode::out_of_memory:
        return fail(kOutOfMemory, error_text(error) + "; nothing was written");
      case ErrorCode::empty_surface:
        return fail(exit_status(error.code()), error_text(error) + advice_on_isovalue(inputs));
      case ErrorCode::bad_file:
      case ErrorCode::unsupported:
        return fail(exit_status(error.code()), error_text(error) + advice(error, inputs));
      default:
        return fail(exit_status(error.code()), error_text(error));
    }
  } catch (const std::bad_alloc&) {
    interruption.finish();
    return fail(kOutOfMemory, "out of memory; nothing was written");
  } catch (const std::exception& error) {
    interruption.finish();
    return fail_internal(std::string("unexpected: ") + error.what());
  } catch (...) {
    interruption.finish();
    return fail_internal("unexpected exception");
  }
}

/// Turns "blocks plan" into "blocks-plan", the name of the command, and likewise run and merge.
void join_block_commands(std::vector<std::string>& words) {
  const std::size_t at = !words.empty() && words[0] == "help" ? 1 : 0;
  if (words.size() < at + 2 || words[at] != "blocks") return;
  const std::string& step = words[at + 1];
  if (step != "plan" && step != "run" && step != "merge") return;
  words[at] += "-" + step;
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(at) + 1);
}

}  // namespace

int run_tool(int argc, char** argv) {
  Interruption interruption;
  if (const std::vector<std::string> typed(argv + 1, argv + argc);
      !typed.empty() && (typed[0] == kSlicerModule || typed[0] == "--xml")) {
    const auto words = std::vector(typed.begin() + (typed[0] == kSlicerModule), typed.end());
    return run([&] { return run_slicer_module(words, interruption); }, interruption, {});
  }
  CLI::App app;
  describe_tool(app);
  ExtractArguments extract_arguments, plan_arguments;
  BlocksArguments blocks_arguments;
  InfoArguments info_arguments;
  ViewArguments view_arguments;
  CheckArguments check_arguments;
  LevelsArguments levels_arguments;
  ReportArguments report_arguments;
  PictureArguments picture_arguments;
  CompletionArguments completion_arguments;
  const CLI::App* extract_command = add_extract_command(app, extract_arguments);
  const CLI::App* plan_command = add_blocks_plan_command(app, plan_arguments);
  const CLI::App* blocks_run_command = add_blocks_run_command(app, blocks_arguments);
  const CLI::App* merge_command = add_blocks_merge_command(app, blocks_arguments);
  const CLI::App* info_command = add_info_command(app, info_arguments);
  const CLI::App* view_command = add_view_command(app, view_arguments);
  add_check_command(app, check_arguments);
  const CLI::App* levels_command = add_levels_command(app, levels_arguments);
  const CLI::App* report_command = add_report_command(app, report_arguments);
  const CLI::App* picture_command = add_picture_command(app, picture_arguments);
  const CLI::App* completion_command = add_completion_command(app, completion_arguments);

  std::vector<std::string> typed(argv + 1, argv + argc);
  const bool shows_filter_progress = !typed.empty() && typed[0] == kFilterProgressFlag;
  if (shows_filter_progress) typed.erase(typed.begin());
  join_block_commands(typed);
  std::vector<std::string> words = in_standard_form(app, typed);
  if (words.empty()) {
    std::cerr << usage(app);
    return kBadInput;
  }
  if (const std::string mistake = find_mistake(app, words); !mistake.empty())
    return fail(kBadInput, mistake + see_help(app, words));
  try {
    std::reverse(words.begin(), words.end());  // the order that CLI11 expects
    app.parse(words);
  } catch (const CLI::Success& request) {  // --help, --version
    const int status = app.exit(request);
    std::cout.flush();
    return std::cout ? status : fail(kBadInput, "cannot write to standard output");
  } catch (const CLI::ParseError& error) {
    return fail(kBadInput, error.what() + see_help(app, typed));
  }
  extract_arguments.command = command_text(typed);
  const auto run_on = [&](const std::function<int()>& command, const std::vector<Input>& inputs) {
    return run(command, interruption, inputs);
  };
  if (extract_command->parsed())
    return run_on(
        [&] {
          if (!shows_filter_progress) return run_extract(extract_arguments, interruption);
          FilterProgress progress("isoatlas");
          return run_extract(extract_arguments, interruption, {progress, std::cerr});
        },
        {{"extract", extract_arguments.volume.path}});
  if (plan_command->parsed())
    return run_on(
        [&] {
          return run_blocks_plan(plan_arguments, std::vector(typed.begin() + 1, typed.end()));
        },
        {{"extract", plan_arguments.volume.path}});
  if (blocks_run_command->parsed())
    return run_on([&] { return run_blocks_run(blocks_arguments, interruption); }, {});
  if (merge_command->parsed())
    return run_on([&] { return run_blocks_merge(blocks_arguments, interruption); }, {});
  if (info_command->parsed())
    return run_on([&] { return run_info(info_arguments); }, {{"info", info_arguments.volume.path}});
  if (view_command->parsed())
    return run_on([&] { return run_view(view_arguments, interruption); },
                  {{"view", view_arguments.volume.path}});
  if (levels_command->parsed())
    return run_on([&] { return run_levels(levels_arguments); },
                  {{"levels", levels_arguments.file}});
  if (report_command->parsed()) {
    std::vector<Input> results;
    for (const std::filesystem::path& result : report_arguments.results)
      results.push_back({"report", result});
    return run_on([&] { return run_report(report_arguments, interruption); }, results);
  }
  if (picture_command->parsed())
    return run_on([&] { return run_picture(picture_arguments, interruption); },
                  {{"picture", picture_arguments.mesh}});
  if (completion_command->parsed()) {
    const auto print = [&] {
      std::cout << completion_script(app, completion_arguments.shell);
      return kSuccess;
    };
    return run_on(print, {});
  }
  return run_on(
      [&] { return run_check(check_arguments, interruption); },
      {{"check", check_arguments.mesh}, {"check --volume", check_arguments.volume.value_or("")}});
}

}  // namespace isoatlas::detail::tool
