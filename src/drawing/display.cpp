// SPDX-License-Identifier: Apache-2.0
#include "drawing/display.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <X11/Xlib.h>

#include <array>
#include <cstdlib>
#include <string>

#include "isoatlas/error.h"

extern char** environ;

namespace isoatlas::detail::drawing {
namespace {

constexpr int kTimeoutMs = 10'000;
constexpr const char* kNoDisplay =
    "pictures need an X display, and none was found: set DISPLAY, or install Xvfb (Debian: xvfb)";

// The line in which Xvfb reports its display number; empty if it does not arrive in time.
std::string first_line(int from) {
  std::string line;
  pollfd ready{from, POLLIN, 0};
  while (poll(&ready, 1, kTimeoutMs) == 1) {
    char c = 0;
    if (read(from, &c, 1) != 1) return "";
    if (c == '\n') return line;
    line += c;
  }
  return "";
}

// @param number_to  Xvfb writes its display number to this file descriptor
// @return the process; -1 if it cannot be started
pid_t start_xvfb(int number_to) {
  std::array<std::string, 9> arguments{"Xvfb",      "-displayfd", std::to_string(number_to),
                                       "-screen",   "0",          "640x480x24",
                                       "-nolisten", "tcp",        "-terminate"};
  std::array<char*, arguments.size() + 1> argv{};
  for (std::size_t i = 0; i < arguments.size(); ++i) argv[i] = arguments[i].data();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // the tool blocks signals, child processes should not
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C must not reach Xvfb
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t server = -1;
  const int failed = posix_spawnp(&server, "Xvfb", &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? server : -1;
}

}  // namespace

Display::Display() {
  connection_ = XOpenDisplay(nullptr);
  if (connection_ != nullptr) return;
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw Error(ErrorCode::unsupported, kNoDisplay);
  fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  server_ = start_xvfb(ends[1]);
  close(ends[1]);
  const std::string number = server_ < 0 ? "" : first_line(ends[0]);
  close(ends[0]);
  if (!number.empty()) {
    setenv("DISPLAY", (":" + number).c_str(), 1);
    connection_ = XOpenDisplay(nullptr);
  }
  if (connection_ != nullptr) return;
  if (server_ > 0) {
    kill(server_, SIGKILL);
    waitpid(server_, nullptr, 0);
  }
  throw Error(ErrorCode::unsupported, kNoDisplay);
}

Display::~Display() {
  XCloseDisplay(static_cast<::Display*>(connection_));
  if (server_ <= 0) return;
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
  unsetenv("DISPLAY");
}

}  // namespace isoatlas::detail::drawing
