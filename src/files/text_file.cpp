// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/text_file.h"

#include "files/atomic_file.h"
#include "files/file_error.h"

namespace isoatlas {
using namespace detail;

std::string read_text_file(const std::filesystem::path& path) { return io::file_contents(path); }

void write_text_file(const std::string& text, const std::filesystem::path& path) {
  io::AtomicFile file(path);
  file.stream() << text;
  file.commit();
}

}  // namespace isoatlas
