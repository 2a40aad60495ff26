// SPDX-License-Identifier: Apache-2.0
#include "volume_files/piece_reader.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "field/sample_type.h"
#include "files/file_error.h"
#include "files/number_text.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;
constexpr std::uint64_t kRestLimit = std::uint64_t{1} << 20;

ByteSource source_of(const SamplePiece& piece) {
  if (piece.packing == Packing::none) {
    return {piece.file, piece.offset + piece.skipped_bytes, Packing::none};
  }
  ByteSource source(piece.file, piece.offset, piece.packing);
  source.skip(piece.skipped_bytes);
  return source;
}

class BinaryReader final : public PieceReader {
 public:
  BinaryReader(SamplePiece piece, std::size_t sample_bytes, std::uint64_t samples)
      : piece_(std::move(piece)), sample_bytes_(sample_bytes), stated_(samples * sample_bytes) {}

  void read(std::byte* to, std::uint64_t samples) override {
    read_bytes(to, samples * sample_bytes_);
  }

  void skip(std::uint64_t samples) override {
    const std::uint64_t bytes = samples * sample_bytes_;
    if (piece_.packing == Packing::none) {
      source_.reset();  // opened again after the skipped samples when they are read
      position_ += bytes;
      return;
    }
    std::vector<std::byte> unwanted(
        static_cast<std::size_t>(std::min<std::uint64_t>(bytes, kChunk)));
    for (std::uint64_t left = bytes; left > 0;) {
      const std::uint64_t count = std::min<std::uint64_t>(left, unwanted.size());
      read_bytes(unwanted.data(), count);
      left -= count;
    }
  }

  std::uint64_t count_rest() override {
    if (piece_.packing != Packing::none) {
      return source_->count_rest(kRestLimit);
    }
    const std::uint64_t end = piece_.offset + piece_.skipped_bytes + stated_;
    return std::max(readable_file_size(piece_.file), end) - end;
  }

 private:
  void read_bytes(std::byte* to, std::uint64_t bytes) {
    if (!source_) {
      SamplePiece rest = piece_;
      rest.skipped_bytes += position_;
      source_.emplace(source_of(rest));
    }
    const std::uint64_t count = source_->read(to, static_cast<std::size_t>(bytes));
    position_ += count;
    if (count < bytes) {
      require_stored_bytes(piece_.file, stated_, position_);
    }
  }

  SamplePiece piece_;
  std::size_t sample_bytes_;
  std::uint64_t stated_;
  std::uint64_t position_ = 0;  // bytes read or skipped
  std::optional<ByteSource> source_;
};

/// Reads words up to a maximum length from a stream of any length.
class WordSource {
 public:
  explicit WordSource(ByteSource source) : source_(std::move(source)), text_(kChunk, '\0') {}

  /// The next word, valid until the next call; empty at the end.
  std::string_view next() {
    constexpr std::string_view kSeparators = " \t\r\n\v\f,";
    for (;;) {
      const std::string_view rest = std::string_view(text_).substr(begin_, end_ - begin_);
      const std::size_t first = std::min(rest.find_first_not_of(kSeparators), rest.size());
      const std::size_t length =
          std::min(rest.find_first_of(kSeparators, first), rest.size()) - first;
      begin_ += first;
      if (first + length < rest.size() || is_at_end_ || length > kChunk / 2) {
        begin_ += length;
        return std::string_view(text_).substr(begin_ - length, length);
      }
      refill();
    }
  }

 private:
  void refill() {
    std::memmove(text_.data(), text_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    const std::size_t room = text_.size() - end_;
    const std::size_t count = source_.read(text_.data() + end_, room);
    end_ += count;
    is_at_end_ = count < room;
  }

  ByteSource source_;
  std::string text_;
  std::size_t begin_ = 0, end_ = 0;
  bool is_at_end_ = false;
};

template <class T>
std::optional<T> sample_of(std::string_view word) {
  T value{};
  if (parse_number(word, value)) {
    return value;
  }
  if constexpr (std::is_integral_v<T>) {  // "12.0" and "1e3" are integers too
    if (parse_integer_in_decimal(word, value)) {
      return value;
    }
  }
  return std::nullopt;
}

class TextReader final : public PieceReader {
 public:
  TextReader(const SamplePiece& piece, SampleType type, std::uint64_t samples)
      : file_(piece.file), type_(type), stated_(samples), words_(source_of(piece)) {}

  void read(std::byte* to, std::uint64_t samples) override {
    visit_sample_type(type_, [&](auto* null) {
      using T = std::remove_cvref_t<decltype(*null)>;
      for (std::uint64_t i = 0; i < samples; ++i) {
        const std::string_view word = next();
        const std::optional<T> value = sample_of<T>(word);
        if (!value) {
          throw bad_file(file_, "sample " + std::to_string(position_ - 1) + " is '" +
                                    one_line(word, 40) + "', expected a number of type " +
                                    std::string(name(type_)));
        }
        std::memcpy(to + i * sizeof(T), &*value, sizeof(T));
      }
    });
  }

