// SPDX-License-Identifier: Apache-2.0
// Writes TIFF files by hand, so that tags can have invalid values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace isoatlas::detail::test {

struct TiffTag {
  std::uint16_t tag;
  std::uint16_t type;  // 1 BYTE, 2 ASCII, 3 SHORT, 4 LONG, 5 RATIONAL (two numbers each)
  std::vector<std::uint32_t> values;  // otherwise `bytes`
  std::string bytes = {};
};

struct TiffPage {
  std::uint32_t width = 4, height = 3;
  std::string samples = {};
  std::string description = {};
  std::uint32_t bits = 8, format = 1, values = 1, photometric = 1;
  std::optional<std::uint32_t> strip_bytes = {};  // empty: all samples
  std::vector<TiffTag> more = {};                 // replace the tags made from the fields above
};

/// Writes classic or BigTIFF files with one uncompressed strip per page. The samples must be in the
/// file's byte order.
class TiffWriter {
 public:
  explicit TiffWriter(bool is_big_endian = false, bool is_big_tiff = false)
      : is_big_endian_(is_big_endian), is_big_tiff_(is_big_tiff) {
    file_ = is_big_endian ? "MM" : "II";
    put(is_big_tiff ? 43 : 42, 2);
    if (is_big_tiff) {
      put(8, 2);
      put(0, 2);
    }
    link_ = file_.size();
    put(0, word());
  }

  TiffWriter& add(const TiffPage& page) {
    const std::uint64_t samples_at = file_.size();
    file_ += page.samples;
    std::vector<TiffTag> tags{
        {256, 4, {page.width}},
        {257, 4, {page.height}},
        {258, 3, std::vector<std::uint32_t>(page.values, page.bits)},
        {259, 3, {1}},
        {262, 3, {page.photometric}},
        {273, 4, {static_cast<std::uint32_t>(samples_at)}},
        {277, 3, {page.values}},
        {278, 4, {page.height}},
        {279, 4, {page.strip_bytes.value_or(static_cast<std::uint32_t>(page.samples.size()))}},
        {339, 3, std::vector<std::uint32_t>(page.values, page.format)}};
    if (!page.description.empty())
      tags.push_back({270, 2, {}, page.description + std::string(1, '\0')});
    for (const TiffTag& tag : page.more) {
      std::erase_if(tags, [&](const TiffTag& other) { return other.tag == tag.tag; });
      tags.push_back(tag);
    }
    std::ranges::sort(tags, {}, &TiffTag::tag);
    put_directory(tags);
    return *this;
  }

  const std::string& bytes() const { return file_; }

  /// The file with the last page's link set to the directory of the first.
  std::string ring() const {
    std::string file = file_;
    std::memcpy(file.data() + link_, file.data() + (is_big_tiff_ ? 8 : 4), word());
    return file;
  }

 private:
  std::size_t word() const { return is_big_tiff_ ? 8 : 4; }

  std::string number(std::uint64_t value, std::size_t bytes) const {
    std::string digits;
    for (std::size_t i = 0; i < bytes; ++i) {
      digits += static_cast<char>(value >> 8 * (is_big_endian_ ? bytes - 1 - i : i) & 0xFFU);
    }
    return digits;
  }
  void put(std::uint64_t value, std::size_t bytes) { file_ += number(value, bytes); }

  void put_directory(const std::vector<TiffTag>& tags) {
    constexpr std::size_t kBytes[] = {0, 1, 1, 2, 4, 8};
    std::vector<std::string> fields;
    for (const TiffTag& tag : tags) {
      std::string field = tag.bytes;
      for (const std::uint32_t value : tag.values)
        field += number(value, tag.type == 5 ? 4 : kBytes[tag.type]);
      const std::size_t count = field.size() / kBytes[tag.type];
      if (field.size() > word()) {
        const std::size_t at = file_.size();
        file_ += field;
        field = number(at, word());
      }
      field.resize(word());
      fields.push_back(number(tag.tag, 2) + number(tag.type, 2) + number(count, word()) + field);
    }
    const std::string here = number(file_.size(), word());
    file_.replace(link_, word(), here);
    put(tags.size(), is_big_tiff_ ? 8 : 2);
    for (const std::string& field : fields) file_ += field;
    link_ = file_.size();
    put(0, word());
  }

  bool is_big_endian_, is_big_tiff_;
  std::string file_;
  std::size_t link_ = 0;
};

}  // namespace isoatlas::detail::test
