// SPDX-License-Identifier: Apache-2.0
#include "outputs/output_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace fs = std::filesystem;
namespace {

fs::path make_hidden_folder(const fs::path& parent, const fs::path& destination) {
  std::string pattern = (parent / ".isoatlas-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    const std::error_code error(errno, std::generic_category());
    throw Error(ErrorCode::bad_file, destination.string() + ": cannot be written: " +
                                         error.message() + " (folder " + parent.string() + ")");
  }
  return pattern;
}

/// Removes a folder. It tries again because another thread may still create files in it; that is
/// impossible once the folder is gone.
void remove_folder(const fs::path& folder) {
  constexpr int kAttempts = 100;
  std::error_code error;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    fs::remove_all(folder, error);
    if (!fs::exists(folder, error)) return;
  }
}

/// Moves files one by one. The destructor reverts all moves unless done() was called.
class Transaction {
 public:
  ~Transaction() {
    std::error_code ignored;
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
      if (!step->backup.empty())
        fs::rename(step->backup, step->target, ignored);
      else
        fs::remove(step->target, ignored);  // a file, or a folder that is empty again
    }
  }
  Transaction() = default;
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void make_folder(const fs::path& folder) {
    std::error_code error;
    if (fs::create_directory(folder, error)) steps_.push_back({folder, {}});
    require(!error, folder, error);
  }

  /// @param backup  an unused name on the same file system
  void move(const fs::path& from, const fs::path& to, const fs::path& backup) {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(to, error);
    const bool replaces = fs::exists(status);
    if (fs::is_directory(status))
      require(false, to, std::make_error_code(std::errc::is_a_directory));
    if (replaces) {
      // With a hard link, a file exists at `to` at any time. Not every file system has hard links.
      fs::create_hard_link(to, backup, error);
      if (error) fs::rename(to, backup, error);
      require(!error, to, error);
    }
    fs::rename(from, to, error);
    if (!error || replaces) steps_.push_back({to, replaces ? backup : fs::path()});
    require(!error, to, error);
  }

  void done() { steps_.clear(); }

 private:
  struct Step {
    fs::path target, backup;
  };
  static void require(bool good, const fs::path& path, const std::error_code& error) {
    if (!good)
      throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: " + error.message());
  }
  std::vector<Step> steps_;
};

}  // namespace

fs::path resolved(const fs::path& path) {
  std::error_code error;
  fs::path result = fs::weakly_canonical(fs::absolute(path, error), error);
  return error || result.empty() ? path : result;
}

fs::path target_of(const fs::path& path) {
  std::error_code error;
  return fs::is_symlink(fs::symlink_status(path, error)) ? resolved(path) : path;
}

void check_output_path(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status))
    throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorCode::bad_file,
                path.string() + ": cannot be written: it is not a regular file");
  if (!path.has_filename())
    throw Error(ErrorCode::bad_file,
                path.string() + ": cannot be written: the file name is missing");
  const fs::path parent = resolved(path).parent_path();
  if (!fs::is_directory(parent, error))
    throw Error(ErrorCode::bad_file,
                path.string() + ": cannot be written: there is no folder " + parent.string());
  fs::remove(make_hidden_folder(parent, path), error);
}

bool same_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return true;  // hard links too
  return resolved(a) == resolved(b);
}

fs::path OutputFiles::stage(const fs::path& destination) {
  const std::lock_guard lock(mutex_);
  if (discarded_) throw Error(ErrorCode::cancelled, "outputs were discarded");
  const fs::path target = resolved(destination);
  staged_.push_back({make_hidden_folder(target.parent_path(), destination), target});
  return staged_.back().file();
}

Error OutputFiles::renamed(const Error& error, const fs::path& staged,
                           const fs::path& destination) {
  const std::string hidden = (staged.parent_path() / "").string(),
                    shown = (target_of(destination).parent_path() / "").string();
  std::string text = error.what();
  for (std::size_t at = text.find(hidden); at != std::string::npos;
       at = text.find(hidden, at + shown.size()))
    text.replace(at, hidden.size(), shown);
  return {error.code(), text};
}

std::vector<OutputFiles::Move> OutputFiles::moves_of(const Staged& staged) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staged.folder))
    if (!entry.is_directory() && entry.path() != staged.file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  // The last one, because it may refer to the others.
  if (!fs::is_directory(staged.file())) files.push_back(staged.file());
  std::vector<Move> moves;
  for (const fs::path& file : files) {
    const fs::path destination =
        file == staged.file()
            ? staged.destination
            : resolved(staged.destination.parent_path() / file.lexically_relative(staged.folder));
    moves.push_back({file, destination, staged.folder / (".old-" + std::to_string(moves.size()))});
  }
  return moves;
}

void OutputFiles::commit() {
  const std::lock_guard lock(mutex_);
  Transaction transaction;
  for (const Staged& staged : staged_) {
    for (const Move& move : moves_of(staged)) {
      if (move.to.parent_path() != staged.destination.parent_path())
        transaction.make_folder(move.to.parent_path());
      transaction.move(move.from, move.to, move.backup);
    }
  }
  transaction.done();
}

void OutputFiles::discard() noexcept {
  const std::lock_guard lock(mutex_);
  discarded_ = true;
  for (const Staged& staged : staged_) remove_folder(staged.folder);
  staged_.clear();
}

}  // namespace isoatlas::detail
