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

// The promise is one second; the rest of it is for the cleanups.
constexpr std::chrono::milliseconds kGrace{700};
constexpr int kWakeUp = SIGUSR1;  // how the destructor gets the watcher out of sigwait

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
  watcher_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
  settle();
  stopping_ = true;
  pthread_kill(watcher_.native_handle(), kWakeUp);
  watcher_.join();
}

int Interruption::exit_status() const { return kSignalBase + signal_; }

void Interruption::commit(const std::function<void()>& last_step) {
  const std::lock_guard lock(mutex_);
  if (requested_) throw Error(ErrorCode::cancelled, kInterruptedMessage);
  last_step();
  settled_ = true;
  settled_changed_.notify_all();
}

void Interruption::settle() {
  const std::lock_guard lock(mutex_);
  settled_ = true;
  settled_changed_.notify_all();
}

void Interruption::watch() {
  int signal = 0;
  do {
    if (sigwait(&signals_, &signal) != 0 || stopping_) return;
  } while (signal == kWakeUp);
  signal_ = signal;
  requested_ = true;

  std::unique_lock lock(mutex_);
  if (settled_changed_.wait_for(lock, kGrace, [this] { return settled_; })) return;
  // From here to the end the lock is held: the main thread can neither commit nor say anything
  // else.
  for (const auto* run : cleanups_) (*run)();
  std::fprintf(stderr, "isoatlas: %s\n", kInterruptedMessage);
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
