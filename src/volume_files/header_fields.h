// SPDX-License-Identifier: Apache-2.0
// Numbers at fixed offsets of a binary header.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "files/byte_source.h"

namespace isoatlas::detail::io {

/// A header in memory, in either byte order. The caller has checked that it has the length that its
/// format requires.
class HeaderFields {
 public:
  HeaderFields(std::string_view bytes, bool swap) : bytes_(bytes), swap_(swap) {}

  template <class Value>
  Value at(std::size_t offset) const {
    Value value;
    std::memcpy(&value, bytes_.substr(offset, sizeof value).data(), sizeof value);
    if (swap_) swap_byte_order(&value, 1, sizeof value);
    return value;
  }
  std::int32_t int32(std::size_t offset) const { return at<std::int32_t>(offset); }
  double float32(std::size_t offset) const { return at<float>(offset); }

 private:
  std::string_view bytes_;
  bool swap_;
};

}  // namespace isoatlas::detail::io
