// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>

namespace isoatlas::io {

/// While one of these lives, what ITK, VTK and the libraries below them have to say is collected here instead of
/// reaching the terminal. A user gets our one line; the collected text tells us about trouble they do not throw for.
///
/// The state behind it (output windows, std::cerr's buffer) is global to the process, hence the lock: file reading
/// through ITK and VTK is one at a time.
class LibraryMessages {
 public:
  LibraryMessages();
  ~LibraryMessages();
  LibraryMessages(const LibraryMessages&) = delete;
  LibraryMessages& operator=(const LibraryMessages&) = delete;

  /// The first error that VTK reported, shortened to its message; empty if there was none.
  std::string first_vtk_error() const;

 private:
  struct Windows;
  std::lock_guard<std::mutex> lock_;
  std::unique_ptr<Windows> windows_;
};

/// The message of an ITK or VTK error text without class names, addresses and source lines.
std::string short_message(const std::string& text);

}  // namespace isoatlas::io
