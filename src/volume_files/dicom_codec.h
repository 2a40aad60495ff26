// SPDX-License-Identifier: Apache-2.0
// Compressed frames of DICOM files: JPEG, JPEG-LS, JPEG 2000 and run lengths (RLE).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volume_files/dicom_image.h"

namespace isoatlas::detail::io {

bool can_decode(const std::string& transfer_syntax);

/// "JPEG 2000"; the transfer syntax itself where it is none of the compressed ones.
std::string compression_name(const std::string& transfer_syntax);

/// Takes the bits per sample from the first compressed frame, which the decoder goes by, and
/// compares its size with the header's. Returns what is wrong with it; empty: nothing.
std::string adapt_to_stream(DicomBytes& bytes, DicomImage& image);

/// For each frame of the image, its compressed stream's fragments. @throws Error(bad_file) if
/// frames and fragments do not match
std::vector<std::vector<DicomPixels::Fragment>> fragments_of_frames(DicomBytes& bytes,
                                                                    const DicomImage& image);

/// Decodes one frame into rows * columns samples as `image.format` says.
/// @param frame  from 0, for messages  @throws Error(bad_file) if it cannot be decoded to its end
void decode_frame(const DicomImage& image, std::size_t frame, const std::string& stream,
                  void* samples);

/// The library that decodes the image's frames, with its version: "OpenJPEG 2.5.0"; "isoatlas"
/// where it is none.
std::string decoder_name(const DicomImage& image);

}  // namespace isoatlas::detail::io
