// SPDX-License-Identifier: Apache-2.0
// Runs the extractions whose results a page of `isoatlas view` saves.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "view/events.h"
#include "view/kept_results.h"

namespace isoatlas::detail::tool {

/// One extraction at a time, in a process of its own: the very command that the page shows. So its
/// file has the same bytes, its memory is freed when it ends, and stopping it is Ctrl-C.
class Saver {
 public:
  struct Saved {
    std::filesystem::path path;
    std::string name;  ///< of the download
  };

  /// @param folder  for the files, which are deleted with it
  Saver(std::filesystem::path folder, Events& events);
  /// end()
  ~Saver();
  Saver(const Saver&) = delete;
  Saver& operator=(const Saver&) = delete;

  /// Starts a command; messages report its progress and its end.
  /// @param words  of the command line, ending in "-o" and the name of the file
  /// @throws Error(bad_argument) if another one runs, or after end()
  void save(std::int64_t request, std::vector<std::string> words);

  /// Stops a command, if it still runs.
  void cancel(std::int64_t request);

  /// Stops any command, without a message. May be called from another thread.
  void stop();
  /// Stops any command and waits for its end. Later save() are refused: the server still answers.
  void end();

  std::optional<Saved> file(std::uint64_t id) const;

 private:
  struct Output {
    std::string text, errors;  // what the command printed
    int status = 0;            // as waitpid()
  };

  void run(std::int64_t request, std::vector<std::string> words);
  Output run_command(std::int64_t request, const std::vector<std::string>& words);
  std::string result_message(std::int64_t request, const Output& output, const Saved& saved);

  const std::filesystem::path folder_;
  Events& events_;
  static constexpr std::size_t kKept = 8;
  KeptResults<Saved> files_{kKept};
  std::uint64_t count_ = 0;  // of commands

  std::mutex mutex_;  // protects the members below
  std::optional<std::int64_t> current_;
  pid_t process_ = -1;
  bool was_cancelled_ = false;
  bool has_ended_ = false;
  std::thread thread_;
};

}  // namespace isoatlas::detail::tool
