// SPDX-License-Identifier: Apache-2.0
#include "volume_files/legacy_vtk_scanner.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/number_text.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

struct LegacyType {
  std::string_view name;
  VtkType type = {};
  bool is_string = false;
};

constexpr std::array kTypes{LegacyType{"bit", {SampleType::uint8, true}},
                            LegacyType{"char", {SampleType::int8}},
                            LegacyType{"signed_char", {SampleType::int8}},
                            LegacyType{"unsigned_char", {SampleType::uint8}},
                            LegacyType{"short", {SampleType::int16}},
                            LegacyType{"unsigned_short", {SampleType::uint16}},
                            LegacyType{"int", {SampleType::int32}},
                            LegacyType{"unsigned_int", {SampleType::uint32}},
                            LegacyType{"long", {SampleType::int64}},
                            LegacyType{"unsigned_long", {SampleType::uint64}},
                            LegacyType{"long_long", {SampleType::int64}},
                            LegacyType{"unsigned_long_long", {SampleType::uint64}},
                            LegacyType{"vtkidtype", {SampleType::int32}},  // VTK stores it as int
                            LegacyType{"vtktypeint64", {SampleType::int64}},
                            LegacyType{"vtktypeuint64", {SampleType::uint64}},
                            LegacyType{"float", {SampleType::float32}},
                            LegacyType{"double", {SampleType::float64}},
                            LegacyType{"string", {}, true},
                            LegacyType{"utf8_string", {}, true}};

constexpr std::array<std::string_view, 24> kKeywords{
    "dimensions", "extent",        "spacing",       "aspect_ratio",
    "origin",     "x_coordinates", "y_coordinates", "z_coordinates",
    "scalars",    "vectors",       "normals",       "tensors",
    "tensors6",   "global_ids",    "pedigree_ids",  "texture_coordinates",
    "edge_flags", "field",         "color_scalars", "lookup_table",
    "point_data", "cell_data",     "metadata",      "dataset"};

template <class Number>
std::optional<Number> parse(std::string_view word) {
  Number number{};
  return parse_number(word, number) ? std::optional(number) : std::nullopt;
}

template <class Number>
Number parsed(const fs::path& path, std::string_view word, const std::string& what) {
  const std::optional<Number> number = parse<Number>(word);
  if (!number) {
    throw bad_file(path, "has " + (word.empty() ? "nothing" : "'" + one_line(word, 40) + "'") +
                             ", expected " + what);
  }
  return *number;
}

}  // namespace

std::unique_ptr<VtkValues> open_values(const fs::path& path, bool is_text,
                                       const LegacyVtkArray& array) {
  if (is_text) {
    return text_values(path, FileText(path, array.begin, array.end), array.array.type,
                       array.is_colour_text);
  }
  return binary_values(path, file_bytes(path, array.begin, array.end), array.array.type, true);
}

std::string decoded_name(std::string_view name) {
  std::string decoded;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    const char* const digits = name.data() + i + 1;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      decoded += static_cast<char>(code);
      i += 2;
    } else {
      decoded += name[i];
    }
  }
  return decoded;
}

bool is_legacy_vtk_keyword(std::string_view word) {
  return std::ranges::find(kKeywords, word) != kKeywords.end();
}

LegacyVtkScanner::LegacyVtkScanner(const fs::path& path)
    : path_(path), text_(path), file_bytes_(readable_file_size(path)) {}

std::string LegacyVtkScanner::keyword() { return lower_case(text_.word()); }

std::uint64_t LegacyVtkScanner::count(const std::string& what) {
  return parsed<std::uint64_t>(path_, text_.word(), what);
}

std::int64_t LegacyVtkScanner::integer(const std::string& what) {
  return parsed<std::int64_t>(path_, text_.word(), what);
}

Vec3 LegacyVtkScanner::vector(const std::string& what) {
  const double x = parsed<double>(path_, text_.word(), what);
  const double y = parsed<double>(path_, text_.word(), what);
  return {x, y, parsed<double>(path_, text_.word(), what)};
}

std::uint64_t LegacyVtkScanner::count_in_line(const std::string& what, std::uint64_t otherwise) {
  const std::string word = one_line(text_.line());
  return word.empty()
             ? otherwise
             : parsed<std::uint64_t>(path_, std::string_view(word).substr(0, word.find(' ')), what);
}

