// SPDX-License-Identifier: Apache-2.0
// One PNG image, by libpng; values as stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

struct PngFormat {
  std::uint32_t width = 0, height = 0;
  unsigned bits = 8;  ///< bits of one value: 1, 2, 4, 8 or 16
  unsigned values_per_sample =
      1;  ///< 1: grey or palette, 2: grey and alpha, 3: red, green and blue, 4: the same with alpha
  bool is_palette = false;
  friend bool operator==(const PngFormat&, const PngFormat&) = default;

  bool has_alpha() const { return values_per_sample % 2 == 0; }
  SampleType type() const { return bits == 16 ? SampleType::uint16 : SampleType::uint8; }
  std::uint64_t stored_bytes() const;
};

/// E.g. "24 x 20 samples of uint8"; states the values of a sample if it is not one grey value.
std::string to_string(const PngFormat& format);

/// @throws Error(bad_file) if it is not a PNG file, or is damaged
PngFormat png_format(const std::filesystem::path& path);

/// Reads value `value` of every sample to `samples`, which has room for width x height of the type.
/// @throws Error(bad_file) if the image cannot be decoded completely, or is not of this format
/// @throws Error(unsupported) if it has an alpha value that is not opaque
/// @throws Error(out_of_memory) if all values together are larger than the limit
void read_png(const std::filesystem::path& path, const PngFormat& format, std::size_t value,
              const ReadOptions& options, std::byte* samples);

std::string png_library_version();  ///< "libpng 1.6.39"

}  // namespace isoatlas::detail::io
