// SPDX-License-Identifier: Apache-2.0
// Reads samples in order from one file, stored as bytes or as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "files/byte_source.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::io {

enum class SampleEncoding {
  binary,       ///< as in memory, in either byte order
  text,         ///< decimal numbers between blanks or commas
  hexadecimal,  ///< two digits for each byte
};

/// The place of a run of samples.
struct SamplePiece {
  std::filesystem::path file = {};
  std::uint64_t offset = 0;         ///< in the file on disk
  Packing packing = Packing::none;  ///< of all bytes from `offset` on
  std::uint64_t skipped_bytes = 0;  ///< decompressed bytes before the samples
};

/// How a run of samples is written.
struct SampleFormat {
  SampleEncoding encoding = SampleEncoding::binary;
  SampleType type = SampleType::uint8;
};

/// Reads one piece once, from beginning to end. All functions throw Error(bad_file) if samples are
/// missing or damaged.
class PieceReader {
 public:
  virtual ~PieceReader() = default;

  /// Reads the next `samples` samples; binary and hexadecimal samples stay in the file's byte
  /// order.
  virtual void read(std::byte* to, std::uint64_t samples) = 0;

  /// Skips samples. Compressed samples and text are still checked, plain bytes are not read.
  virtual void skip(std::uint64_t samples) = 0;

  /// Counts the bytes after the samples, when all samples of the piece are read or skipped. Blanks
  /// are not counted in text; at most about 10^6 bytes are counted in a compressed piece. Verifies
  /// the checksum of a compressed piece.
  virtual std::uint64_t count_rest() = 0;
};

/// @param samples  number of samples of the piece
std::unique_ptr<PieceReader> open_piece(const SamplePiece& piece, const SampleFormat& format,
                                        std::uint64_t samples);

/// Call before memory is allocated. @throws Error(bad_file) if the file cannot hold so many samples
void require_possible_piece(const SamplePiece& piece, const SampleFormat& format,
                            std::uint64_t samples);

}  // namespace isoatlas::detail::io
