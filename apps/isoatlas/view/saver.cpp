// SPDX-License-Identifier: Apache-2.0
#include "view/saver.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include "exit_status.h"
#include "filter_progress.h"
#include "isoatlas/error.h"
#include "view/messages.h"
#include "view/start_process.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

/// A pipe whose ends are closed in child processes, except where they replace another descriptor.
struct Pipe {
  int read_end = -1, write_end = -1;

  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(ErrorCode::internal, "no pipe can be opened");
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    close(read_end);
    close_write_end();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close_write_end() {
    if (write_end >= 0) close(write_end);
    write_end = -1;
  }
};

/// Reads what is available. @return false at the end
bool read_more(int from, std::string& into) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(from, buffer.data(), buffer.size());
  if (count > 0) into.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

/// Takes the whole lines out of `pending`. Lines of FilterProgress become messages, others are
/// appended to `text`.
void take_lines(std::string& pending, std::string& text, std::string& stage,
                ProgressMessages& progress) {
  std::size_t begin = 0;
  for (std::size_t end; (end = pending.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = pending.substr(begin, end - begin);
    if (const auto comment = filter_value(line, "filter-comment"))
      stage = *comment;
    else if (const auto fraction = filter_value(line, "filter-progress"))
      progress.show(stage, std::strtod(fraction->c_str(), nullptr));
    else if (!is_filter_line(line))
      text += line + "\n";
  }
  pending.erase(0, begin);
}

/// The line of an error, without the name of the program.
std::string error_line(const std::string& errors) {
  constexpr std::string_view kStart = "isoatlas: error: ";
  const std::size_t at = errors.rfind(kStart);
  if (at == std::string::npos) return errors.empty() ? "the extraction has stopped" : errors;
  const std::size_t begin = at + kStart.size();
  return errors.substr(begin, errors.find('\n', begin) - begin);
}

/// The text with a name in place of a path.
std::string with_name(std::string text, const std::string& path, const std::string& name) {
  for (std::size_t at = 0; (at = text.find(path, at)) != std::string::npos; at += name.size())
    text.replace(at, path.size(), name);
  return text;
}

}  // namespace

Saver::Saver(fs::path folder, Events& events) : folder_(std::move(folder)), events_(events) {}

Saver::~Saver() { end(); }

void Saver::end() {
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  stop();
  if (thread_.joinable()) thread_.join();
}

void Saver::save(std::int64_t request, std::vector<std::string> words) {
  const std::lock_guard lock(mutex_);
  if (has_ended_) throw Error(ErrorCode::bad_argument, "isoatlas view is ending");
  if (current_)
    throw Error(ErrorCode::bad_argument, "another mesh is being saved; wait for it or cancel it");
  if (thread_.joinable()) thread_.join();
  current_ = request;
  was_cancelled_ = false;
  thread_ = std::thread([this, request, words = std::move(words)] { run(request, words); });
}

void Saver::cancel(std::int64_t request) {
  const std::lock_guard lock(mutex_);
  if (current_ != request) return;
  was_cancelled_ = true;
  if (process_ > 0) kill(process_, SIGINT);
}

void Saver::stop() {
  const std::lock_guard lock(mutex_);
  was_cancelled_ = true;
  if (process_ > 0) kill(process_, SIGTERM);
}

std::optional<Saver::Saved> Saver::file(std::uint64_t id) const { return files_.get(id); }

void Saver::run(std::int64_t request, std::vector<std::string> words) {
  const fs::path name = fs::path(words.back()).filename();
  const Saved saved{folder_ / std::to_string(count_++) / name, name.string()};
  std::error_code ignored;  // of a file that pages can no longer fetch
  if (count_ > kKept) fs::remove_all(folder_ / std::to_string(count_ - kKept - 1), ignored);
  std::string result;
  try {
    fs::create_directory(saved.path.parent_path());
    words.back() = saved.path.string();
    result = result_message(request, run_command(request, words), saved);
  } catch (const Error& error) {
    result = error.code() == ErrorCode::cancelled ? message("cancelled", request)
                                                  : failure(request, error.what());
  } catch (const std::exception& error) {
    result = failure(request, error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    current_.reset();
  }
  events_.send(result);  // from now on, pages may save again
}

Saver::Output Saver::run_command(std::int64_t request, const std::vector<std::string>& words) {
  std::vector<std::string> all{"isoatlas", kFilterProgressFlag};
  all.insert(all.end(), words.begin(), words.end());
  Pipe out, errors;
  pid_t process = -1;
  {
    const std::lock_guard lock(mutex_);
    if (was_cancelled_) throw Error(ErrorCode::cancelled, "cancelled");
    process = process_ = start_process("/proc/self/exe", all, out.write_end, errors.write_end);
  }
  if (process < 0) throw Error(ErrorCode::internal, "the extraction cannot be started");
  out.close_write_end();
  errors.close_write_end();

  Output output;
  ProgressMessages progress(events_, request);
  std::string pending, stage;
  bool has_text = true, has_errors = true;
  while (has_text || has_errors) {
    std::array<pollfd, 2> ready{pollfd{has_text ? out.read_end : -1, POLLIN, 0},
                                pollfd{has_errors ? errors.read_end : -1, POLLIN, 0}};
    if (poll(ready.data(), ready.size(), -1) < 0) continue;
    if (ready[0].revents != 0) has_text = read_more(out.read_end, pending);
    if (ready[1].revents != 0) has_errors = read_more(errors.read_end, output.errors);
    take_lines(pending, output.text, stage, progress);
  }
  output.text += pending;
  // Not yet reaped, so that cancel() cannot reach another process with the same number.
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOWAIT);
  const std::lock_guard lock(mutex_);
  waitpid(process, &output.status, 0);
  process_ = -1;
  return output;
}

std::string Saver::result_message(std::int64_t request, const Output& output, const Saved& saved) {
  const int status = WIFEXITED(output.status) ? WEXITSTATUS(output.status) : kInternal;
  const bool was_written = status == kSuccess || status == kUnsatisfied;
  {
    const std::lock_guard lock(mutex_);
    if (!was_written && was_cancelled_) return message("cancelled", request);
  }
  if (!was_written) return failure(request, error_line(output.errors));
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(saved.path, error);
  if (error) return failure(request, "the file has disappeared");
  // Where the browser puts the file is not known; the folder of this process is deleted.
  const std::string summary =
      with_name(output.text + output.errors, saved.path.string(), saved.name);
  return saved_message(request,
                       {files_.keep(saved), saved.name, bytes, status == kSuccess, summary});
}

}  // namespace isoatlas::detail::tool
