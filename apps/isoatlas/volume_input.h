// SPDX-License-Identifier: Apache-2.0
// Volumes as the commands read them.
#pragma once

#include <filesystem>
#include <string>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::tool {

/// read_volume_file() whose errors name the option that chooses.
VolumeFile read_volume_input(const std::filesystem::path& path, const ReadOptions& options);

/// What messages call the volume: its path, or "standard input" for "-".
std::string volume_name(const std::filesystem::path& path);

/// What the reader warns of, one line each on standard error.
void print_warnings(const std::filesystem::path& path, const VolumeSource& source);

/// "channel 1 of 3 (GFP)": what was read of a list, or how many entries there are if none was.
std::string choice_text(const FileChoice& choice);

}  // namespace isoatlas::detail::tool
