// SPDX-License-Identifier: Apache-2.0
// Writes DICOM files element by element, valid or invalid as a test requires. Based on: DICOM PS3.5
// section 7, PS3.10 section 7.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isoatlas/volume.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {

inline constexpr std::string_view kExplicitLittle = "1.2.840.10008.1.2.1",
                                  kImplicitLittle = "1.2.840.10008.1.2",
                                  kExplicitBig = "1.2.840.10008.1.2.2";

template <class Number>
std::string bytes_of(const std::vector<Number>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)};
}

/// Decimal strings in the standard's form: "1.5\2".
inline std::string decimals(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    text += text.empty() ? "" : "\\";
    text.append(digits, end);
  }
  return text;
}

/// A data set. Setting an attribute again replaces it.
class DicomBuilder {
 public:
  DicomBuilder& set(std::uint32_t tag, const std::string& type, std::string value) {
    elements_[tag] = {type, std::move(value), {}, false};
    return *this;
  }
  DicomBuilder& set_short(std::uint32_t tag, std::uint16_t value) {
    return set(tag, "US", bytes_of<std::uint16_t>({value}));
  }
  DicomBuilder& set_decimals(std::uint32_t tag, const std::vector<double>& values) {
    return set(tag, "DS", decimals(values));
  }
  DicomBuilder& set_items(std::uint32_t tag, std::vector<DicomBuilder> items,
                          bool has_lengths = true) {
    elements_[tag] = {"SQ", {}, std::move(items), has_lengths};
    return *this;
  }
  DicomBuilder& remove(std::uint32_t tag) {
    elements_.erase(tag);
    return *this;
  }

  std::string data_set(std::string_view syntax = kExplicitLittle) const {
    std::string all;
    for (const auto& [tag, element] : elements_) {
      all += encoded(tag, element, syntax);
    }
    return all;
  }

  /// The file: preamble, "DICM", file meta group and data set.
  std::string file(std::string_view syntax = kExplicitLittle) const {
    DicomBuilder meta;
    meta.set(0x00020010, "UI", std::string(syntax));
    return std::string(128, '\0') + "DICM" + meta.data_set() + data_set(syntax);
  }

  void write(const std::filesystem::path& path, std::string_view syntax = kExplicitLittle) const {
    std::filesystem::create_directories(path.parent_path());
    write_bytes(path, file(syntax));
  }

 private:
  struct Element {
    std::string type, value;
    std::vector<DicomBuilder> items;
    bool has_lengths = false;
  };

  static std::string number(std::uint32_t value, std::size_t bytes, bool big_endian) {
    std::string text(reinterpret_cast<const char*>(&value), bytes);
    if (big_endian) std::ranges::reverse(text);
    return text;
  }

  static std::string swapped(std::string value, const std::string& type) {
    const std::size_t bytes = type == "US" || type == "SS" || type == "OW" || type == "AT" ? 2
                              : type == "UL" || type == "OF"                               ? 4
                              : type == "FD" || type == "OD"                               ? 8
                                                                                           : 1;
    for (std::size_t i = 0; i + bytes <= value.size(); i += bytes) {
      std::reverse(value.begin() + static_cast<std::ptrdiff_t>(i),
                   value.begin() + static_cast<std::ptrdiff_t>(i + bytes));
    }
    return value;
  }

  static std::string encoded(std::uint32_t tag, const Element& element, std::string_view syntax) {
    const bool big = syntax == kExplicitBig, is_explicit = syntax != kImplicitLittle;
    std::string value = element.value;
    for (const DicomBuilder& item : element.items) {
      const std::string content = item.data_set(syntax);
      value += number(0xFFFE, 2, big) + number(0xE000, 2, big) +
               number(element.has_lengths ? static_cast<std::uint32_t>(content.size()) : 0xFFFFFFFF,
                      4, big) +
               content;
      if (!element.has_lengths)
        value += number(0xFFFE, 2, big) + number(0xE00D, 2, big) + number(0, 4, big);
    }
    const bool is_open = element.type == "SQ" && !element.has_lengths;
    if (is_open) value += number(0xFFFE, 2, big) + number(0xE0DD, 2, big) + number(0, 4, big);
    if (value.size() % 2 == 1) value += element.type == "UI" || element.type == "OB" ? '\0' : ' ';
    if (big) value = swapped(value, element.type);
    const auto length = is_open ? 0xFFFFFFFF : static_cast<std::uint32_t>(value.size());
    std::string all = number(tag >> 16U, 2, big) + number(tag & 0xFFFFU, 2, big);
    if (!is_explicit) return all + number(length, 4, big) + value;
    const bool is_long =
        std::string_view("OB OW OF OD SQ UN UT").find(element.type) != std::string_view::npos;
    all += element.type +
           (is_long ? std::string(2, '\0') + number(length, 4, big) : number(length, 2, big));
    return all + value;
  }

  std::map<std::uint32_t, Element> elements_;
};

