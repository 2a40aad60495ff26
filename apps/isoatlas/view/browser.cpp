// SPDX-License-Identifier: Apache-2.0
#include "view/browser.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <thread>

extern char** environ;

namespace isoatlas::detail::tool {
namespace {

bool has_screen() {
#ifdef __APPLE__
  return true;
#else
  return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
#endif
}

#ifdef __APPLE__
constexpr const char* kOpener = "open";
#else
constexpr const char* kOpener = "xdg-open";
#endif

}  // namespace

bool open_in_browser(const std::string& address, const std::filesystem::path& folder) {
  if (!has_screen()) return false;
  const std::filesystem::path leads = folder / "open.html";
  std::ofstream(leads) << "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url=" << address
                       << "\"><a href=\"" << address << "\">isoatlas view</a>\n";
  std::string opener = kOpener, file = leads.string();
  std::array<char*, 3> argv{opener.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // this program blocks signals, a browser should not
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C must not end the browser
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, kOpener, &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  std::thread([process] { waitpid(process, nullptr, 0); }).detach();
  return true;
}

}  // namespace isoatlas::detail::tool
