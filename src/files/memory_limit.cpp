// SPDX-License-Identifier: Apache-2.0
#include "files/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace isoatlas::io {

std::uint64_t default_memory_limit() {
  std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t limit = 0;  // "max" where there is none
    if (std::ifstream(file) >> limit && limit > 0) {
      bytes = std::min(bytes, limit);
    }
  }
  return bytes / 4 * 3;
}

}  // namespace isoatlas::io
