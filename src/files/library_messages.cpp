// SPDX-License-Identifier: Apache-2.0
#include "files/library_messages.h"

#include <iostream>

namespace isoatlas::detail::io {

namespace {

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

LibraryMessages::LibraryMessages()
    : lock_(library_mutex()),
      cerr_buffer_(std::cerr.rdbuf(sink_.rdbuf())),
      cout_buffer_(std::cout.rdbuf(sink_.rdbuf())) {}

LibraryMessages::~LibraryMessages() {
  std::cout.rdbuf(cout_buffer_);
  std::cerr.rdbuf(cerr_buffer_);
}

}  // namespace isoatlas::detail::io
