// SPDX-License-Identifier: Apache-2.0
// Zeiss LSM: TIFF with a binary description, a preview after each page, and lengths in metres.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::uint32_t kLsmTag = 34412;

/// Numbers at fixed offsets of the tag.
class Fields {
 public:
  Fields(std::string bytes, bool is_big_endian)
      : bytes_(std::move(bytes)),
        must_swap_(is_big_endian != (std::endian::native == std::endian::big)) {}

  template <class Number>
  Number at(std::size_t offset) {
    Number number{};
    std::memcpy(&number, bytes_.data() + offset, sizeof number);
    if (must_swap_) swap_byte_order(&number, 1, sizeof number);
    return number;
  }

 private:
  std::string bytes_;
  bool must_swap_;
};

}  // namespace

std::optional<TiffStack> describe_lsm(TiffFile& tiff, VolumeSource& source) {
  const std::string bytes = tiff.bytes_of_tag(kLsmTag);
  constexpr std::size_t kUsedBytes = 90;
  if (bytes.size() < kUsedBytes) {
    return {};
  }
  Fields fields(bytes, tiff.is_big_endian());
  const auto scan_type = fields.at<std::uint16_t>(88);
  const std::array<std::int32_t, 2> sizes{fields.at<std::int32_t>(16),
                                          fields.at<std::int32_t>(24)};  // z and time
  std::vector<std::size_t> pages = pages_without_previews(tiff, source);
  tiff.select(pages.front());
  TiffStack stack;
  stack.format = "Zeiss LSM";
  stack.slices = static_cast<std::size_t>(std::max(sizes[0], 1));
  stack.times = static_cast<std::size_t>(std::max(sizes[1], 1));
  constexpr std::uint16_t kStack = 0;
  if (scan_type != kStack || pages.size() != stack.slices * stack.times) {
    throw unsupported(tiff.path(), "is a Zeiss LSM file of scan type " + std::to_string(scan_type) +
                                       " with " + std::to_string(pages.size()) + " pages for " +
                                       std::to_string(stack.slices) + " slices x " +
                                       std::to_string(stack.times) +
                                       " time points, expected one stack of x, y and z (scan type "
                                       "0); Fiji can save it as OME-TIFF");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto length = fields.at<double>(40 + 8 * axis) * 1e6;
    if (std::isfinite(length) && length > 0) {
      stack.spacing[axis] = length;
    }
  }
  stack.unit = LengthUnit::micrometre;
  set_page_order(stack, "ZTC", std::move(pages));
  return stack;
}

}  // namespace isoatlas::detail::io
