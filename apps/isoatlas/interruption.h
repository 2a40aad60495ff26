// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, and what else asks the tool to stop: within a second, leaving no partial file.
#pragma once

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace isoatlas::detail::tool {

/// Waits for SIGINT, SIGTERM and SIGHUP on a thread of its own.
///
/// The signals are blocked everywhere else, so no code runs inside a signal handler and every line
/// here may lock and allocate. When one arrives, requested() becomes true and the computation has
/// kGrace to come back by itself. What does not look at the flag (a file being read by ITK, a mesh
/// being written) is cut short after that: the cleanups run, then the process exits. Between
/// commit() and that end there is a lock, so outputs appear as a whole or not at all.
///
/// Make one, first thing in main(): threads made earlier would not have the signals blocked.
/// Signals that the caller of the tool ignores (nohup, shells' background jobs) stay ignored.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  const std::atomic<bool>& requested() const { return requested_; }
  int exit_status() const;  ///< 128 + signal

  /// Runs `last_step`, after which an interruption comes too late; throws Error(cancelled) if one
  /// came first.
  void commit(const std::function<void()>& last_step);

  /// Nothing is left to interrupt: the command has returned or thrown. Does not return if the end
  /// has already begun.
  void settle();

  /// While it lives, `run` is done before a forced end; it must be safe to call while other threads
  /// go on.
  class Cleanup {
   public:
    Cleanup(Interruption& interruption, std::function<void()> run);
    ~Cleanup();
    Cleanup(const Cleanup&) = delete;
    Cleanup& operator=(const Cleanup&) = delete;

   private:
    Interruption& interruption_;
    std::function<void()> run_;
  };

 private:
  void watch();

  sigset_t signals_{};
  std::atomic<bool> requested_{false}, stopping_{false};
  std::atomic<int> signal_{0};
  std::mutex mutex_;  // guards what follows
  std::condition_variable settled_changed_;
  bool settled_ = false;
  std::vector<const std::function<void()>*> cleanups_;
  std::thread watcher_;
};

/// What an interrupted run says, after "isoatlas: ".
inline constexpr const char* kInterruptedMessage = "interrupted; nothing was written";

}  // namespace isoatlas::detail::tool
