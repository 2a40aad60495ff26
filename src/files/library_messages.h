// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <sstream>
#include <streambuf>

namespace isoatlas::detail::io {

/// While an object of this class exists, messages that decoding libraries write to std::cerr and
/// std::cout do not reach the terminal.
///
/// Those streams and the error handlers of libtiff belong to the whole process, so the object holds
/// a lock: files that need it are read one at a time.
class LibraryMessages {
 public:
  LibraryMessages();
  ~LibraryMessages();
  LibraryMessages(const LibraryMessages&) = delete;
  LibraryMessages& operator=(const LibraryMessages&) = delete;

 private:
  std::lock_guard<std::mutex> lock_;
  std::ostringstream sink_;
  std::streambuf* cerr_buffer_;
  std::streambuf* cout_buffer_;
};

}  // namespace isoatlas::detail::io
