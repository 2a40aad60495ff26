// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 section 7 (data elements, sequences, items) and PS3.10 section 7 (preamble, file meta group).
#include "volume_files/dicom_file_end.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::io {

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFF'FFFFU;
constexpr std::uint32_t kPixelData = 0x7FE0'0010U;
constexpr std::uint32_t kTransferSyntax = 0x0002'0010U;
constexpr std::uint32_t kItem = 0xFFFE'E000U;
constexpr std::uint32_t kItemEnd = 0xFFFE'E00DU;
constexpr std::uint32_t kSequenceEnd = 0xFFFE'E0DDU;
constexpr int kDeepestNesting = 64;

constexpr std::size_t kPreamble = 128;
constexpr std::string_view kMark = "DICM";

struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
};

// How a walk ends that does not reach the end of the pixel data. Thrown inside this file only.
struct CutOff {};
struct NotUnderstood {};

class Walker {
 public:
  explicit Walker(std::string_view bytes) : bytes_(bytes) {}

  void walk() {
    position_ = kPreamble + kMark.size();
    std::string transfer_syntax;
    while (position_ + 2 <= bytes_.size() && number<std::uint16_t>(position_) == 0x0002) {
      const Element element = next_element(true);
      if (element.length == kUndefinedLength) {
        throw NotUnderstood{};
      }
      const std::size_t value = position_;
      skip(element.length);
      if (element.tag == kTransferSyntax) {
        transfer_syntax = std::string(bytes_.substr(value, element.length));
        transfer_syntax.erase(transfer_syntax.find_last_not_of(std::string_view(" \0", 2)) + 1);
      }
    }
    if (transfer_syntax == "1.2.840.10008.1.2.2" || transfer_syntax == "1.2.840.10008.1.2.1.99") {
      throw NotUnderstood{};  // big endian, deflated
    }
    const bool has_explicit_types = transfer_syntax != "1.2.840.10008.1.2";
    while (position_ < bytes_.size()) {
      const Element element = next_element(has_explicit_types);
      if (element.length != kUndefinedLength) {
        skip(element.length);
      } else if (element.tag == kPixelData) {
        skip_fragments();
      } else {
        skip_sequence(has_explicit_types, 0);
      }
      if (element.tag == kPixelData) {
        return;
      }
    }
  }

 private:
  template <class Number>
  Number number(std::size_t position) const {
    if (position + sizeof(Number) > bytes_.size()) {
      throw CutOff{};
    }
    Number value = 0;
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      value = static_cast<Number>(value << 8U | static_cast<unsigned char>(bytes_[position + i]));
    }
    return value;
  }

  void skip(std::uint64_t bytes) {
    if (bytes > bytes_.size() - position_) {
      throw CutOff{};
    }
    position_ += static_cast<std::size_t>(bytes);
  }

  // Reads a tag and a length; the position is then at the value.
  Element next_element(bool has_explicit_types) {
    const auto group = number<std::uint16_t>(position_);
    const auto member = number<std::uint16_t>(position_ + 2);
    Element element{static_cast<std::uint32_t>(group) << 16U | member, 0};
    const bool is_delimiter = group == 0xFFFE;  // has no type in any syntax
    if (is_delimiter || !has_explicit_types) {
      element.length = number<std::uint32_t>(position_ + 4);
      skip(8);
      return element;
    }
    number<std::uint16_t>(position_ + 4);
    const std::string_view type = bytes_.substr(position_ + 4, 2);
    constexpr std::array<std::string_view, 13> kLongTypes{"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"};
    bool is_long = false;
    for (const std::string_view long_type : kLongTypes) {
      is_long = is_long || type == long_type;
    }
    element.length = is_long ? number<std::uint32_t>(position_ + 8) : number<std::uint16_t>(position_ + 6);
    skip(is_long ? 12 : 8);
    return element;
  }

  // Compressed pixel data: items of known length up to a delimiter.
  void skip_fragments() {
    for (Element item = next_element(false); item.tag != kSequenceEnd; item = next_element(false)) {
      skip(item.length);
    }
  }

  void skip_sequence(bool has_explicit_types, int depth) {
    for (Element item = next_element(has_explicit_types); item.tag != kSequenceEnd; item = next_element(has_explicit_types)) {
      if (item.tag != kItem || depth > kDeepestNesting) {
        throw NotUnderstood{};
      }
      if (item.length != kUndefinedLength) {
        skip(item.length);
        continue;
      }
      for (Element inner = next_element(has_explicit_types); inner.tag != kItemEnd; inner = next_element(has_explicit_types)) {
        if (inner.length != kUndefinedLength) {
          skip(inner.length);
        } else {
          skip_sequence(has_explicit_types, depth + 1);
        }
      }
    }
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
};

}  // namespace

void require_whole_dicom_file(const std::filesystem::path& path) {
  const std::string start = first_bytes(path, kPreamble + kMark.size());
  if (start.size() < kPreamble + kMark.size() || !start.ends_with(kMark)) {
    return;
  }
  const std::string bytes = file_contents(path);
  try {
    Walker(bytes).walk();
  } catch (const NotUnderstood&) {  // then GDCM's word is all there is
  } catch (const CutOff&) {
    throw bad_file(path, "is cut off: its data elements reach beyond its " + std::to_string(bytes.size()) + " bytes");
  }
}

}  // namespace isoatlas::io
