// SPDX-License-Identifier: Apache-2.0
// Samples one after the other in one file, as bytes or as text.
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

/// Where a run of samples is.
struct SamplePiece {
  std::filesystem::path file = {};
  std::uint64_t offset = 0;         ///< in the file as it is on disk
  Packing packing = Packing::none;  ///< of everything from `offset` on
  std::uint64_t skipped_bytes = 0;  ///< unpacked bytes before the samples
};

/// How a run of samples is written.
struct SampleFormat {
  SampleEncoding encoding = SampleEncoding::binary;
  SampleType type = SampleType::uint8;
};

/// Reads one piece once, front to back. All throw Error(bad_file) if samples are missing or
/// damaged.
class PieceReader {
 public:
  virtual ~PieceReader() = default;

  /// The next `samples` samples; binary and hexadecimal ones in the file's byte order.
  virtual void read(std::byte* to, std::uint64_t samples) = 0;

  /// Samples that nobody wants. Packed ones and text are looked at nevertheless, plain bytes are
  /// not.
  virtual void skip(std::uint64_t samples) = 0;

  /// Bytes after the samples, those of the piece all read or skipped: blanks aside if they are
  /// text, and at most some 10^6 if they are packed. Checks the checksum of a packed piece.
  virtual std::uint64_t count_rest() = 0;
};

/// @param samples  how many the piece has
std::unique_ptr<PieceReader> open_piece(const SamplePiece& piece, const SampleFormat& format,
                                        std::uint64_t samples);

/// Call before memory is allocated. @throws Error(bad_file) if the file cannot hold so many samples
void require_possible_piece(const SamplePiece& piece, const SampleFormat& format,
                            std::uint64_t samples);

}  // namespace isoatlas::detail::io
