// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "arguments.h"
#include "isoatlas/volume_reader.h"

namespace isoatlas::detail::tool {

/// A mask field needs all samples. @throws Error(unsupported) if there are labels
void require_no_labels(const ExtractArguments& arguments);

/// The size of the blocks that the arguments request, in grid cells.
Size3 block_size_of(const ExtractArguments& arguments, const VolumeReader& volume);

/// "block 3", "blocks 3 and 4", "blocks 3, 4, 5 and 7 more": never empty
std::string blocks_text(const std::vector<std::size_t>& blocks);

/// The arguments of the plan in a folder. Its working folder becomes that of this process.
/// @throws Error(bad_file), Error(bad_argument) if there is no plan, or it is from another version
ExtractArguments planned_arguments(const std::filesystem::path& folder);

}  // namespace isoatlas::detail::tool
