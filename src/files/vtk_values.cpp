// SPDX-License-Identifier: Apache-2.0
#include "files/vtk_values.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "field/sample_type.h"
#include "files/byte_source.h"
#include "files/file_error.h"
#include "files/number_text.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

class FileBytes final : public ByteStream {
 public:
  FileBytes(const fs::path& path, std::uint64_t begin, std::uint64_t end)
      : source_(path, begin, Packing::none), left_(end - begin) {}

  std::size_t read(char* to, std::size_t bytes) override {
    const std::size_t count =
        source_.read(to, static_cast<std::size_t>(std::min<std::uint64_t>(bytes, left_)));
    left_ -= count;
    return count;
  }

 private:
  ByteSource source_;
  std::uint64_t left_;
};

void read_exactly(const fs::path& path, ByteStream& bytes, char* to, std::uint64_t count) {
  if (bytes.read(to, static_cast<std::size_t>(count)) != count) {
    throw bad_file(path, "is cut off or damaged: its samples end too early");
  }
}

class BinaryValues final : public VtkValues {
 public:
  BinaryValues(const fs::path& path, std::unique_ptr<ByteStream> bytes, SampleType type,
               bool is_big_endian)
      : path_(path),
        bytes_(std::move(bytes)),
        value_bytes_(bytes_per_sample(type)),
        must_swap_bytes_(value_bytes_ > 1 &&
                         is_big_endian != (std::endian::native == std::endian::big)) {}

  void read(void* to, std::uint64_t count) override {
    read_exactly(path_, *bytes_, static_cast<char*>(to), count * value_bytes_);
    if (must_swap_bytes_) {
      swap_byte_order(to, count, value_bytes_);
    }
  }

 private:
  fs::path path_;
  std::unique_ptr<ByteStream> bytes_;
  std::size_t value_bytes_;
  bool must_swap_bytes_;
};

// Values of one bit, eight to a byte, the first in the highest bit.
class BitValues final : public VtkValues {
 public:
  BitValues(const fs::path& path, std::unique_ptr<ByteStream> bytes)
      : path_(path), bytes_(std::move(bytes)) {}

  void read(void* to, std::uint64_t count) override {
    auto* const values = static_cast<std::uint8_t*>(to);
    for (std::uint64_t i = 0; i < count; ++i, ++used_bits_) {
      if (used_bits_ == 8) {
        read_exactly(path_, *bytes_, &byte_, 1);
        used_bits_ = 0;
      }
      values[i] = static_cast<unsigned char>(byte_) >> (7U - used_bits_) & 1U;
    }
  }

 private:
  fs::path path_;
  std::unique_ptr<ByteStream> bytes_;
  char byte_ = 0;
  unsigned used_bits_ = 8;
};

// Reads a value as it is in the file: decimal text is rounded once, to T itself, and integers are
// read with integer arithmetic, so that all 64 bits are exact. Integers may be written like 3.0 or
// 1e3; a number too small for a float becomes 0.
template <class T>
bool parse_value(std::string_view word, T& value) {
  if (parse_number(word, value)) {
    return true;
  }
  if constexpr (std::is_integral_v<T>) {
    return parse_integer_in_decimal(word, value);
  }
  return false;
}

bool parse_colour(std::string_view word, std::uint8_t& value) {
  float fraction = -1;
  if (!parse_value(word, fraction) || !(fraction >= 0 && fraction <= 1)) {
    return false;
  }
  value = static_cast<std::uint8_t>(fraction * 255.0F + 0.5F);
  return true;
}

bool parse_bit(std::string_view word, std::uint8_t& value) {
  return parse_value(word, value) && value <= 1;
}

class TextValues final : public VtkValues {
 public:
  TextValues(const fs::path& path, FileText text, VtkType type, bool is_colour)
      : path_(path), text_(std::move(text)), type_(type), is_colour_(is_colour) {}

  void read(void* to, std::uint64_t count) override {
    if (is_colour_ || type_.is_bit) {
      return read_each(static_cast<std::uint8_t*>(to), count,
                       is_colour_ ? parse_colour : parse_bit);
    }
    visit_sample_type(type_.sample, [&](auto* sample) {
      using T = std::remove_const_t<std::remove_pointer_t<decltype(sample)>>;
      read_each(static_cast<T*>(to), count, parse_value<T>);
    });
  }

 private:
  template <class T>
  void read_each(T* values, std::uint64_t count, bool (*parse)(std::string_view, T&)) {
    for (std::uint64_t i = 0; i < count; ++i, ++values_read_) {
      const std::string_view word = text_.word();
      if (!parse(word, values[i])) {
        throw bad_file(path_, "is cut off or damaged: after " + std::to_string(values_read_) +
                                  " numbers it has " +
                                  (word.empty() ? "nothing" : "'" + one_line(word, 40) + "'") +
                                  ", expected a value of type " +
                                  std::string(is_colour_ ? "colour, from 0 to 1" : type_.name()));
      }
    }
  }

  fs::path path_;
  FileText text_;
  VtkType type_;
  bool is_colour_;
  std::uint64_t values_read_ = 0;
};

}  // namespace

std::unique_ptr<ByteStream> file_bytes(const fs::path& path, std::uint64_t begin,
                                       std::uint64_t end) {
  return std::make_unique<FileBytes>(path, begin, end);
}

std::unique_ptr<VtkValues> binary_values(const fs::path& path, std::unique_ptr<ByteStream> bytes,
                                         VtkType type, bool is_big_endian) {
  if (type.is_bit) {
    return std::make_unique<BitValues>(path, std::move(bytes));
  }
  return std::make_unique<BinaryValues>(path, std::move(bytes), type.sample, is_big_endian);
}

std::unique_ptr<VtkValues> text_values(const fs::path& path, FileText text, VtkType type,
                                       bool is_colour) {
  return std::make_unique<TextValues>(path, std::move(text), type, is_colour);
}

void read_component(VtkValues& values, SampleType type, std::uint64_t components,
                    std::uint64_t component, std::uint64_t count, std::byte* to) {
  if (components == 1) {
    return values.read(to, count);
  }
  constexpr std::uint64_t kChunk = std::uint64_t{1} << 16;
  const std::size_t value_bytes = bytes_per_sample(type);
  const std::uint64_t chunk =
      std::clamp<std::uint64_t>(kChunk / components, 1, std::max<std::uint64_t>(count, 1));
  std::vector<std::byte> tuples(static_cast<std::size_t>(chunk * components * value_bytes));
  for (std::uint64_t done = 0; done < count;) {
    const std::uint64_t now = std::min(chunk, count - done);
    values.read(tuples.data(), now * components);
    const std::byte* from = tuples.data() + component * value_bytes;
    for (std::uint64_t i = 0; i < now; ++i, from += components * value_bytes, to += value_bytes) {
      std::memcpy(to, from, value_bytes);
    }
    done += now;
  }
}

}  // namespace isoatlas::detail::io
