// SPDX-License-Identifier: Apache-2.0
// Compressed frames of DICOM files: JPEG, JPEG-LS, JPEG 2000 and run length encoding (RLE).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

bool can_decode(const std::string& transfer_syntax);

/// The name of a compression, e.g. "JPEG 2000"; the transfer syntax itself if it is not a known
/// compressed one.
std::string compression_name(const std::string& transfer_syntax);

/// Sets the bits per sample from the first compressed frame, as the decoder does, and compares its
/// size with the header's. Returns a description of the problem; empty without a problem.
std::string adapt_to_stream(DicomBytes& bytes, DicomImage& image);

/// For each frame of the image, the fragments of its compressed stream. @throws Error(bad_file) if
/// frames and fragments do not match
std::vector<std::vector<DicomPixels::Fragment>> fragments_of_frames(DicomBytes& bytes,
                                                                    const DicomImage& image);

/// Decodes one frame into rows * columns samples in the format `image.format`.
/// @param frame  index from 0, for messages
/// @throws Error(bad_file) if it cannot be decoded to its end
void decode_frame(const DicomImage& image, std::size_t frame, const std::string& stream,
                  void* samples);

/// The library that decodes the image's frames, with its version, e.g. "OpenJPEG 2.5.0"; "isoatlas"
/// if no library is used.
std::string decoder_name(const DicomImage& image);

}  // namespace isoatlas::detail::io
