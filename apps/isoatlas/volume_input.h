// SPDX-License-Identifier: Apache-2.0
// Reads the volumes of the commands.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "isoatlas/volume_file.h"
#include "isoatlas/volume_reader.h"

namespace isoatlas::detail::tool {

/// Same as read_volume_file(), but its errors name the option that chooses a volume of the file.
VolumeFile read_volume_input(const std::filesystem::path& path, const ReadOptions& options);

/// The same for a volume whose parts are read when they are needed.
VolumeReader open_volume_input(const std::filesystem::path& path, const ReadOptions& options);

/// The name of the volume in messages: its path, or "standard input" for "-".
std::string volume_name(const std::filesystem::path& path);

/// Prints the warnings of the reader, one line each.
void print_warnings(std::ostream& out, const std::filesystem::path& path,
                    const VolumeSource& source);

/// "1 (GFP) of 3": the entry that was read, or the number of entries if none was read.
std::string choice_text(const FileChoice& choice);

}  // namespace isoatlas::detail::tool
