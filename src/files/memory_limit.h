// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace isoatlas::detail::io {

/// Three quarters of the memory that this process may use: that of the machine, or the limit of its
/// control group or address space (`ulimit -v`) if that is less.
std::uint64_t default_memory_limit();

}  // namespace isoatlas::detail::io
