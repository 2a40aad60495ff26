// SPDX-License-Identifier: Apache-2.0
// The attributes of a DICOM file, and where its pixel data is. Nothing is decoded here.
//
// No library's parser is used: GDCM's allocates whatever length a file states, reads a file that
// ends in the middle of an attribute without complaint, and its asserts, which Debian leaves in,
// end the process where a file is damaged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volume_files/dicom_data_set.h"

namespace isoatlas::detail::io {

/// Random access to the bytes of a file, or to decompressed ones in memory. Lengths are checked
/// before anything is allocated.
class DicomBytes {
 public:
  explicit DicomBytes(const std::filesystem::path& path);
  explicit DicomBytes(std::string bytes);

  std::uint64_t size() const { return size_; }
  /// Bytes [offset, offset + count), all of which there are; valid until the next call.
  std::string_view at(std::uint64_t offset, std::size_t count);
  /// The same into memory of the caller. @throws Error(bad_file) if the file has shrunk or cannot
  /// be read
  void read(std::uint64_t offset, void* to, std::uint64_t count);

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::ifstream> file_;  // null: all bytes are in window_
  std::string window_;
  std::uint64_t window_start_ = 0;
  std::uint64_t size_ = 0;
};

struct DicomPixels {
  DicomTag tag = 0;          ///< kPixelData, kFloatPixelData or kDoublePixelData
  bool is_words = false;     ///< stored as 16-bit words, which matters where the file is big-endian
  std::uint64_t offset = 0;  ///< of the samples, where they are not compressed
  std::uint64_t bytes = 0;
  struct Fragment {
    std::uint64_t offset = 0, bytes = 0;
  };
  bool is_compressed = false;
  std::vector<Fragment> fragments;  ///< of compressed frames
  std::vector<std::uint32_t>
      frame_offsets;  ///< the basic offset table: counted from the first fragment's item
};

/// One parsed file.
struct DicomContents {
  DicomDataSet attributes;
  std::string transfer_syntax;
  bool is_big_endian = false;  ///< the samples
  std::optional<DicomPixels> pixels;
  bool is_cut_off = false;  ///< data elements reach beyond the file's end; what was before is there
  std::uint64_t bytes = 0;  ///< of the file
};

/// Does the file have the mark "DICM" after a preamble?
bool has_dicom_mark(const std::filesystem::path& path);

/// Does the file look like DICOM: the mark "DICM" after a preamble, or a data set that starts at
/// once?
bool looks_like_dicom(const std::filesystem::path& path);

/// The bytes that offsets in DicomPixels refer to: the file's, or those that its deflated data set
/// has in memory.
/// @throws Error(out_of_memory) if the data set is deflated and larger than `max_memory`
DicomBytes open_dicom(const std::filesystem::path& path, std::uint64_t max_memory);

/// Parses a file that looks like DICOM. @throws Error(bad_file) if its data elements make no sense
DicomContents read_dicom_contents(const std::filesystem::path& path, std::uint64_t max_memory);

}  // namespace isoatlas::detail::io
