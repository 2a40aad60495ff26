// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "progress_display.h"

namespace isoatlas::detail::tool {

/// A line on standard error that shows the progress and is erased at the end. Silent unless
/// standard error is a terminal.
class ProgressBar : public ProgressDisplay {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() override { ProgressBar::erase(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// The line is also redrawn between calls, to update the time.
  void show(std::string_view stage, std::optional<double> fraction) override;
  void clear_line() override;
  void erase() override;

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
