// SPDX-License-Identifier: Apache-2.0
// The values of one array of a VTK file, from first to last, for every way to store them. VTK's own
// readers return uninitialised memory where values are missing. These readers return a value only
// if it is in the file, else they throw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "files/file_text.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::io {

/// A type of VTK. Bits are stored eight to a byte and read as uint8.
struct VtkType {
  SampleType sample = SampleType::uint8;
  bool is_bit = false;
  friend bool operator==(const VtkType&, const VtkType&) = default;

  std::string_view name() const { return is_bit ? "bit" : isoatlas::name(sample); }
  std::uint64_t stored_bytes(std::uint64_t values) const {
    return is_bit ? values / 8 + (values % 8 > 0 ? 1 : 0) : values * bytes_per_sample(sample);
  }
};

class VtkValues {
 public:
  virtual ~VtkValues() = default;
  /// Reads the next `count` values in the machine's byte order.
  /// @throws Error(bad_file) if there are fewer, or if one is damaged or outside the range of its
  /// type
  virtual void read(void* to, std::uint64_t count) = 0;
};

class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Reads at most `bytes` bytes and returns the number read, which is smaller only at the end.
  /// @throws Error(bad_file) if the bytes are damaged
  virtual std::size_t read(char* to, std::size_t bytes) = 0;
};

/// The bytes of a file in [begin, end).
std::unique_ptr<ByteStream> file_bytes(const std::filesystem::path& path, std::uint64_t begin,
                                       std::uint64_t end);

std::unique_ptr<VtkValues> binary_values(const std::filesystem::path& path,
                                         std::unique_ptr<ByteStream> bytes, VtkType type,
                                         bool is_big_endian);

/// @param is_colour  the numbers are fractions from 0 to 1, which stand for 0 to 255
std::unique_ptr<VtkValues> text_values(const std::filesystem::path& path, FileText text,
                                       VtkType type, bool is_colour = false);

/// Reads the next `count` tuples of `components` values each and keeps one component of each tuple.
void read_component(VtkValues& values, SampleType type, std::uint64_t components,
                    std::uint64_t component, std::uint64_t count, std::byte* to);

}  // namespace isoatlas::detail::io
