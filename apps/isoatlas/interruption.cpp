// SPDX-License-Identifier: Apache-2.0
#include "interruption.h"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "exit_status.h"
#include "isoatlas/error.h"

namespace isoatlas::detail::tool {
namespace {

// The tool ends within one second; the remaining 0.3 s are for the cleanups.
constexpr std::chrono::milliseconds kGrace{700};
constexpr int kWakeUp = SIGUSR1;  // the destructor sends it to end the wait for signals

bool is_ignored(int signal) {
  struct sigaction current {};
  return sigaction(signal, nullptr, &current) == 0 && current.sa_handler == SIG_IGN;
}

}  // namespace

Interruption::Interruption() {
  sigemptyset(&signals_);
  sigaddset(&signals_, kWakeUp);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (!is_ignored(signal)) sigaddset(&signals_, signal);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  waiter_ = std::thread([this] { wait_for_signal(); });
}

Interruption::~Interruption() {
  finish();
  stopping_ = true;
  pthread_kill(waiter_.native_handle(), kWakeUp);
  waiter_.join();
}

int Interruption::exit_status() const { return kSignalBase + signal_; }

void Interruption::commit(const std::function<void()>& last_step) {
  const std::lock_guard lock(mutex_);
  if (requested_) throw Error(ErrorCode::cancelled, message());
  last_step();
  finished_ = true;
  finished_changed_.notify_all();
}

void Interruption::finish() {
  const std::lock_guard lock(mutex_);
  finished_ = true;
  finished_changed_.notify_all();
}

void Interruption::wait_for_signal() {
  int signal = 0;
  do {
    if (sigwait(&signals_, &signal) != 0 || stopping_) return;
  } while (signal == kWakeUp);
  signal_ = signal;
  requested_ = true;

  std::unique_lock lock(mutex_);
  if (finished_changed_.wait_for(lock, kGrace, [this] { return finished_; })) return;
  // The lock is kept until the process ends: the main thread can neither commit nor print.
  for (const auto* run : cleanups_) (*run)();
  std::fprintf(stderr, "isoatlas: %s\n", message());
  _exit(exit_status());
}

Interruption::Cleanup::Cleanup(Interruption& interruption, std::function<void()> run)
    : interruption_(interruption), run_(std::move(run)) {
  const std::lock_guard lock(interruption_.mutex_);
  interruption_.cleanups_.push_back(&run_);
}

Interruption::Cleanup::~Cleanup() {
  const std::lock_guard lock(interruption_.mutex_);
  std::erase(interruption_.cleanups_, &run_);
}

}  // namespace isoatlas::detail::tool
