// SPDX-License-Identifier: Apache-2.0
// The command line tool: parse, run one command, turn what was thrown into one line and an exit status.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>
#include <new>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "exit_status.h"
#include "interruption.h"
#include "isoatlas/error.h"
#include "text.h"

namespace {

using namespace isoatlas;
using namespace isoatlas::tool;

int fail(int status, const std::string& message) {
  std::cerr << "isoatlas: error: " << one_line(message) << std::endl;
  return status;
}

int fail_internal(const std::string& message) {
  return fail(kInternal, message + "; nothing was written. This is a bug of isoatlas: please report it with the input");
}

int interrupted(const Interruption& interruption) {
  std::cerr << "isoatlas: " << kInterruptedMessage << std::endl;
  return interruption.exit_status();
}

int run(const std::function<int()>& command, Interruption& interruption) {
  // settle() first in every handler: from there on this thread alone speaks.
  try {
    const int status = command();
    interruption.settle();
    std::cout.flush();
    return std::cout ? status : fail(kBadInput, "cannot write to standard output");
  } catch (const Error& error) {
    interruption.settle();
    switch (error.code()) {
      case ErrorCode::cancelled:
        return interrupted(interruption);
      case ErrorCode::internal:
        return fail_internal(error.what());
      case ErrorCode::out_of_memory:
        return fail(kOutOfMemory, std::string(error.what()) + "; nothing was written");
      default:
        return fail(exit_status(error.code()), error.what());
    }
  } catch (const std::bad_alloc&) {
    interruption.settle();
    return fail(kOutOfMemory, "out of memory; nothing was written");
  } catch (const std::exception& error) {
    interruption.settle();
    return fail_internal(std::string("unexpected: ") + error.what());
  } catch (...) {
    interruption.settle();
    return fail_internal("unexpected exception");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Interruption interruption;
  CLI::App app;
  describe_tool(app);
  ExtractArguments extract_arguments;
  InfoArguments info_arguments;
  CheckArguments check_arguments;
  LevelsArguments levels_arguments;
  ReportArguments report_arguments;
  PictureArguments picture_arguments;
  const CLI::App* extract_command = add_extract_command(app, extract_arguments);
  const CLI::App* info_command = add_info_command(app, info_arguments);
  const CLI::App* levels_command = add_levels_command(app, levels_arguments);
  const CLI::App* report_command = add_report_command(app, report_arguments);
  const CLI::App* picture_command = add_picture_command(app, picture_arguments);
  add_check_command(app, check_arguments);

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    return fail(kBadInput,
                std::string(error.what()) + " (see isoatlas " + (chosen.empty() ? "" : chosen.front()->get_name() + " ") + "--help)");
  }
  extract_arguments.command = command_text({argv + 1, argv + argc});
  if (extract_command->parsed()) return run([&] { return run_extract(extract_arguments, interruption); }, interruption);
  if (info_command->parsed()) return run([&] { return run_info(info_arguments); }, interruption);
  if (levels_command->parsed()) return run([&] { return run_levels(levels_arguments); }, interruption);
  if (report_command->parsed()) return run([&] { return run_report(report_arguments, interruption); }, interruption);
  if (picture_command->parsed()) return run([&] { return run_picture(picture_arguments, interruption); }, interruption);
  return run([&] { return run_check(check_arguments, interruption); }, interruption);
}
