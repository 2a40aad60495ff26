// SPDX-License-Identifier: Apache-2.0
#include "outputs/standard_output.h"

#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <vector>

namespace isoatlas::detail {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
  throw Error(ErrorCode::bad_file, std::string(kStandardOutputName) + ": " + what + ": " +
                                       std::generic_category().message(error));
}

/// Ignores SIGPIPE during its lifetime, so that writing to a closed pipe returns an error.
class IgnorePipeSignal {
 public:
  IgnorePipeSignal() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &previous_);
  }
  ~IgnorePipeSignal() { sigaction(SIGPIPE, &previous_, nullptr); }
  IgnorePipeSignal(const IgnorePipeSignal&) = delete;
  IgnorePipeSignal& operator=(const IgnorePipeSignal&) = delete;

 private:
  struct sigaction previous_ {};
};

/// Waits until standard output is ready for writing; false if `cancel` became true.
bool wait_for_reader(const std::atomic<bool>& cancel) {
  constexpr int kMilliseconds = 50;
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  while (!cancel) {
    if (poll(&output, 1, kMilliseconds) != 0)
      return true;  // also if poll failed; write() then reports the error
  }
  return false;
}

}  // namespace

bool is_standard_stream(const fs::path& path) { return path == "-"; }

bool send_to_standard_output(std::string_view bytes, const std::atomic<bool>& cancel) {
  const IgnorePipeSignal ignore_signal;
  while (!bytes.empty()) {
    if (!wait_for_reader(cancel)) return false;
    // A pipe that is ready accepts PIPE_BUF bytes without blocking.
    const ssize_t count =
        write(STDOUT_FILENO, bytes.data(), std::min<std::size_t>(bytes.size(), PIPE_BUF));
    if (count < 0 && errno != EINTR && errno != EAGAIN) fail("cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  return true;
}

StandardOutputFile::StandardOutputFile(const std::string& name) {
  std::error_code error;
  fs::path parent = fs::temp_directory_path(error);
  if (error) parent = "/tmp";
  std::string folder = (parent / "isoatlas-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) fail("no temporary folder in " + parent.string(), errno);
  path_ = fs::path(folder) / name;
}

Error StandardOutputFile::renamed(const Error& error) const {
  std::string text = error.what();
  if (const std::size_t at = text.find(path_.string()); at != std::string::npos) {
    const bool is_full = text.find("cannot be written", at) != std::string::npos;
    const std::string where =
        is_full ? ": its temporary file in " + path_.parent_path().parent_path().string() : "";
    text.replace(at, path_.string().size(), kStandardOutputName + where);
  }
  return {error.code(), text};
}

bool StandardOutputFile::send(const std::atomic<bool>& cancel) const {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  std::ifstream file(path_, std::ios::binary);
  if (!file) fail("its temporary file is gone", errno);
  std::vector<char> piece(kPiece);
  while (file.read(piece.data(), kPiece), file.gcount() > 0)
    if (!send_to_standard_output({piece.data(), static_cast<std::size_t>(file.gcount())}, cancel))
      return false;
  if (file.bad()) fail("its temporary file cannot be read", errno);
  return true;
}

void StandardOutputFile::discard() noexcept {
  std::error_code ignored;
  fs::remove_all(path_.parent_path(), ignored);
}

}  // namespace isoatlas::detail
