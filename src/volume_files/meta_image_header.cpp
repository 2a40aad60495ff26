// SPDX-License-Identifier: Apache-2.0
#include "volume_files/meta_image_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/header_text.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kLastField = "ElementDataFile";

// True if the text contains the last field. A list of files continues to the end of the file.
bool has_last_field(std::string_view text) {
  const std::size_t at = text.find(kLastField);
  const std::size_t end = at == text.npos ? text.npos : text.find('\n', at);
  return end != text.npos && text.substr(at, end - at).find("LIST") == text.npos;
}

Error wrong_meta_image_field(const fs::path& path, std::string_view name, std::string_view value,
                             const std::string& expected) {
  return bad_file(
      path, "its " + std::string(name) + " is '" + one_line(value, 80) + "', expected " + expected);
}

}  // namespace

std::string_view MetaImageHeader::field(std::string_view name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string_view() : found->second;
}

std::string_view MetaImageHeader::field(std::initializer_list<std::string_view> names) const {
  const auto* const found =
      std::ranges::find_if(names, [&](std::string_view name) { return !field(name).empty(); });
  return found == names.end() ? std::string_view() : field(*found);
}

bool MetaImageHeader::is_true(std::string_view name, bool if_missing) const {
  const std::string_view value = field(name);
  return value.empty() ? if_missing : value[0] == 'T' || value[0] == 't' || value[0] == '1';
}

MetaImageHeader read_meta_image_header(const fs::path& path) {
  const std::string text = header_text(path, has_last_field);
  MetaImageHeader header;
  header.is_gzipped = packing_of(path) == Packing::deflate;
  std::string_view rest = text;
  const auto next_line = [&] {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    return line;
  };
  while (!rest.empty() && !header.fields.contains(kLastField)) {
    const std::string_view line = next_line();
    if (const std::size_t separator = line.find_first_of("=:");
        separator != std::string_view::npos) {
      header.fields[std::string(trimmed(line.substr(0, separator)))] =
          trimmed(line.substr(separator + 1));
    }
  }
  if (header.field(kLastField).empty()) {
    throw bad_file(path, "has no ElementDataFile in its header");
  }
  header.bytes = text.size() - rest.size();
  while (header.field(kLastField).starts_with("LIST") && !rest.empty()) {
    if (const std::string_view name = trimmed(next_line()); !name.empty()) {
      header.listed_files.emplace_back(name);
    }
  }
  return header;
}

std::int64_t meta_integer(const fs::path& path, const MetaImageHeader& header,
                          std::string_view name, std::int64_t if_missing, std::int64_t least) {
  const std::string_view value = header.field(name);
  const std::optional<std::int64_t> number = value.empty() ? if_missing : integer_of(value);
  if (!number || *number < least) {
    throw wrong_meta_image_field(path, name, value,
                                 "a number of at least " + std::to_string(least));
  }
  return *number;
}

std::optional<std::vector<double>> meta_numbers(const fs::path& path, const MetaImageHeader& header,
                                                std::initializer_list<std::string_view> names,
                                                std::size_t count) {
  const std::string_view value = header.field(names);
  if (value.empty()) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (const std::string_view word : words_of(value)) {
    numbers.push_back(number_of(word).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  if (numbers.size() != count) {
    const auto* const name =
        std::ranges::find_if(names, [&](std::string_view n) { return !header.field(n).empty(); });
    throw wrong_meta_image_field(path, *name, value, std::to_string(count) + " numbers");
  }
  return numbers;
}

std::vector<std::size_t> meta_sizes(const fs::path& path, const MetaImageHeader& header) {
  constexpr std::int64_t kMostAxes = 10;
  const std::int64_t axes = meta_integer(path, header, "NDims", 0, 1);
  std::vector<std::size_t> sizes;
  for (const std::string_view word : words_of(header.field("DimSize"))) {
    const std::int64_t size = integer_of(word).value_or(0);
    if (size < 1) {
      throw wrong_meta_image_field(path, "DimSize", header.field("DimSize"),
                                   "numbers of at least 1");
    }
    sizes.push_back(static_cast<std::size_t>(size));
  }
  if (axes > kMostAxes || sizes.size() != static_cast<std::size_t>(axes)) {
    throw wrong_meta_image_field(path, "DimSize", header.field("DimSize"),
                                 axes > kMostAxes
                                     ? "at most " + std::to_string(kMostAxes) + " numbers"
                                     : std::to_string(axes) + " numbers, as NDims states");
  }
  return sizes;
}

SampleType meta_sample_type(const fs::path& path, const MetaImageHeader& header) {
  static constexpr std::array<std::pair<std::string_view, SampleType>, 13> kTypes{{
      {"MET_CHAR", SampleType::int8},
      {"MET_ASCII_CHAR", SampleType::int8},
      {"MET_UCHAR", SampleType::uint8},
      {"MET_SHORT", SampleType::int16},
      {"MET_USHORT", SampleType::uint16},
      {"MET_INT", SampleType::int32},
      {"MET_UINT", SampleType::uint32},
      {"MET_LONG", SampleType::int32},  // four bytes in MetaIO on every machine
      {"MET_ULONG", SampleType::uint32},
      {"MET_LONG_LONG", SampleType::int64},
      {"MET_ULONG_LONG", SampleType::uint64},
      {"MET_FLOAT", SampleType::float32},
      {"MET_DOUBLE", SampleType::float64},
  }};
  std::string_view type = header.field("ElementType");
  if (type.empty()) {
    throw bad_file(path, "is cut off or damaged: its header has no ElementType");
  }
  constexpr std::string_view kArray =
      "_ARRAY";  // the same sample type; ElementNumberOfChannels gives the number of values
  const std::string_view element =
      type.ends_with(kArray) ? type.substr(0, type.size() - kArray.size()) : type;
  const auto found =
      std::ranges::find(kTypes, element, &std::pair<std::string_view, SampleType>::first);
  if (found == kTypes.end()) {
    throw unsupported(path, "has samples of type '" + one_line(type, 40) +
                                "', expected integers of 8 to 64 bits, float or double");
  }
  return found->second;
}

}  // namespace isoatlas::detail::io
