// SPDX-License-Identifier: Apache-2.0
#include "output_files.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "isoatlas/error.h"

namespace isoatlas::tool {
namespace fs = std::filesystem;
namespace {

/// The place itself when `path` is a link to it: renaming onto a link would replace the link.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  fs::path result = fs::weakly_canonical(fs::absolute(path, error), error);
  return error || result.empty() ? path : result;
}

fs::path make_hidden_folder(const fs::path& parent, const fs::path& wanted_for) {
  std::string pattern = (parent / ".isoatlas-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    const std::error_code error(errno, std::generic_category());
    throw Error(ErrorCode::bad_file, wanted_for.string() + ": cannot be written: " + error.message() + " (folder " + parent.string() + ")");
  }
  return pattern;
}

/// Removes a folder even while another thread still puts files into it: once it is gone, nothing new can appear.
void remove_folder(const fs::path& folder) {
  constexpr int kAttempts = 100;
  std::error_code error;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    fs::remove_all(folder, error);
    if (!fs::exists(folder, error)) return;
  }
}

}  // namespace

void check_output_path(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: it is not a regular file");
  if (!path.has_filename()) throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: the file name is missing");
  const fs::path parent = resolved(path).parent_path();
  if (!fs::is_directory(parent, error))
    throw Error(ErrorCode::bad_file, path.string() + ": cannot be written: there is no folder " + parent.string());
  fs::remove(make_hidden_folder(parent, path), error);
}

bool same_file(const fs::path& a, const fs::path& b) {
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

void OutputFiles::commit() {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < staged_.size(); ++i) {
    std::error_code error, ignored;
    fs::rename(staged_[i].file(), staged_[i].destination, error);
    if (!error) continue;
    for (std::size_t done = 0; done < i; ++done) fs::remove(staged_[done].destination, ignored);
    throw Error(ErrorCode::bad_file, staged_[i].destination.string() + ": cannot be written: " + error.message());
  }
}

void OutputFiles::discard() noexcept {
  const std::lock_guard lock(mutex_);
  discarded_ = true;
  for (const Staged& staged : staged_) remove_folder(staged.folder);
  staged_.clear();
}

}  // namespace isoatlas::tool
