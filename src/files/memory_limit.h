// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace isoatlas::detail::io {

/// Three quarters of the memory that this process may use: the machine's, or the limit of its
/// control group or its address space (`ulimit -v`) where that is less.
std::uint64_t default_memory_limit();

}  // namespace isoatlas::detail::io
