// SPDX-License-Identifier: Apache-2.0
// The options that a page of `isoatlas view` sets, as the command line that does the same.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"

namespace isoatlas::detail::tool {

/// Names and values of options of `isoatlas extract`, without dashes; a flag has an empty value.
using PageOptions = std::vector<std::pair<std::string, std::string>>;

/// The words of a command line, without "isoatlas": the volume as it was opened, the options, and
/// the output. Regions of the page count from the first sample that was read.
/// @param output  the mesh file
/// @throws Error(bad_argument) for an option that a page may not set: one that names files
std::vector<std::string> extract_words(const ViewArguments& opened, const PageOptions& options,
                                       const std::string& output);

/// The region of interest, in samples of the volume that was read; none: all of it.
/// @throws Error(bad_argument) unless it has two or more samples of the volume along each axis
std::optional<Region> region_of(const PageOptions& options, const Size3& size);

/// Parses the words as the tool does. Throws Error(bad_argument).
ExtractArguments parse_extract(std::vector<std::string> words);

/// The file name that a mesh of the volume has: "head.ply" for "/scans/head.nii.gz".
/// @throws Error(bad_argument) if it is not the format of a single file
std::string mesh_name(const ViewArguments& opened, const std::string& format);

}  // namespace isoatlas::detail::tool