void LegacyVtkScanner::skip_line_of(std::string_view keyword) {
  const std::uint64_t position = text_.position();
  if (lower_case(text_.word()) == keyword) {
    text_.line();
  } else {
    text_.seek(position);
  }
}

void LegacyVtkScanner::locate_values(LegacyVtkArray& array, const std::string& type_name,
                                     bool begins_in_next_line, bool is_followed_by_array) {
  const auto* const type = std::ranges::find(kTypes, type_name, &LegacyType::name);
  if (type == kTypes.end()) {
    throw bad_file(path_, "has values of an unknown type '" + one_line(type_name, 40) +
                              "', expected a type of VTK such as float");
  }
  array.array.type = type->type;
  array.is_string = type->is_string;
  const std::uint64_t components = array.array.components;
  if (components > 0 &&
      array.tuples >
          static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / 8 / components) {
    throw bad_file(path_, "the header states " + std::to_string(array.tuples) + " x " +
                              std::to_string(components) + " values, more than any file can hold");
  }
  const std::uint64_t values = array.tuples * components;
  if (begins_in_next_line && (!is_text_ || type->is_string)) {
    text_.line();
  }
  array.begin = text_.position();
  if (type->is_string) {
    skip_strings(values);
  } else if (is_text_) {
    skip_numbers(values);
  } else {
    // Windows stores a long in 4 bytes, other systems in 8, and the file does not state which.
    const bool is_long = type_name == "long" || type_name == "unsigned_long";
    if (is_long && !section_begins_at(array.begin + 8 * values, is_followed_by_array) &&
        section_begins_at(array.begin + 4 * values, is_followed_by_array)) {
      array.array.type.sample = type_name == "long" ? SampleType::int32 : SampleType::uint32;
    }
    const std::uint64_t bytes = array.array.type.stored_bytes(values);
    require_stored_bytes(path_, bytes, file_bytes_ - std::min(file_bytes_, array.begin));
    text_.seek(array.begin + bytes);
  }
  array.end = text_.position();
}

void LegacyVtkScanner::skip_numbers(std::uint64_t values) {
  for (std::uint64_t i = 0; i < values; ++i) {
    const std::string_view word = text_.word();
    if (word.empty() ||
        std::string_view("+-.0123456789nNiI").find(word[0]) == std::string_view::npos) {
      throw bad_file(path_, "is cut off or damaged: the header states " + std::to_string(values) +
                                " numbers, the file has " + std::to_string(i));
    }
  }
}

void LegacyVtkScanner::skip_strings(std::uint64_t values) {
  for (std::uint64_t i = 0; i < values; ++i) {
    if (text_.position() >= file_bytes_) {
      throw bad_file(path_, "is cut off: an array has " + std::to_string(i) +
                                " strings, expected " + std::to_string(values));
    }
    if (is_text_) {
      text_.line();
    } else {
      skip_binary_string();
    }
  }
}

// The first two bits give the number of bytes of the length: 3 is one, 2 is two, 1 is four, 0 is
// eight.
void LegacyVtkScanner::skip_binary_string() {
  const std::uint64_t position = text_.position();
  std::array<char, 8> bytes{};
  const std::size_t count =
      file_bytes(path_, position, file_bytes_)->read(bytes.data(), bytes.size());
  const std::size_t length_bytes = std::size_t{1}
                                   << (3U - (static_cast<unsigned char>(bytes[0]) >> 6U));
  std::uint64_t length = static_cast<unsigned char>(bytes[0]) & 0x3FU;
  for (std::size_t i = 1; i < length_bytes; ++i) {
    length = length << 8U | static_cast<unsigned char>(bytes[i]);
  }
  if (count < length_bytes || length > file_bytes_ - position - length_bytes) {
    throw bad_file(path_, "is cut off: a string of " + std::to_string(length) +
                              " bytes extends beyond the end of the file");
  }
  text_.seek(position + length_bytes + length);
}

bool LegacyVtkScanner::section_begins_at(std::uint64_t position, bool is_followed_by_array) {
  if (position > file_bytes_) {
    return false;
  }
  text_.seek(position);
  const std::string word = keyword();
  if (word.empty() || is_legacy_vtk_keyword(word)) {
    return true;
  }
  return is_followed_by_array && parse<std::uint64_t>(text_.word()) &&
         parse<std::uint64_t>(text_.word());
}

}  // namespace isoatlas::detail::io
