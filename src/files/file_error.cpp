// SPDX-License-Identifier: Apache-2.0
#include "files/file_error.h"

#include <cerrno>
#include <fstream>
#include <new>
#include <system_error>

namespace isoatlas::detail::io {

std::string one_line(std::string_view text, std::size_t limit) {
  std::string line;
  bool blank_pending = false;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= ' ' || byte == 127) {
      blank_pending = !line.empty();
      continue;
    }
    if (blank_pending) {
      line += ' ';
    }
    blank_pending = false;
    line += c;
  }
  if (line.size() > limit) {
    line.resize(limit);
    while (!line.empty() && (static_cast<unsigned char>(line.back()) & 0x80U) != 0) {
      line.pop_back();  // never cut within a UTF-8 character
    }
    line += "...";
  }
  return line;
}

namespace {

constexpr std::size_t kMessageLimit =
    2000;  // enough for any path, and limits the text quoted from a file

Error file_error(ErrorCode code, const std::filesystem::path& path, std::string_view what) {
  return Error(code, one_line(path.string() + ": " + std::string(what), kMessageLimit));
}

}  // namespace

Error bad_file(const std::filesystem::path& path, std::string_view what) {
  return file_error(ErrorCode::bad_file, path, what);
}

Error unsupported(const std::filesystem::path& path, std::string_view what) {
  return file_error(ErrorCode::unsupported, path, what);
}

Error out_of_memory(const std::filesystem::path& path, std::uint64_t bytes) {
  return file_error(ErrorCode::out_of_memory, path,
                    "not enough memory for its " + std::to_string(bytes) + " bytes");
}

std::string system_text(int error) { return std::generic_category().message(error); }

std::uint64_t readable_file_size(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw bad_file(path, "no such file");
  }
  if (error) {
    throw bad_file(path, "cannot be opened: " + error.message());
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw bad_file(path, std::filesystem::is_directory(status)
                             ? "is a folder, expected a file"
                             : "is not a regular file, expected one");
  }
  errno = 0;
  if (!std::ifstream(path, std::ios::binary)) {
    throw bad_file(path, "cannot be opened: " + system_text(errno));
  }
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) {
    throw bad_file(path, "cannot be opened: " + error.message());
  }
  if (size == 0) {
    throw bad_file(path, "is empty");
  }
  return size;
}

std::string file_contents(const std::filesystem::path& path) {
  const std::uint64_t size = readable_file_size(path);
  try {
    std::string contents(size, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(contents.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uint64_t>(stream.gcount()) != size) {
      throw bad_file(path, "cannot be read to its end");
    }
    return contents;
  } catch (const std::bad_alloc&) {
    throw out_of_memory(path, size);
  } catch (const std::length_error&) {
    throw out_of_memory(path, size);
  }
}

}  // namespace isoatlas::detail::io