inline constexpr std::size_t kColumns = 6, kRows = 4, kFrameSamples = kColumns * kRows;

/// The samples of one frame: all are `value` except the first, which marks the frame's corner.
inline std::vector<std::int16_t> frame_samples(std::int16_t value) {
  std::vector<std::int16_t> samples(kFrameSamples, value);
  samples[0] = static_cast<std::int16_t>(value + 1000);
  return samples;
}

/// An image of 6 x 4 signed 16-bit samples without a position.
inline DicomBuilder image_builder() {
  DicomBuilder image;
  image.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2").set(0x00080060, "CS", "CT");
  image.set(0x0020000E, "UI", "1.2.826.0.1.3680043.2.1125.7").set(0x00200011, "IS", "3");
  image.set_short(0x00280002, 1).set(0x00280004, "CS", "MONOCHROME2");
  image.set_short(0x00280010, kRows)
      .set_short(0x00280011, kColumns)
      .set_decimals(0x00280030, {0.75, 0.5});
  image.set_short(0x00280100, 16)
      .set_short(0x00280101, 16)
      .set_short(0x00280102, 15)
      .set_short(0x00280103, 1);
  return image;
}

/// One axial slice at height z.
inline DicomBuilder slice_builder(double z, std::int16_t value, int number = 1) {
  DicomBuilder slice = image_builder();
  slice.set(0x00080018, "UI", std::string("1.2.3.") + std::to_string(number))
      .set(0x00200013, "IS", std::to_string(number));
  slice.set_decimals(0x00200032, {-10, 20, z}).set_decimals(0x00200037, {1, 0, 0, 0, 1, 0});
  slice.set(0x7FE00010, "OW", bytes_of(frame_samples(value)));
  return slice;
}

/// Writes `count` slices from z = 5 on, at distance 2, with values 100, 200, ...; the order of the
/// file names is the reverse of the order of positions. `change` may edit each slice.
template <class Change>
void write_series(const std::filesystem::path& folder, int count, Change change) {
  for (int i = 0; i < count; ++i) {
    DicomBuilder slice = slice_builder(5 + 2.0 * i, static_cast<std::int16_t>(100 * i), i + 1);
    change(slice, i);
    slice.write(folder / (std::string("s") + std::to_string(count - 1 - i)));
  }
}

/// An enhanced CT: frames at the positions `places`; frame i has the value 100 i.
inline DicomBuilder enhanced_builder(const std::vector<double>& places) {
  DicomBuilder image = image_builder();
  image.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1")
      .set(0x00280008, "IS", std::to_string(places.size()));
  image.remove(0x00280030);
  DicomBuilder orientation, measures, shared;
  orientation.set_decimals(0x00200037, {1, 0, 0, 0, 1, 0});
  measures.set_decimals(0x00280030, {0.75, 0.5}).set_decimals(0x00180050, {9});
  shared.set_items(0x00209116, {orientation}).set_items(0x00289110, {measures});
  std::vector<DicomBuilder> frames;
  std::string samples;
  for (std::size_t i = 0; i < places.size(); ++i) {
    DicomBuilder position, frame;
    position.set_decimals(0x00200032, {-10, 20, places[i]});
    frames.push_back(frame.set_items(0x00209113, {position}));
    samples += bytes_of(frame_samples(static_cast<std::int16_t>(100 * i)));
  }
  return image.set_items(0x52009229, {shared})
      .set_items(0x52009230, std::move(frames))
      .set(0x7FE00010, "OW", samples);
}

/// The value of each slice of a volume, from its second sample.
inline std::vector<double> slice_values(const Volume& volume) {
  std::vector<double> values;
  const std::size_t slice = volume.view.grid.size[0] * volume.view.grid.size[1];
  for (std::size_t z = 0; z < volume.view.grid.size[2]; ++z) {
    const std::size_t i = z * slice + 1;
    switch (volume.view.type) {
      case SampleType::uint8:
        values.push_back(static_cast<const std::uint8_t*>(volume.view.samples)[i]);
        break;
      case SampleType::int8:
        values.push_back(static_cast<const std::int8_t*>(volume.view.samples)[i]);
        break;
      case SampleType::uint16:
        values.push_back(static_cast<const std::uint16_t*>(volume.view.samples)[i]);
        break;
      case SampleType::int16:
        values.push_back(static_cast<const std::int16_t*>(volume.view.samples)[i]);
        break;
      case SampleType::uint32:
        values.push_back(static_cast<const std::uint32_t*>(volume.view.samples)[i]);
        break;
      case SampleType::int32:
        values.push_back(static_cast<const std::int32_t*>(volume.view.samples)[i]);
        break;
      case SampleType::float32:
        values.push_back(static_cast<double>(static_cast<const float*>(volume.view.samples)[i]));
        break;
      default:
        values.push_back(static_cast<const double*>(volume.view.samples)[i]);
    }
  }
  return values;
}

}  // namespace isoatlas::detail::test
