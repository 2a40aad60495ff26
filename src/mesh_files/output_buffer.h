// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstring>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>

namespace isoatlas::detail::io {

/// Collects small pieces of text or data and writes them to a stream in large blocks. Call flush()
/// at the end.
class OutputBuffer {
 public:
  explicit OutputBuffer(std::ostream& stream) : stream_(stream) {
    buffer_.reserve(kCapacity + 4096);
  }

  void text(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() >= kCapacity) {
      flush();
    }
  }

  /// Writes the shortest digits that read back as the same number, the same in every locale.
  template <class Number>
  void number(Number value) {
    char digits[32];
    const auto result = std::to_chars(digits, digits + sizeof digits, value);
    text({digits, result.ptr});
  }

  /// Writes the bytes of the value as in memory.
  template <class Value>
  void bytes(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    char copy[sizeof value];
    std::memcpy(copy, &value, sizeof value);
    text({copy, sizeof value});
  }

  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kCapacity = std::size_t{1} << 20;
  std::ostream& stream_;
  std::string buffer_;
};

}  // namespace isoatlas::detail::io
