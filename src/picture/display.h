// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace isoatlas::detail::picture {

/// Sees to it that $DISPLAY is an X display that can be drawn to: the one that is there or, without
/// one, an Xvfb that is started for the purpose and ends with this object, or with this process.
/// Not thread-safe: it sets the environment.
class Display {
 public:
  Display();  ///< Throws Error(unsupported) if there is no display and Xvfb cannot be started
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

 private:
  void* connection_ = nullptr;  // Xvfb stays while somebody is connected
  pid_t server_ = -1;
};

}  // namespace isoatlas::detail::picture
