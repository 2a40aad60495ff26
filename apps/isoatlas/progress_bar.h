// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace isoatlas::detail::tool {

/// A line on standard error that shows the progress and is erased at the end. Silent unless
/// standard error is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { erase(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows the stage and the `fraction` of the whole in [0, 1]; none: it is unknown. The line is
  /// also redrawn between calls, to update the time.
  void show(std::string_view stage, std::optional<double> fraction);
  void clear_line();  ///< clears the line, so that a message can be printed
  void erase();       ///< erases the line; nothing is drawn afterwards

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now);
  std::string line(Clock::time_point now) const;

  bool active_;
  bool utf8_;
  Clock::time_point started_ = Clock::now();
  std::mutex mutex_;  // erase() may come from another thread
  Clock::time_point drawn_{};
  std::string stage_;
  std::optional<double> fraction_;
  std::condition_variable_any erased_;
  std::jthread clock_;  // the last member, because it uses the others
};

}  // namespace isoatlas::detail::tool
