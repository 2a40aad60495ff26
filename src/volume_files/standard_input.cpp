// SPDX-License-Identifier: Apache-2.0
#include "volume_files/standard_input.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "files/temporary_file.h"

namespace isoatlas::detail::io {

namespace {

[[noreturn]] void fail(const char* what, int error) {
  throw bad_file(kStandardInputName, std::string(what) + ": " + system_text(error));
}

void write_all(int descriptor, const char* from, std::size_t bytes) {
  while (bytes > 0) {
    const ssize_t count = write(descriptor, from, bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be stored in a temporary file", errno);
    from += count;
    bytes -= static_cast<std::size_t>(count);
  }
}

}  // namespace

StandardInput::StandardInput() {
  if (isatty(STDIN_FILENO) != 0) {
    throw bad_file(kStandardInputName, "is a terminal, expected a volume from a pipe or a file");
  }
  descriptor_ = open_unnamed_file();
  if (descriptor_ < 0) fail("cannot be stored in a temporary file", errno);
  std::vector<char> buffer(std::size_t{1} << 20);
  std::uint64_t total = 0;
  try {
    for (;;) {
      const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail("cannot be read", errno);
      if (count == 0) break;
      write_all(descriptor_, buffer.data(), static_cast<std::size_t>(count));
      total += static_cast<std::uint64_t>(count);
    }
    if (total == 0) throw bad_file(kStandardInputName, "is empty");
  } catch (...) {
    close(descriptor_);
    throw;
  }
  path_ = "/dev/fd/" + std::to_string(descriptor_);
}

StandardInput::~StandardInput() { close(descriptor_); }

}  // namespace isoatlas::detail::io
