// SPDX-License-Identifier: Apache-2.0
#include "view/start_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

extern char** environ;

namespace isoatlas::detail::tool {
namespace {

void redirect(posix_spawn_file_actions_t& actions, int stream, int to) {
  if (to >= 0)
    posix_spawn_file_actions_adddup2(&actions, to, stream);
  else
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
}

}  // namespace

pid_t start_process(const char* program, std::vector<std::string> words, int out, int errors) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  redirect(actions, STDIN_FILENO, -1);
  redirect(actions, STDOUT_FILENO, out);
  redirect(actions, STDERR_FILENO, errors);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, program, &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? process : -1;
}

}  // namespace isoatlas::detail::tool
