// SPDX-License-Identifier: Apache-2.0
// The texts of the help pages. The texts of the options are in arguments.cpp.
#pragma once

#include "man_page.h"

namespace isoatlas::detail::tool {

// Groups of options: titles on the pages.
inline constexpr const char* kInput = "Input";
inline constexpr const char* kReading = "Reading";
inline constexpr const char* kSurface = "Surface";
inline constexpr const char* kMesh = "Mesh";
inline constexpr const char* kLevels = "Levels";
inline constexpr const char* kOutput = "Output";
inline constexpr const char* kDistance = "Distance";
inline constexpr const char* kBlockOptions = "Blocks";
inline constexpr const char* kRunning = "Running";

ManPage::Text tool_page();
ManPage::Text extract_page();
ManPage::Text blocks_plan_page();
ManPage::Text blocks_run_page();
ManPage::Text blocks_merge_page();
ManPage::Text info_page();
ManPage::Text view_page();
ManPage::Text check_page();
ManPage::Text levels_page();
ManPage::Text report_page();
ManPage::Text picture_page();
ManPage::Text completion_page();

}  // namespace isoatlas::detail::tool
