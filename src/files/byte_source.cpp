// SPDX-License-Identifier: Apache-2.0
#include "files/byte_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 18;  // bytes read from the file at once

}  // namespace

struct ByteSource::Stream {
  fs::path path;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{nullptr, std::fclose};
  std::unique_ptr<Decompressor> decompressor;
  std::vector<char> packed;
  std::size_t begin = 0, end = 0;  // range of the unread compressed bytes
  bool is_bzip2 = false;
  bool between_members = true, is_first_member = true;
  std::uint64_t total = 0;  // bytes returned so far

  std::size_t read_file(char* to, std::size_t bytes) {
    errno = 0;
    const std::size_t count = std::fread(to, 1, bytes, file.get());
    if (count < bytes && std::ferror(file.get()) != 0) {
      throw bad_file(path, "cannot be read: " + system_text(errno));
    }
    return count;
  }

  std::size_t read_unpacked(char* to, std::size_t bytes) {
    std::size_t produced = 0;
    while (produced < bytes) {
      if (begin == end) {
        begin = 0;
        end = read_file(packed.data(), packed.size());
      }
      if (end == 0) {
        if (!between_members) {
          throw bad_file(path, "is cut off: its compressed samples end too early, after " +
                                   std::to_string(total + produced) + " decompressed bytes");
        }
        break;
      }
      // Bytes after the last member need not be another member: some writers pad with zeros.
      if (between_members && !is_first_member && !starts_member()) {
        break;
      }
      if (between_members && !is_first_member) {
        decompressor->start_next_member();
      }
      between_members = is_first_member = false;
      try {
        const std::size_t room =
            std::min<std::size_t>(bytes - produced, std::numeric_limits<int>::max());
        const auto step =
            decompressor->step(packed.data() + begin, end - begin, to + produced, room);
        if (step.consumed == 0 && step.produced == 0 && !step.at_end) {
          throw "stuck";
        }
        begin += step.consumed;
        produced += step.produced;
        between_members = step.at_end;
      } catch (const char*) {
        throw bad_file(path, "its compressed samples are damaged after " +
                                 std::to_string(total + produced) + " bytes");
      }
    }
    return produced;
  }

  // True if another member begins at the read position. Only gzip and bzip2 have members. Reads
  // more of the file if the buffer holds too little to decide.
  bool starts_member() {
    constexpr std::size_t kMark = 3;
    if (end - begin < kMark) {
      std::copy(packed.begin() + static_cast<std::ptrdiff_t>(begin),
                packed.begin() + static_cast<std::ptrdiff_t>(end), packed.begin());
      end -= std::exchange(begin, 0);
      end += read_file(packed.data() + end, packed.size() - end);
    }
    const std::string_view next(packed.data() + begin, end - begin);
    return next.starts_with(is_bzip2 ? "BZh" : "\x1F\x8B");
  }
};

Packing packing_of(const fs::path& path) {
  std::array<char, 3> mark{};
  std::ifstream(path, std::ios::binary).read(mark.data(), mark.size());
  if (mark[0] == '\x1F' && mark[1] == '\x8B') return Packing::deflate;
  if (mark[0] == 'B' && mark[1] == 'Z' && mark[2] == 'h') return Packing::bzip2;
  return Packing::none;
}

ByteSource::ByteSource(const fs::path& path, std::uint64_t offset, Packing packing)
    : stream_(std::make_unique<Stream>()) {
  stream_->path = path;
  errno = 0;
  stream_->file.reset(std::fopen(path.c_str(), "rb"));
  if (!stream_->file || fseeko(stream_->file.get(), static_cast<off_t>(offset), SEEK_SET) != 0) {
    throw bad_file(path, "cannot be opened: " + system_text(errno));
  }
  stream_->decompressor = decompressor_for(packing);
  stream_->is_bzip2 = packing == Packing::bzip2;
  if (stream_->decompressor) {
    stream_->packed.resize(kChunk);
  }
}

ByteSource::~ByteSource() = default;
ByteSource::ByteSource(ByteSource&&) noexcept = default;

std::size_t ByteSource::read(void* to, std::size_t bytes) {
  char* const chars = static_cast<char*>(to);
  const std::size_t count = stream_->decompressor ? stream_->read_unpacked(chars, bytes)
                                                  : stream_->read_file(chars, bytes);
  stream_->total += count;
  return count;
}

void ByteSource::skip(std::uint64_t bytes) {
  std::vector<char> buffer(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, kChunk)));
  for (std::uint64_t left = bytes; left > 0;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, buffer.size()));
    const std::size_t count = read(buffer.data(), wanted);
    if (count < wanted) {
      throw bad_file(stream_->path, "is cut off: it ends " + std::to_string(left - count) +
                                        " bytes before its samples begin");
    }
    left -= count;
  }
}

void ByteSource::read_samples(void* to, std::uint64_t bytes) {
  require_stored_bytes(stream_->path, bytes, read(to, static_cast<std::size_t>(bytes)));
}

std::uint64_t ByteSource::count_rest(std::uint64_t limit) {
  std::vector<char> buffer(static_cast<std::size_t>(std::clamp<std::uint64_t>(limit, 1, kChunk)));
  std::uint64_t count = 0;
  for (;;) {
    const std::size_t found = read(buffer.data(), buffer.size());
    count += found;
    if (found < buffer.size() || count > limit) {
      return std::min(count, limit);
    }
  }
}

void swap_byte_order(void* values, std::uint64_t count, std::size_t value_bytes) {
  char* value = static_cast<char*>(values);
  for (std::uint64_t i = 0; i < count; ++i, value += value_bytes) {
    std::reverse(value, value + value_bytes);
  }
}

}  // namespace isoatlas::detail::io
