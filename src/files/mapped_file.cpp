// SPDX-License-Identifier: Apache-2.0
#include "files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <mutex>
#include <string>

#include "files/file_error.h"
#include "files/temporary_file.h"

namespace isoatlas::detail::io {
namespace {

// The mapped ranges of this process: only these may be dropped.
class MappedRanges {
 public:
  static MappedRanges& get() {
    static MappedRanges ranges;
    return ranges;
  }
  void add(const std::byte* begin, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    bytes_from_[begin] = bytes;
  }
  void remove(const std::byte* begin) {
    const std::lock_guard lock(mutex_);
    bytes_from_.erase(begin);
  }
  bool contains(const std::byte* begin, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto range = bytes_from_.upper_bound(begin);
    if (range == bytes_from_.begin()) return false;
    --range;
    return begin + bytes <= range->first + range->second;
  }

 private:
  std::mutex mutex_;
  std::map<const std::byte*, std::size_t> bytes_from_;
};

// The bytes from `first` on of a mapping, which ends with its last owner.
std::shared_ptr<std::byte[]> owned_mapping(std::byte* start, std::size_t length,
                                           std::size_t first) {
  MappedRanges::get().add(start, length);
  return {start + first, [start, length](std::byte*) {
            MappedRanges::get().remove(start);
            munmap(start, length);
          }};
}

}  // namespace

std::shared_ptr<std::byte[]> map_file(const std::filesystem::path& path, std::uint64_t offset,
                                      std::uint64_t bytes) {
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  const std::uint64_t begin = offset / page * page;
  const auto length = static_cast<std::size_t>(offset - begin + bytes);
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  void* const memory =
      file < 0 ? MAP_FAILED
               : mmap(nullptr, length, PROT_READ, MAP_PRIVATE, file, static_cast<off_t>(begin));
  const int error = errno;
  if (file >= 0) close(file);
  if (memory == MAP_FAILED)
    throw bad_file(path, "cannot be mapped into memory: " + system_text(error));
  return owned_mapping(static_cast<std::byte*>(memory), length,
                       static_cast<std::size_t>(offset - begin));
}

std::shared_ptr<std::byte[]> memory_in_temporary_file(std::uint64_t bytes) {
  const auto length = static_cast<std::size_t>(bytes);
  const int file = open_unnamed_file();
  int error = file < 0 ? errno : 0;
  // Not ftruncate(): if the disk became full later, this process would end.
  if (error == 0) error = posix_fallocate(file, 0, static_cast<off_t>(bytes));
  void* memory = MAP_FAILED;
  if (error == 0) {
    memory = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) error = errno;
  }
  if (file >= 0) close(file);
  if (error != 0)
    throw Error(ErrorCode::out_of_memory,
                one_line(temporary_folder().string() + ": a temporary file of " +
                         std::to_string(bytes) + " bytes for samples cannot be made: " +
                         system_text(error) + "; set TMPDIR to a folder with enough space"));
  return owned_mapping(static_cast<std::byte*>(memory), length, 0);
}

void drop_mapped_pages(const void* bytes, std::size_t count) {
  const auto* const begin = static_cast<const std::byte*>(bytes);
  if (!MappedRanges::get().contains(begin, count)) return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGE_SIZE));
  const auto first = reinterpret_cast<std::uintptr_t>(begin) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(begin) + count;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

}  // namespace isoatlas::detail::io
