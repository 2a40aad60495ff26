// SPDX-License-Identifier: Apache-2.0
#include "files/stored_data.h"

#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <vector>

#include "files/file_error.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

Error too_short(const fs::path& path, std::uint64_t promised, std::uint64_t stored) {
  return bad_file(path, "is cut off or damaged: the header promises " + std::to_string(promised) + " bytes of samples, the file has " +
                            std::to_string(stored));
}

}  // namespace

void require_stored_bytes(const fs::path& path, std::uint64_t promised, std::uint64_t stored) {
  if (stored < promised) {
    throw too_short(path, promised, stored);
  }
}

void require_possible_bytes(const fs::path& path, std::uint64_t promised, std::uint64_t stored, std::uint64_t most_per_stored_byte) {
  if (promised / most_per_stored_byte > stored) {
    throw bad_file(path, "the header promises " + std::to_string(promised) + " bytes of samples, far more than a file of " +
                             std::to_string(stored) + " bytes can hold");
  }
}

void require_inflated_bytes(const fs::path& path, std::uint64_t offset, std::uint64_t promised) {
  constexpr std::size_t kChunk = std::size_t{1} << 18;
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  std::vector<Bytef> packed(kChunk);
  std::vector<Bytef> unpacked(kChunk);

  z_stream stream{};
  constexpr int kAnyHeader = 15 + 32;  // zlib or gzip, whichever it is
  if (inflateInit2(&stream, kAnyHeader) != Z_OK) {
    throw Error(ErrorCode::out_of_memory, one_line(path.string() + ": not enough memory to decompress it"));
  }
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end_inflation(&stream, inflateEnd);

  std::uint64_t total = 0;
  bool is_between_members = true;  // a gzip file may be several, one after the other
  for (;;) {
    if (stream.avail_in == 0) {
      file.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
      stream.next_in = packed.data();
      stream.avail_in = static_cast<uInt>(file.gcount());
    }
    if (stream.avail_in == 0 || (is_between_members && total >= promised)) {
      break;
    }
    is_between_members = false;
    stream.next_out = unpacked.data();
    stream.avail_out = static_cast<uInt>(unpacked.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    total += unpacked.size() - stream.avail_out;
    if (result == Z_STREAM_END) {
      is_between_members = true;
      inflateReset(&stream);
    } else if (result != Z_OK) {
      throw bad_file(path,
                     "its compressed samples are damaged after " + std::to_string(total) + " of " + std::to_string(promised) + " bytes");
    }
  }
  if (!is_between_members || total < promised) {
    throw bad_file(path,
                   "is cut off: its compressed samples end after " + std::to_string(total) + " of " + std::to_string(promised) + " bytes");
  }
}

void require_stored_numbers(const fs::path& path, std::string_view text, std::uint64_t promised) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  std::uint64_t found = 0;
  std::size_t position = 0;
  while (found < promised) {
    position = text.find_first_not_of(kBlanks, position);
    if (position == std::string_view::npos || std::string_view("+-.0123456789nNiI").find(text[position]) == std::string_view::npos) {
      throw bad_file(path, "is cut off or damaged: the header promises " + std::to_string(promised) + " numbers, the file has " +
                               std::to_string(found));
    }
    ++found;
    position = std::min(text.find_first_of(kBlanks, position), text.size());
  }
}

void require_ending(const fs::path& path, std::string_view ending) {
  constexpr std::streamoff kTail = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  const std::streamoff length = std::min(size, kTail);
  std::string tail(static_cast<std::size_t>(std::max<std::streamoff>(length, 0)), '\0');
  file.seekg(size - length);
  file.read(tail.data(), length);
  const std::size_t last = tail.find_last_not_of(std::string_view(" \t\r\n\0", 5));
  if (last == std::string::npos || !std::string_view(tail).substr(0, last + 1).ends_with(ending)) {
    throw bad_file(path, "is cut off: it does not end with " + std::string(ending));
  }
}

void check_data_file(const fs::path& header_file, const fs::path& data_file, const std::function<void()>& check) {
  try {
    check();
  } catch (const Error& error) {
    if (data_file == header_file) {
      throw;
    }
    throw Error(error.code(), one_line(header_file.string() + ": its data file " + error.what(), 4096));
  }
}

std::string first_bytes(const fs::path& path, std::size_t limit) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file(gzopen(path.c_str(), "rb"), gzclose);  // plain files too
  if (!file) {
    throw bad_file(path, "cannot be opened");
  }
  std::string bytes(limit, '\0');
  const int count = gzread(file.get(), bytes.data(), static_cast<unsigned>(limit));
  bytes.resize(static_cast<std::size_t>(std::max(count, 0)));
  return bytes;
}

}  // namespace isoatlas::io
