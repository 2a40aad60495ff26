// SPDX-License-Identifier: Apache-2.0
#include "volume_files/tiff_directories.h"

#include <array>
#include <fstream>
#include <string>
#include <unordered_set>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

/// Reads the numbers of the file's structure, which have 2, 4 or 8 bytes in the file's byte order.
class StructureReader {
 public:
  StructureReader(const fs::path& path, std::uint64_t file_size)
      : path_(path), file_size_(file_size) {
    file_.rdbuf()->pubsetbuf(nullptr, 0);  // window_ is the buffer
    file_.open(path, std::ios::binary);
    fill_window(0);
    const std::array<unsigned char, 4> mark{window_[0], window_[1], window_[2], window_[3]};
    is_big_endian_ = mark[0] == 'M';
    const unsigned char version = is_big_endian_ ? mark[3] : mark[2];
    if (window_bytes_ < mark.size() || mark[0] != mark[1] || (mark[0] != 'I' && mark[0] != 'M') ||
        (version != 42 && version != 43)) {
      throw bad_file(path,
                     "is not a TIFF file: it does not begin with II or MM and a TIFF version");
    }
    is_big_tiff_ = version == 43;
  }

  bool is_big_tiff() const { return is_big_tiff_; }
  bool has(std::uint64_t offset, std::uint64_t bytes) const {
    return offset <= file_size_ && bytes <= file_size_ - offset;
  }

  std::uint64_t number_at(std::uint64_t offset, std::size_t bytes) {
    if (offset < window_start_ || offset + bytes > window_start_ + window_bytes_) {
      fill_window(offset);
    }
    if (window_bytes_ < bytes) {
      throw bad_file(path_, "is cut off: it ends before its directory of pages");
    }
    const unsigned char* const digits = window_.data() + (offset - window_start_);
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      number = number << 8 | digits[is_big_endian_ ? i : bytes - 1 - i];
    }
    return number;
  }

 private:
  void fill_window(std::uint64_t offset) {
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(reinterpret_cast<char*>(window_.data()), window_.size());
    window_start_ = offset;
    window_bytes_ = static_cast<std::size_t>(file_.gcount());
  }

  fs::path path_;
  std::ifstream file_;
  std::uint64_t file_size_;
  std::array<unsigned char, 512> window_{};  // most directories fit
  std::uint64_t window_start_ = 0;
  std::size_t window_bytes_ = 0;
  bool is_big_endian_ = false, is_big_tiff_ = false;
};

/// The predictor that the directory states; 1 if it states none. Entries are sorted by tag.
std::uint32_t predictor_of(StructureReader& file, std::uint64_t first_entry,
                           std::uint64_t entries) {
  constexpr std::uint64_t kPredictor = 317, kShort = 3;
  const std::uint64_t entry_bytes = file.is_big_tiff() ? 20 : 12,
                      value_offset = file.is_big_tiff() ? 12 : 8;
  for (std::uint64_t i = 0; i < entries; ++i) {
    const std::uint64_t entry = first_entry + i * entry_bytes;
    const std::uint64_t tag = file.number_at(entry, 2);
    if (tag == kPredictor) {
      const bool is_short = file.number_at(entry + 2, 2) == kShort;
      return static_cast<std::uint32_t>(file.number_at(entry + value_offset, is_short ? 2 : 4));
    }
    if (tag > kPredictor) {
      break;
    }
  }
  return 1;
}

}  // namespace

std::vector<TiffDirectory> tiff_directories(const fs::path& path, std::uint64_t file_size) {
  StructureReader file(path, file_size);
  const std::size_t offset_bytes = file.is_big_tiff() ? 8 : 4;
  const std::size_t count_bytes = file.is_big_tiff() ? 8 : 2;
  const std::uint64_t entry_bytes = file.is_big_tiff() ? 20 : 12;
  std::vector<TiffDirectory> directories;
  std::unordered_set<std::uint64_t> seen;
  std::uint64_t offset = file.number_at(offset_bytes, offset_bytes);
  while (offset != 0 || directories.empty()) {
    const std::string page = "page " + std::to_string(directories.size() + 1);
    if (!seen.insert(offset).second) {
      throw bad_file(path, "is damaged: its pages form a loop: after page " +
                               std::to_string(directories.size()) + " an earlier page follows");
    }
    const Error cut_off = bad_file(
        path, "is cut off or damaged in " + page + ": its directory is not completely in the file");
    if (offset == 0 || !file.has(offset, count_bytes)) {
      throw cut_off;
    }
    const std::uint64_t entries = file.number_at(offset, count_bytes);
    const std::uint64_t link = offset + count_bytes + entries * entry_bytes;
    if (entries > file_size / entry_bytes || !file.has(link, offset_bytes)) {
      throw cut_off;
    }
    directories.push_back({offset, predictor_of(file, offset + count_bytes, entries)});
    offset = file.number_at(link, offset_bytes);
  }
  return directories;
}

}  // namespace isoatlas::detail::io
