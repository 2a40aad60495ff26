// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace isoatlas::tool {

/// One line on stderr that is redrawn now and then and gone at the end; silent unless stderr is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { erase(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` of the stage in [0, 1]; none: it is not known.
  void show(std::string_view stage, std::optional<double> fraction);
  void clear_line();  ///< makes room for a message
  void erase();       ///< nothing is drawn after it

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(std::string_view stage, std::optional<double> fraction, Clock::time_point now) const;

  bool active_;
  bool utf8_;
  Clock::time_point started_ = Clock::now();
  std::mutex mutex_;  // erase() may come from another thread
  Clock::time_point drawn_{};
  std::string stage_;
};

}  // namespace isoatlas::tool
