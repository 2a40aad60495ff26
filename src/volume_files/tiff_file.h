// SPDX-License-Identifier: Apache-2.0
// A TIFF file as a list of pages, by libtiff.
#pragma once

#include <tiffio.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "files/library_messages.h"
#include "isoatlas/error.h"
#include "isoatlas/volume_file.h"
#include "volume_files/tiff_directories.h"

namespace isoatlas::detail::io {

/// How a page's samples are stored. All pages of a volume have the same format.
struct PageFormat {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1;               ///< bits of one value
  std::uint16_t sample_format = 0;      ///< SAMPLEFORMAT_...
  std::uint16_t values_per_sample = 1;  ///< 3 in a page of red, green and blue
  std::uint16_t photometric = 0;        ///< PHOTOMETRIC_...

  SampleType type() const;  ///< type of the values in memory
  bool has_same_samples(const PageFormat& other)
      const;  ///< true if pages of both formats can be slices of one volume
  std::uint64_t stored_bytes() const;  ///< bytes of all values of a page before compression
};

/// E.g. "24 x 20 samples of uint8", with the number of values per sample if there are several.
std::string to_string(const PageFormat& format);

/// An open file with a current page. Only one can exist per thread: libtiff's messages are global,
/// so the object holds the library lock.
class TiffFile {
 public:
  /// Follows the chain of directories to its end.
  /// @throws Error(bad_file) if it is not a TIFF file, or its chain leaves the file or loops
  explicit TiffFile(const std::filesystem::path& path);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::size_t page_count() const { return directories_.size(); }
  std::uint64_t file_size() const { return file_size_; }

  /// Makes `page` the current page. @throws Error(bad_file) if its directory is damaged
  void select(std::size_t page);

  // The following functions concern the current page.
  /// @throws Error(unsupported) for colours or sample types that cannot be read
  PageFormat format() const;
  std::string description() const;  ///< empty if it is missing
  bool is_preview() const;          ///< true for a reduced copy or a mask of another page
  bool has_tag(std::uint32_t tag) const;
  std::string bytes_of_tag(std::uint32_t tag)
      const;  ///< of a tag of bytes that libtiff does not know; empty if it is missing
  bool is_big_endian() const { return TIFFIsBigEndian(tiff_.get()) != 0; }
  std::uint16_t orientation() const;  ///< ORIENTATION_...
  double samples_per_length(
      std::uint32_t tag) const;           ///< TIFFTAG_XRESOLUTION or Y; 0 if not stated
  std::uint16_t resolution_unit() const;  ///< RESUNIT_...

  bool packs_without_bound()
      const;  ///< true if a few compressed bytes can hold any number of equal samples

  /// The names of the values of a sample: "red", "green", "blue", "alpha"; a number for a value
  /// without a name.
  std::vector<std::string> value_names() const;

  /// The offset of the page's samples if all of them are stored uncompressed in one piece;
  /// otherwise 0.
  std::uint64_t offset_of_plain_samples() const;

  /// Reads value `value` of every sample of the current page to `samples`, which has room for width
  /// x height of the type.
  /// @throws Error(bad_file)      if they cannot all be decoded
  /// @throws Error(out_of_memory) if a strip or tile is larger than the limit
  void read_samples(const PageFormat& format, std::size_t value, const ReadOptions& options,
                    std::byte* samples);

  /// "<path>: is cut off or damaged in page 3: <message of libtiff>"
  Error damaged(std::size_t page) const;

  std::string library_version() const;  ///< "libtiff 4.5.0"

 private:
  class Messages;
  void read_strips(const PageFormat& format, std::size_t value, const ReadOptions& options,
                   std::byte* samples);
  void read_tiles(const PageFormat& format, std::size_t value, const ReadOptions& options,
                  std::byte* samples);
  void require_stored(std::uint32_t strip_or_tile) const;
  bool are_values_separate() const;

  LibraryMessages library_messages_;
  std::filesystem::path path_;
  std::uint64_t file_size_ = 0;
  std::vector<TiffDirectory> directories_;  // one per page
  std::unique_ptr<Messages> messages_;
  std::unique_ptr<TIFF, void (*)(TIFF*)> tiff_;
  std::size_t page_ = 0;
};

/// Extracts value `value` of `count` samples that are stored in sequence from `stored` on, with
/// `values` values each.
void unpack_values(const PageFormat& format, std::size_t values, std::size_t value,
                   const std::byte* stored, std::size_t count, std::byte* samples);

/// The number of bytes for `count` values of `bits` bits, rounded up to whole bytes.
inline std::uint64_t packed_bytes(std::uint64_t count, std::uint64_t bits) {
  return (count * bits + 7) / 8;
}

}  // namespace isoatlas::detail::io
