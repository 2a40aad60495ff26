// SPDX-License-Identifier: Apache-2.0
#include "volume_files/standard_error_capture.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace isoatlas::io {

namespace {

// A file that has no name any more; -1 if there is no place for one.
int unnamed_file() {
  std::error_code ignored;
  std::string name = (std::filesystem::temp_directory_path(ignored) / "isoatlas_XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file >= 0) {
    ::unlink(name.c_str());
  }
  return file;
}

}  // namespace

StandardErrorCapture::StandardErrorCapture() {
  std::fflush(stderr);
  captured_ = unnamed_file();
  original_ = captured_ < 0 ? -1 : ::dup(STDERR_FILENO);
  if (original_ >= 0) {
    ::dup2(captured_, STDERR_FILENO);
  }
}

StandardErrorCapture::~StandardErrorCapture() {
  std::fflush(stderr);
  if (original_ >= 0) {
    ::dup2(original_, STDERR_FILENO);
    ::close(original_);
  }
  if (captured_ >= 0) {
    ::close(captured_);
  }
}

std::string StandardErrorCapture::text() const {
  std::fflush(stderr);
  std::array<char, 4096> bytes{};
  const ::ssize_t count = original_ < 0 ? 0 : ::pread(captured_, bytes.data(), bytes.size(), 0);
  return std::string(bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
}

}  // namespace isoatlas::io