  void skip(std::uint64_t samples) override {
    for (std::uint64_t i = 0; i < samples; ++i) {
      next();
    }
  }

  std::uint64_t count_rest() override {
    std::uint64_t count = 0;
    while (count < kRestLimit) {
      const std::size_t length = words_.next().size();
      if (length == 0) {
        break;
      }
      count += length;
    }
    return count;
  }

 private:
  std::string_view next() {
    const std::string_view word = words_.next();
    if (word.empty()) {
      throw bad_file(file_, "is cut off or damaged: the header states " + std::to_string(stated_) +
                                " numbers, the file has " + std::to_string(position_));
    }
    ++position_;
    return word;
  }

  std::filesystem::path file_;
  SampleType type_;
  std::uint64_t stated_;
  std::uint64_t position_ = 0;
  WordSource words_;
};

class HexadecimalReader final : public PieceReader {
 public:
  HexadecimalReader(const SamplePiece& piece, std::size_t sample_bytes, std::uint64_t samples)
      : file_(piece.file),
        sample_bytes_(sample_bytes),
        stated_(samples * sample_bytes),
        source_(source_of(piece)),
        text_(kChunk, '\0') {}

  void read(std::byte* to, std::uint64_t samples) override {
    for (std::uint64_t i = 0; i < samples * sample_bytes_; ++i) {
      const int high = digit();
      to[i] = static_cast<std::byte>(16 * high + digit());
      ++position_;
    }
  }

  void skip(std::uint64_t samples) override {
    for (std::uint64_t i = 0; i < samples; ++i) {
      std::byte unwanted[8];
      read(unwanted, 1);
    }
  }

  std::uint64_t count_rest() override {
    std::uint64_t count = 0;
    while (count < kRestLimit && next_character()) {
      ++count;
    }
    return count;
  }

 private:
  // The next character that is not blank.
  std::optional<char> next_character() {
    for (;;) {
      if (begin_ == end_) {
        begin_ = 0;
        end_ = source_.read(text_.data(), text_.size());
        if (end_ == 0) {
          return std::nullopt;
        }
      }
      const char c = text_[begin_++];
      if (static_cast<unsigned char>(c) > ' ') {
        return c;
      }
    }
  }

  int digit() {
    const std::optional<char> c = next_character();
    if (!c) {
      require_stored_bytes(file_, stated_, position_);
    }
    int value = 0;
    if (std::from_chars(&*c, &*c + 1, value, 16).ec != std::errc{}) {
      throw bad_file(file_, "byte " + std::to_string(position_) + " of its samples has '" +
                                one_line(std::string(1, *c)) + "', expected a hexadecimal digit");
    }
    return value;
  }

  std::filesystem::path file_;
  std::size_t sample_bytes_;
  std::uint64_t stated_;
  std::uint64_t position_ = 0;
  ByteSource source_;
  std::string text_;
  std::size_t begin_ = 0, end_ = 0;
};

// The largest number of bytes that one compressed byte can produce: 1032 for deflate, and 45.9 MB
// (runs of 255) for the smallest bzip2 block of 33 bytes.
std::uint64_t most_per_byte(Packing packing) {
  return packing == Packing::bzip2 ? 2'000'000 : 1100;
}

}  // namespace

std::unique_ptr<PieceReader> open_piece(const SamplePiece& piece, const SampleFormat& format,
                                        std::uint64_t samples) {
  switch (format.encoding) {
    case SampleEncoding::text:
      return std::make_unique<TextReader>(piece, format.type, samples);
    case SampleEncoding::hexadecimal:
      return std::make_unique<HexadecimalReader>(piece, bytes_per_sample(format.type), samples);
    default:
      return std::make_unique<BinaryReader>(piece, bytes_per_sample(format.type), samples);
  }
}

void require_possible_piece(const SamplePiece& piece, const SampleFormat& format,
                            std::uint64_t samples) {
  const std::uint64_t file_bytes = readable_file_size(piece.file);
  const std::uint64_t packed = file_bytes - std::min(piece.offset, file_bytes);
  const std::uint64_t stated = samples * bytes_per_sample(format.type);
  // A number in text takes at least a digit and a blank; a hexadecimal byte takes two digits.
  const bool is_text = format.encoding == SampleEncoding::text;
  const std::uint64_t needed = is_text ? samples : stated;
  if (piece.packing != Packing::none) {
    require_possible_bytes(piece.file, needed, packed, most_per_byte(piece.packing));
    return;
  }
  const std::uint64_t stored = packed - std::min(piece.skipped_bytes, packed);
  if (format.encoding == SampleEncoding::binary) {
    require_stored_bytes(piece.file, stated, stored);
  } else if (needed > (stored + 1) / 2) {
    throw bad_file(piece.file, "the header states " + std::to_string(needed) +
                                   (is_text ? " numbers" : " bytes in hexadecimal") +
                                   ", far more than " + std::to_string(stored) +
                                   " characters can hold");
  }
}

}  // namespace isoatlas::detail::io
