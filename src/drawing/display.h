// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace isoatlas::detail::drawing {

/// Provides an X display as $DISPLAY: the existing one, or an Xvfb server that is started and ends
/// with this object or with this process. Not thread-safe, because it sets the environment.
class Display {
 public:
  /// @throws Error(unsupported) if there is no display and Xvfb cannot be started
  Display();
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

 private:
  void* connection_ = nullptr;  // Xvfb ends when its last connection is closed
  pid_t server_ = -1;
};

}  // namespace isoatlas::detail::drawing
