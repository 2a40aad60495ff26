// SPDX-License-Identifier: Apache-2.0
#include "files/file_text.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

FileText::FileText(const std::filesystem::path& path, std::uint64_t begin, std::uint64_t end)
    : path_(path), file_(nullptr, std::fclose), end_(end), buffer_(kBufferBytes) {
  errno = 0;
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) {
    throw bad_file(path, "cannot be opened: " + system_text(errno));
  }
  seek(begin);
}

void FileText::seek(std::uint64_t position) {
  errno = 0;
  if (fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET) != 0) {
    throw bad_file(path_, "cannot be read: " + system_text(errno));
  }
  buffer_position_ = position;
  first_ = last_ = 0;
}

// Reads more bytes after the unread ones; false at the end of the file.
bool FileText::fill() {
  std::memmove(buffer_.data(), buffer_.data() + first_, last_ - first_);
  buffer_position_ += first_;
  last_ -= first_;
  first_ = 0;
  const std::uint64_t read_position = buffer_position_ + last_;
  const std::uint64_t left = end_ > read_position ? end_ - read_position : 0;
  const std::size_t wanted =
      static_cast<std::size_t>(std::min<std::uint64_t>(buffer_.size() - last_, left));
  errno = 0;
  const std::size_t count = std::fread(buffer_.data() + last_, 1, wanted, file_.get());
  if (count < wanted && std::ferror(file_.get()) != 0) {
    throw bad_file(path_, "cannot be read: " + system_text(errno));
  }
  last_ += count;
  return count > 0;
}

std::string_view FileText::word() {
  do {
    while (first_ < last_ && is_blank(buffer_[first_])) {
      ++first_;
    }
  } while (first_ == last_ && fill());
  std::size_t length = 0;
  for (;;) {
    while (first_ + length < last_ && length < kLongestWord &&
           !is_blank(buffer_[first_ + length])) {
      ++length;
    }
    if (first_ + length < last_ || length == kLongestWord || !fill()) {
      break;
    }
  }
  const std::string_view word(buffer_.data() + first_, length);
  first_ += length;
  return word;
}

std::string FileText::line() {
  std::string line;
  while (first_ < last_ || fill()) {
    const char c = buffer_[first_++];
    if (c == '\n') {
      break;
    }
    if (line.size() < kLongestWord) {
      line += c;
    }
  }
  if (line.ends_with('\r')) {
    line.pop_back();
  }
  return line;
}

}  // namespace isoatlas::detail::io
