// SPDX-License-Identifier: Apache-2.0
// Messages from the threads of `isoatlas view` to its open pages.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace isoatlas::detail::tool {

/// Keeps the last messages. Every page reads all that are sent after it has opened, also while its
/// connection is broken for a moment. Thread-safe.
class Events {
 public:
  using Number = std::uint64_t;
  using Clock = std::chrono::steady_clock;

  /// @param message  one line
  void send(std::string message);

  /// To be called when a page opens.
  /// @param last  the last message that it has read before its connection broke, if any
  /// @return the number of the first message that it will get
  Number open(std::optional<Number> last = std::nullopt);
  /// To be called when it has closed.
  void close();

  /// Waits for messages from `next` on.
  /// @return them, each as an event of text/event-stream; `next` is then that of the first later
  ///         one. Empty after `patience`
  std::string wait(Number& next, std::chrono::milliseconds patience);

  /// True if pages were open, and none has been open for this time.
  bool all_closed_for(Clock::duration time) const;
  std::size_t open_pages() const;

 private:
  static constexpr std::size_t kKept = 500;
  mutable std::mutex mutex_;
  std::condition_variable sent_;
  std::deque<std::string> messages_;
  Number first_ = 0;  // number of messages_.front()
  std::size_t pages_ = 0;
  bool had_page_ = false;
  Clock::time_point last_closed_{};
};

}  // namespace isoatlas::detail::tool
