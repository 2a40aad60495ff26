// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace isoatlas::detail::tool {

/// The command-line tool: parses the command line, runs one command and prints an error as one
/// line. Call it first in main(): it blocks the signals that stop the tool, for all threads.
/// @return the exit status
int run_tool(int argc, char** argv);

}  // namespace isoatlas::detail::tool
