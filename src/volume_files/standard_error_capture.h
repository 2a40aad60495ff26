// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace isoatlas::io {

/// While one of these lives, what C libraries print on standard error goes to a temporary file. GDCM's JPEG decoder reports damaged
/// streams there and nowhere else.
///
/// Standard error is the process's, so text that another thread prints meanwhile is caught as well: keep it short, and use it under
/// LibraryMessages, whose lock lets one reader at a time do this.
class StandardErrorCapture {
 public:
  StandardErrorCapture();
  ~StandardErrorCapture();
  StandardErrorCapture(const StandardErrorCapture&) = delete;
  StandardErrorCapture& operator=(const StandardErrorCapture&) = delete;

  /// What was printed so far, at most 4096 bytes.
  std::string text() const;

 private:
  int original_ = -1;   // a copy of the descriptor of standard error; -1: nothing is captured
  int captured_ = -1;
};

}  // namespace isoatlas::io
