// SPDX-License-Identifier: Apache-2.0
#include "files/stored_data.h"

#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

Error too_short(const fs::path& path, std::uint64_t stated, std::uint64_t stored) {
  return bad_file(path, "is cut off or damaged: the header states " + std::to_string(stated) +
                            " bytes of samples, the file has " + std::to_string(stored));
}

}  // namespace

void require_stored_bytes(const fs::path& path, std::uint64_t stated, std::uint64_t stored) {
  if (stored < stated) {
    throw too_short(path, stated, stored);
  }
}

void require_possible_bytes(const fs::path& path, std::uint64_t stated, std::uint64_t stored,
                            std::uint64_t most_per_stored_byte) {
  if (stated / most_per_stored_byte > stored) {
    throw bad_file(path, "the header states " + std::to_string(stated) +
                             " bytes of samples, far more than a file of " +
                             std::to_string(stored) + " bytes can hold");
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

void check_data_file(const fs::path& header_file, const fs::path& data_file,
                     const std::function<void()>& check) {
  try {
    check();
  } catch (const Error& error) {
    if (data_file == header_file) {
      throw;
    }
    throw Error(error.code(),
                one_line(header_file.string() + ": its data file " + error.what(), 4096));
  }
}

std::string first_bytes(const fs::path& path, std::size_t limit) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file(
      gzopen(path.c_str(), "rb"),
      gzclose);  // also reads files that are not compressed
  if (!file) {
    throw bad_file(path, "cannot be opened");
  }
  std::string bytes(limit, '\0');
  const int count = gzread(file.get(), bytes.data(), static_cast<unsigned>(limit));
  bytes.resize(static_cast<std::size_t>(std::max(count, 0)));
  return bytes;
}

}  // namespace isoatlas::detail::io
