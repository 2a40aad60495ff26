// SPDX-License-Identifier: Apache-2.0
// Reads the attributes of a DICOM file and locates its pixel data; nothing is decoded here.
//
// No library's parser is used. GDCM's parser allocates any length that a file states and reads a
// file that ends within an attribute without an error. Its asserts, which Debian keeps, end the
// process if a file is damaged.
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

/// Random access to the bytes of a file, or to decompressed bytes in memory. Lengths are checked
/// before anything is allocated.
class DicomBytes {
 public:
  explicit DicomBytes(const std::filesystem::path& path);
  explicit DicomBytes(std::string bytes);

  std::uint64_t size() const { return size_; }
  /// Bytes [offset, offset + count), all of which must exist; valid until the next call.
  std::string_view at(std::uint64_t offset, std::size_t count);
  /// Copies bytes into the caller's memory. @throws Error(bad_file) if the file has shrunk or
  /// cannot be read
  void read(std::uint64_t offset, void* to, std::uint64_t count);

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::ifstream> file_;  // null if all bytes are in window_
  std::string window_;
  std::uint64_t window_start_ = 0;
  std::uint64_t size_ = 0;
};

struct DicomPixels {
  DicomTag tag = 0;          ///< kPixelData, kFloatPixelData or kDoublePixelData
  bool is_words = false;     ///< stored as 16-bit words; affects the byte order of big-endian files
  std::uint64_t offset = 0;  ///< of the samples, if they are not compressed
  std::uint64_t bytes = 0;
  struct Fragment {
    std::uint64_t offset = 0, bytes = 0;
  };
  bool is_compressed = false;
  std::vector<Fragment> fragments;  ///< of compressed frames
  std::vector<std::uint32_t>
      frame_offsets;  ///< the basic offset table: offsets from the first fragment's item
};

/// One parsed file.
struct DicomContents {
  DicomDataSet attributes;
  std::string transfer_syntax;
  bool is_big_endian = false;  ///< byte order of the samples
  std::optional<DicomPixels> pixels;
  bool is_cut_off =
      false;  ///< data elements extend beyond the end of the file; those before are complete
  std::uint64_t bytes = 0;  ///< size of the file
};

/// True if the file has "DICM" after a preamble.
bool has_dicom_mark(const std::filesystem::path& path);

/// True if the file looks like DICOM: it has "DICM" after a preamble, or begins with a data set.
bool looks_like_dicom(const std::filesystem::path& path);

/// The bytes that offsets in DicomPixels refer to: those of the file, or of its decompressed data
/// set if that is deflated.
/// @throws Error(out_of_memory) if the data set is deflated and larger than `max_memory`
DicomBytes open_dicom(const std::filesystem::path& path, std::uint64_t max_memory);

/// Parses a file that looks like DICOM. @throws Error(bad_file) if its data elements are invalid
DicomContents read_dicom_contents(const std::filesystem::path& path, std::uint64_t max_memory);

}  // namespace isoatlas::detail::io
