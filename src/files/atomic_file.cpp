// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// Creates a new file in the folder of `target`. Its name is short, so it fits where the target's
// name fits.
fs::path create_beside(const fs::path& target, const fs::path& destination) {
  static std::atomic<unsigned> counter{0};
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (;;) {
    fs::path name = folder / (".isoatlas." + std::to_string(::getpid()) + "." +
                              std::to_string(counter++) + ".part");
    const int descriptor = ::open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      ::close(descriptor);
      return name;
    }
    if (errno == ENOENT || errno == ENOTDIR) {
      throw bad_file(destination, "cannot be written: there is no folder " + folder.string());
    }
    if (errno != EEXIST) {
      throw bad_file(destination, "cannot be written: " + system_text(errno) + " (folder " +
                                      folder.string() + ")");
    }
  }
}

// Flushes data and length to disk before the rename, so that after a power cut either the old or
// the new file is there.
bool flush_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return false;
  }
  const bool flushed =
      ::fsync(descriptor) == 0 || errno == EINVAL;  // EINVAL: the file system has no fsync
  const int error = errno;
  ::close(descriptor);
  errno = error;
  return flushed;
}

// The system's reason for a failed write. A stream does not keep it, so this writes once more to
// the file, which is discarded anyway.
std::string reason_of_failed_write(const fs::path& path) {
  constexpr std::size_t kBytes = 65536;
  const std::string zeros(kBytes, '\0');
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) {
    return system_text(errno);
  }
  errno = 0;
  ssize_t count = ::write(descriptor, zeros.data(), kBytes);
  if (count > 0 && count < static_cast<ssize_t>(kBytes)) {  // the remaining space is used up
    count = ::write(descriptor, zeros.data(), kBytes);
  }
  const int error = count < 0 ? errno : 0;
  ::close(descriptor);
  return error != 0 ? system_text(error) : "a write failed";
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& destination)
    : destination_(destination), target_(destination) {
  std::error_code error;
  const fs::file_status status = fs::status(destination, error);
  if (fs::is_directory(status)) {
    throw bad_file(destination, "cannot be written: it is a folder");
  }
  if (!destination.has_filename()) {
    throw bad_file(destination, "cannot be written: the file name is missing");
  }
  bool write_in_place = false;
  if (fs::exists(status)) {
    if (::access(destination.c_str(), W_OK) != 0) {
      throw bad_file(destination, "cannot be written: " + system_text(errno));
    }
    write_in_place = !fs::is_regular_file(status);
    if (!write_in_place && fs::is_symlink(fs::symlink_status(destination, error))) {
      target_ = fs::canonical(destination, error);
      if (error) {
        throw bad_file(destination, "cannot be written: " + error.message());
      }
    }
  }
  written_path_ = write_in_place ? target_ : create_beside(target_, destination_);
  errno = 0;
  stream_.open(written_path_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const int open_error = errno;
    if (is_temporary()) {
      fs::remove(written_path_, error);
    }
    throw bad_file(destination, "cannot be written: " + system_text(open_error));
  }
}

AtomicFile::~AtomicFile() {
  if (!committed_ && is_temporary()) {
    stream_.close();
    std::error_code ignored;
    fs::remove(written_path_, ignored);
  }
}

void AtomicFile::flush() {
  stream_.flush();
  if (!stream_.good()) {
    throw bad_file(destination_, "cannot be written: " + reason_of_failed_write(written_path_));
  }
}

void AtomicFile::commit() {
  stream_.close();  // flushes; sets failbit if this or an earlier write failed
  if (!stream_.good()) {
    throw bad_file(destination_, "cannot be written: " + reason_of_failed_write(written_path_));
  }
  if (is_temporary() && !flush_to_disk(written_path_)) {
    throw bad_file(destination_, "cannot be written: " + system_text(errno));
  }
  if (is_temporary()) {
    std::error_code error;
    fs::rename(written_path_, target_, error);
    if (error) {
      throw bad_file(destination_, "cannot be written: " + error.message());
    }
  }
  committed_ = true;
}

}  // namespace isoatlas::detail::io
