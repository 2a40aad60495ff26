// SPDX-License-Identifier: Apache-2.0
// The bytes of a file from an offset on, decompressed on the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "files/decompressor.h"

namespace isoatlas::detail::io {

///< deflate: gzip or zlib, whichever the stream's header says

/// The packing that the file's first bytes state: gzip and bzip2 have marks of their own, anything
/// else is `none`.
Packing packing_of(const std::filesystem::path& path);

/// Reads one stream once, front to back. Checksums of compressed streams are checked.
class ByteSource {
 public:
  /// @param offset  of the stream in the file as it is on disk
  /// @throws Error(bad_file) if the file cannot be opened
  ByteSource(const std::filesystem::path& path, std::uint64_t offset, Packing packing);
  ~ByteSource();
  ByteSource(ByteSource&&) noexcept;

  /// Reads at most `bytes` bytes and returns how many; fewer only at the end of the stream.
  /// @throws Error(bad_file) if a compressed stream is damaged or cut off, or the disk cannot be
  /// read
  std::size_t read(void* to, std::size_t bytes);

  /// Skips exactly so many bytes. @throws Error(bad_file) if there are fewer
  void skip(std::uint64_t bytes);

  /// Reads exactly `bytes` bytes into `to`.
  /// @throws Error(bad_file) "is cut off ...: the header promises ... bytes of samples, the file
  /// has ..."
  void read_samples(void* to, std::uint64_t bytes);

  /// Reads on, at most to `limit` bytes or a little more, and returns how many bytes there were, at
  /// most `limit`. A compressed stream's checksum is at its end, so call this after the samples: it
  /// is checked unless more than `limit` bytes are left.
  std::uint64_t count_rest(std::uint64_t limit);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

/// Reverses the bytes of each of `count` values of `value_bytes` bytes, in place.
void swap_byte_order(void* values, std::uint64_t count, std::size_t value_bytes);

}  // namespace isoatlas::detail::io
