// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace isoatlas::detail::tool {

/// Starts a program that Ctrl-C does not reach, without standard input. This program blocks
/// signals; the other one does not.
/// @param program  a path, or a name that is searched on PATH
/// @param words    its arguments, starting with its name
/// @param out, errors  file descriptors for its output streams; -1: its output is discarded
/// @return the process; -1 if it cannot be started
pid_t start_process(const char* program, std::vector<std::string> words, int out = -1,
                    int errors = -1);

}  // namespace isoatlas::detail::tool
