// SPDX-License-Identifier: Apache-2.0
// The commands of the tool. Each returns an exit status. Errors are thrown; run_tool() prints them
// as one line.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "arguments.h"
#include "interruption.h"
#include "progress_display.h"

namespace isoatlas::detail::tool {

/// Where a run shows its progress, and the stream for warnings and violated bounds.
struct RunConsole {
  ProgressDisplay& progress;
  std::ostream& messages;
};

int run_extract(const ExtractArguments& arguments, Interruption& interruption);
/// run_extract() with another console than the terminal.
int run_extract(const ExtractArguments& arguments, Interruption& interruption,
                const RunConsole& console);
/// @param words  the command line of `extract` that the plan is for
int run_blocks_plan(const ExtractArguments& arguments, const std::vector<std::string>& words);
int run_blocks_run(const BlocksArguments& arguments, Interruption& interruption);
int run_blocks_merge(const BlocksArguments& arguments, Interruption& interruption);
int run_info(const InfoArguments& arguments);
int run_view(const ViewArguments& arguments, Interruption& interruption);
int run_check(const CheckArguments& arguments, Interruption& interruption);
int run_levels(const LevelsArguments& arguments);
int run_picture(const PictureArguments& arguments, Interruption& interruption);
int run_report(const ReportArguments& arguments, Interruption& interruption);

}  // namespace isoatlas::detail::tool
