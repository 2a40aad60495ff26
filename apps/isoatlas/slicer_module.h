// SPDX-License-Identifier: Apache-2.0
// isoatlas as a command-line module of 3D Slicer, see docs/hosts/slicer.md.
#pragma once

#include <string>
#include <vector>

#include "interruption.h"

namespace isoatlas::detail::tool {

/// The first word of a command line that runs the module: isoatlas slicer-module --isovalue 300.5
/// VOLUME MODEL. It is not a command for people, so the list of commands does not have it.
inline constexpr const char* kSlicerModule = "slicer-module";

/// Runs the module with the words after `slicer-module`. Progress goes to standard output as XML
/// elements; warnings and violated bounds go there as well, because 3D Slicer shows standard error
/// as an error.
/// @return the exit status; violated bounds give 0, because 3D Slicer discards the model of a
///         module that fails
/// @throws Error as run_extract(); Error(bad_argument) for a wrong command line
int run_slicer_module(const std::vector<std::string>& words, Interruption& interruption);

}  // namespace isoatlas::detail::tool
