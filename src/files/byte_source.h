// SPDX-License-Identifier: Apache-2.0
// The bytes of a file from an offset on, decompressed if needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "files/decompressor.h"

namespace isoatlas::detail::io {

/// The compression that the first bytes of the file state: gzip and bzip2 begin with fixed bytes,
/// all other files are `none`.
Packing packing_of(const std::filesystem::path& path);

/// Reads one stream once, from beginning to end. Verifies the checksums of compressed streams.
class ByteSource {
 public:
  /// @param offset  of the stream in the file on disk, in bytes
  /// @throws Error(bad_file) if the file cannot be opened
  ByteSource(const std::filesystem::path& path, std::uint64_t offset, Packing packing);
  ~ByteSource();
  ByteSource(ByteSource&&) noexcept;

  /// Reads at most `bytes` bytes and returns the number read, which is smaller only at the end of
  /// the stream.
  /// @throws Error(bad_file) if a compressed stream is damaged or cut off, or the disk cannot be
  /// read
  std::size_t read(void* to, std::size_t bytes);

  /// Skips exactly `bytes` bytes. @throws Error(bad_file) if the stream is shorter
  void skip(std::uint64_t bytes);

  /// Reads exactly `bytes` bytes into `to`.
  /// @throws Error(bad_file) "is cut off ...: the header states ... bytes of samples, the file has
  /// ..."
  void read_samples(void* to, std::uint64_t bytes);

  /// Reads and counts the remaining bytes, up to about `limit` of them; returns at most `limit`.
  /// The checksum of a compressed stream is at its end, so call this after reading the samples: it
  /// is verified unless more than `limit` bytes remain.
  std::uint64_t count_rest(std::uint64_t limit);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

/// Reverses the byte order of each of `count` values of `value_bytes` bytes, in place.
void swap_byte_order(void* values, std::uint64_t count, std::size_t value_bytes);

}  // namespace isoatlas::detail::io
