// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and other signals to stop: the tool ends within a second and leaves no partial file.
#pragma once

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace isoatlas::detail::tool {

/// Waits for SIGINT, SIGTERM and SIGHUP on a separate thread.
///
/// The signals are blocked on all other threads. No code runs inside a signal handler, so all code
/// may lock and allocate. When a signal arrives, requested() becomes true and the computation has
/// kGrace to return. Code that does not check the flag (a library that reads a file, a mesh being
/// written) is cut off after that: the cleanups run, then the process exits. commit() and this exit
/// exclude each other by a lock, so outputs appear complete or not at all.
///
/// Construct one at the start of main(): threads that exist earlier do not have the signals
/// blocked. Signals that are ignored when the tool starts (nohup, background jobs of some shells)
/// stay ignored.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  const std::atomic<bool>& requested() const { return requested_; }
  int exit_status() const;  ///< 128 + signal
  /// What is printed about an interrupted run, after "isoatlas: ".
  const char* message() const { return message_; }
  /// Sets the message of a run that keeps what it has made so far.
  /// @param text  not copied
  void set_message(const char* text) { message_ = text; }

  /// Runs `last_step`; later interruptions have no effect. Throws Error(cancelled) if an
  /// interruption came before.
  void commit(const std::function<void()>& last_step);

  /// To be called when the command has returned or thrown: nothing is left to interrupt. Does not
  /// return if the forced exit has already begun.
  void finish();

  /// During its lifetime, `run` is called before a forced exit. It must be safe to call while other
  /// threads are running.
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
  void wait_for_signal();

  sigset_t signals_{};
  std::atomic<bool> requested_{false}, stopping_{false};
  std::atomic<int> signal_{0};
  std::atomic<const char*> message_{"interrupted; nothing was written"};
  std::mutex mutex_;  // protects the members below
  std::condition_variable finished_changed_;
  bool finished_ = false;
  std::vector<const std::function<void()>*> cleanups_;
  std::thread waiter_;
};

}  // namespace isoatlas::detail::tool
