// SPDX-License-Identifier: Apache-2.0
// Decodes one compressed frame of grey values into memory, with one library per compression. Each
// function returns true if the frame was decoded to its end. Before the call, compare the stream's
// header with `frame`. Call them while a LibraryMessages object exists.
//
// GDCM decodes all of these, but its asserts, which Debian keeps, end the process if a stream is
// damaged.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoatlas::detail::io {

struct FrameSize {
  std::size_t columns = 0, rows = 0;
  unsigned bits = 0;  ///< per sample, 2 to 32, as the stream states
  bool is_signed = false;

  std::size_t sample_bytes() const { return bits <= 8 ? 1 : bits <= 16 ? 2 : 4; }
  std::size_t bytes() const { return columns * rows * sample_bytes(); }
};

/// JPEG with 8 or 12 bits, lossless JPEG with 2 to 16 bits, by DCMTK.
bool decode_jpeg(const std::string& stream, const FrameSize& frame, char* to);
/// JPEG-LS, by CharLS.
bool decode_jpeg_ls(const std::string& stream, const FrameSize& frame, char* to);
/// A JPEG 2000 codestream without a file format around it, by OpenJPEG.
bool decode_jpeg_2000(const std::string& stream, const FrameSize& frame, char* to);
/// Run length encoding as DICOM defines it.
bool decode_run_lengths(std::string_view stream, const FrameSize& frame, char* to);

// The library and its version, e.g. "DCMTK 3.6.7".
std::string jpeg_decoder_name();
std::string jpeg_ls_decoder_name();
std::string jpeg_2000_decoder_name();

}  // namespace isoatlas::detail::io
