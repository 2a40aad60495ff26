// SPDX-License-Identifier: Apache-2.0
// One compressed frame of grey values into memory, by the library for its kind. Each returns
// whether the frame was decoded to its end; the caller has compared the stream's header with the
// size that it passes. Use these under LibraryMessages.
//
// GDCM decodes all of these, but its asserts, which Debian leaves in, end the process where a
// stream is damaged.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoatlas::detail::io {

struct FrameSize {
  std::size_t columns = 0, rows = 0;
  unsigned bits = 0;  ///< per sample, 2 to 32, as the stream says
  bool is_signed = false;

  std::size_t sample_bytes() const { return bits <= 8 ? 1 : bits <= 16 ? 2 : 4; }
  std::size_t bytes() const { return columns * rows * sample_bytes(); }
};

/// JPEG with 8 or 12 bits, lossless JPEG with 2 to 16: DCMTK.
bool decode_jpeg(const std::string& stream, const FrameSize& frame, char* to);
/// CharLS.
bool decode_jpeg_ls(const std::string& stream, const FrameSize& frame, char* to);
/// A codestream without a file around it: OpenJPEG.
bool decode_jpeg_2000(const std::string& stream, const FrameSize& frame, char* to);
/// Run lengths as DICOM has them.
bool decode_run_lengths(std::string_view stream, const FrameSize& frame, char* to);

// "DCMTK 3.6.7"
std::string jpeg_decoder_name();
std::string jpeg_ls_decoder_name();
std::string jpeg_2000_decoder_name();

}  // namespace isoatlas::detail::io
