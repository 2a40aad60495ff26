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

/// One line on stderr that is redrawn now and then and gone at the end; silent unless stderr is a
/// terminal.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { erase(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` of the whole in [0, 1]; none: it is not known. Redrawn now and then without being
  /// called, as time goes on.
  void show(std::string_view stage, std::optional<double> fraction);
  void clear_line();  ///< makes room for a message
  void erase();       ///< nothing is drawn after it

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
  std::jthread clock_;  // the last one, as it uses the others
};

}  // namespace isoatlas::detail::tool
