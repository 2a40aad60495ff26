// SPDX-License-Identifier: Apache-2.0
// The commands of the tool. Each returns an exit status. Errors are thrown; run_tool() prints them
// as one line.
#pragma once

#include "arguments.h"
#include "interruption.h"

namespace isoatlas::detail::tool {

int run_extract(const ExtractArguments& arguments, Interruption& interruption);
int run_info(const InfoArguments& arguments);
int run_check(const CheckArguments& arguments, Interruption& interruption);
int run_levels(const LevelsArguments& arguments);
int run_picture(const PictureArguments& arguments, Interruption& interruption);
int run_report(const ReportArguments& arguments, Interruption& interruption);

}  // namespace isoatlas::detail::tool
