// SPDX-License-Identifier: Apache-2.0
#include "volume_files/nrrd_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/file_name.h"
#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/header_text.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostAxes = 16;

constexpr std::string_view kFields =
    "content number type blocksize dimension space spacedimension sizes spacings thicknesses "
    "axismins axismaxs spacedirections "
    "centerings kinds labels units min max oldmin oldmax endian encoding lineskip byteskip "
    "sampleunits spaceunits spaceorigin "
    "measurementframe datafile";

bool is_in(std::string_view list, std::string_view word) {
  const std::vector<std::string_view> words = words_of(list);
  return std::ranges::find(words, word) != words.end();
}

// The text in lower case, without blanks and other characters in `left_out`.
std::string squeezed(std::string_view text, std::string_view left_out = " \t") {
  std::string word = lower_case(text);
  std::erase_if(word, [&](char c) { return left_out.find(c) != std::string_view::npos; });
  return word;
}

std::string field_name(std::string_view text) {
  const std::string name = squeezed(text);
  return name == "centers" ? "centerings" : name;
}

std::string unescaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape =
        text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\');
    result += is_escape ? (text[++i] == 'n' ? '\n' : '\\') : text[i];
  }
  return result;
}

// A blank line ends the header, with any kind of line ends.
bool has_blank_line(std::string_view text) {
  return text.find("\n\n") != text.npos || text.find("\n\r\n") != text.npos;
}

/// Reads a line "name: value" or "key:=value".
void read_line(NrrdHeader& header, const fs::path& path, std::string_view line) {
  const std::size_t colon = line.find(':');
  const bool is_pair = line.substr(std::min(colon, line.size())).starts_with(":=");
  const std::string name = field_name(line.substr(0, colon));
  if (colon != std::string_view::npos && !is_pair && is_in(kFields, name)) {
    const std::string value(trimmed(line.substr(colon + 1)));
    const auto [field, is_new] = header.fields.emplace(name, value);
    if (!is_new && field->second != value) {
      throw bad_file(path, "its header has two fields '" + one_line(line.substr(0, colon), 40) +
                               "': " + one_line(field->second, 80) + ", and " +
                               one_line(value, 80));
    }
    return;
  }
  if (const std::size_t separator = line.find(":="); separator != std::string_view::npos) {
    header.key_values[unescaped(line.substr(0, separator))] = unescaped(line.substr(separator + 2));
  } else if (colon != std::string_view::npos) {
    header.unknown_fields.push_back(one_line(line.substr(0, colon), 40));
  } else {
    throw bad_file(path, "its header has the line '" + one_line(line, 40) +
                             "', expected 'field: value' or 'key:=value'");
  }
}

std::optional<std::vector<double>> nrrd_numbers(std::string_view text,
                                                std::string_view separators = " \t") {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text, separators)) {
    const std::optional<double> number = number_of(word);
    if (!number) {
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

Error wrong_nrrd_field(const fs::path& path, std::string_view name, std::string_view value,
                       const std::string& expected) {
  return bad_file(path, "its header field '" + std::string(name) + "' is '" + one_line(value, 80) +
                            "', expected " + expected);
}

// Reads one number for each axis; all are NaN if the field is missing.
std::vector<double> axis_numbers(const NrrdHeader& header, const fs::path& path,
                                 std::string_view name, std::size_t axes) {
  if (header.field(name).empty()) {
    return std::vector<double>(axes, std::numeric_limits<double>::quiet_NaN());
  }
  const auto numbers = nrrd_numbers(header.field(name));
  if (!numbers || numbers->size() != axes) {
    throw wrong_nrrd_field(path, name, header.field(name),
                           std::to_string(axes) + " numbers, one for each axis");
  }
  return *numbers;
}

// Reads one word for each axis, in lower case; empty for an axis without one.
std::vector<std::string> axis_words(const NrrdHeader& header, const fs::path& path,
                                    std::string_view name, std::size_t axes) {
  std::vector<std::string> words;
  for (const std::string_view word : words_of(header.field(name))) {
    const std::string lower = lower_case(word);
    words.push_back(lower == "none" || lower == "???" ? "" : lower);
  }
  if (!words.empty() && words.size() != axes) {
    throw wrong_nrrd_field(path, name, header.field(name),
                           std::to_string(axes) + " words, one for each axis");
  }
  words.resize(axes);
  return words;
}

// The strings between quotation marks. If there are fewer than expected, they are ignored: they are
// for display only.
std::vector<std::string> quoted_strings(std::string_view text) {
  std::vector<std::string> strings;
  for (std::size_t i = text.find('"'); i < text.size(); i = text.find('"', i + 1)) {
    std::string& string = strings.emplace_back();
    for (++i; i < text.size() && text[i] != '"'; ++i) {
      i += text[i] == '\\' && text.substr(i + 1).starts_with('"') ? 1 : 0;
      string += text[i];
    }
  }
  return strings;
}

// Reads "(1,0,0) none (0,0,2)": for each axis a vector of `dimension` numbers, or "none".
std::vector<std::vector<double>> vectors_of(const fs::path& path, std::string_view name,
                                            std::string_view text, std::size_t dimension) {
  const Error wrong = wrong_nrrd_field(
      path, name, text,
      "vectors of " + std::to_string(dimension) + " numbers like (0.5,0,0), or none");
  std::vector<std::vector<double>> vectors;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    if (lower_case(text.substr(0, 4)) == "none") {
      vectors.emplace_back();
      text.remove_prefix(4);
      continue;
    }
    const std::size_t end = text.find(')');
    if (!text.starts_with('(') || end == std::string_view::npos) {
      throw wrong;
    }
    std::optional<std::vector<double>> vector = nrrd_numbers(text.substr(1, end - 1), ", \t");
    if (!vector || vector->size() != dimension) {
      throw wrong;
    }
    const auto missing = static_cast<std::size_t>(
        std::ranges::count_if(*vector, [](double x) { return std::isnan(x); }));
    if (missing != 0 && missing != dimension) {
      throw wrong;
    }
    vectors.push_back(missing == 0 ? *vector : std::vector<double>());
    text.remove_prefix(end + 1);
  }
  return vectors;
}

std::vector<std::size_t> axis_sizes(const NrrdHeader& header, const fs::path& path) {
  const std::string_view dimension = required_field(header, path, "dimension");
  const std::int64_t axes = integer_of(dimension).value_or(0);
  if (axes < 1 || axes > static_cast<std::int64_t>(kMostAxes)) {
    throw wrong_nrrd_field(path, "dimension", dimension, "1 to " + std::to_string(kMostAxes));
  }
  std::vector<std::size_t> sizes;
  for (const std::string_view word : words_of(required_field(header, path, "sizes"))) {
    const std::int64_t size = integer_of(word).value_or(0);
    if (size < 1) {
      throw wrong_nrrd_field(path, "sizes", header.field("sizes"), "numbers of at least 1");
    }
    sizes.push_back(static_cast<std::size_t>(size));
  }
  if (sizes.size() != static_cast<std::size_t>(axes)) {
    throw wrong_nrrd_field(path, "sizes", header.field("sizes"),
                           std::to_string(axes) + " numbers, one for each axis");
  }
  return sizes;
}

}  // namespace

std::string_view NrrdHeader::field(std::string_view name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string_view() : found->second;
}

NrrdHeader read_nrrd_header(const fs::path& path) {
  const std::string text = header_text(path, has_blank_line);
  if (!text.starts_with("NRRD")) {
    throw bad_file(path, "is not a NRRD file: it does not begin with NRRD");
  }
  NrrdHeader header;
  header.is_gzipped = packing_of(path) == Packing::deflate;
  std::string_view rest = text;
  bool is_list = false;
  for (bool is_first = true; !rest.empty(); is_first = false) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    line = line.substr(0, line.size() - (line.ends_with('\r') ? 1 : 0));
    if (line.empty()) {
      break;  // end of the header: the samples follow
    }
    if (is_list) {
      header.listed_files.emplace_back(trimmed(line));
    } else if (!is_first && !line.starts_with('#')) {
      read_line(header, path, line);
      is_list = header.field("datafile").starts_with("LIST");
    }
  }
  header.bytes = text.size() - rest.size();
  return header;
}

std::string_view required_field(const NrrdHeader& header, const fs::path& path,
                                std::string_view name) {
  const std::string_view value = header.field(name);
  if (value.empty()) {
    throw bad_file(path,
                   "is cut off or damaged: its header has no field '" + std::string(name) + "'");
  }
  return value;
}

std::vector<NrrdAxis> nrrd_axes(const NrrdHeader& header, const fs::path& path) {
  const std::vector<std::size_t> sizes = axis_sizes(header, path);
  const std::size_t count = sizes.size();
  const std::vector<std::string> kinds = axis_words(header, path, "kinds", count);
  const std::vector<std::string> centerings = axis_words(header, path, "centerings", count);
  const std::vector<double> spacings = axis_numbers(header, path, "spacings", count);
  const std::vector<double> minima = axis_numbers(header, path, "axismins", count);
  const std::vector<double> maxima = axis_numbers(header, path, "axismaxs", count);
  std::vector<std::string> units = quoted_strings(header.field("units"));
  units.resize(count);
  std::vector<std::vector<double>> directions =
      vectors_of(path, "space directions", header.field("spacedirections"),
                 nrrd_space(header, path).dimension);
  if (!directions.empty() && directions.size() != count) {
    throw wrong_nrrd_field(path, "space directions", header.field("spacedirections"),
                           std::to_string(count) + " vectors, one for each axis");
  }
  directions.resize(count);
  std::vector<NrrdAxis> axes;
  for (std::size_t i = 0; i < count; ++i) {
    axes.push_back({sizes[i], kinds[i], centerings[i], spacings[i], minima[i], maxima[i], units[i],
                    directions[i]});
  }
  return axes;
}

NrrdSpace nrrd_space(const NrrdHeader& header, const fs::path& path) {
  NrrdSpace space;
  space.name = header.field("space");
  if (!space.name.empty()) {
    space.dimension = nrrd_space_named(path, space.name).dimension;
  }
  if (const std::string_view dimension = header.field("spacedimension"); !dimension.empty()) {
    const std::int64_t stated = integer_of(dimension).value_or(0);
    if (stated < 1 || stated > 8 ||
        (space.dimension != 0 && space.dimension != static_cast<std::size_t>(stated))) {
      throw wrong_nrrd_field(
          path, "space dimension", dimension,
          space.name.empty() ? "1 to 8" : std::to_string(space.dimension) + " for this space");
    }
    space.dimension = static_cast<std::size_t>(stated);
  }
  const std::vector<std::vector<double>> origin =
      vectors_of(path, "space origin", header.field("spaceorigin"), space.dimension);
  if (origin.size() > 1) {
    throw wrong_nrrd_field(path, "space origin", header.field("spaceorigin"), "one vector");
  }
  space.origin = origin.empty() ? std::vector<double>() : origin.front();
  space.units = quoted_strings(header.field("spaceunits"));
  return space;
}

SampleType nrrd_sample_type(const NrrdHeader& header, const fs::path& path) {
  static constexpr std::array<std::pair<SampleType, std::string_view>, 10> kTypes{{
      {SampleType::int8, "signedchar int8 int8_t"},
      {SampleType::uint8, "uchar unsignedchar uint8 uint8_t"},
      {SampleType::int16, "short shortint signedshort signedshortint int16 int16_t"},
      {SampleType::uint16, "ushort unsignedshort unsignedshortint uint16 uint16_t"},
      {SampleType::int32, "int signedint int32 int32_t"},
      {SampleType::uint32, "uint unsignedint uint32 uint32_t"},
      {SampleType::int64, "longlong longlongint signedlonglong signedlonglongint int64 int64_t"},
      {SampleType::uint64, "ulonglong unsignedlonglong unsignedlonglongint uint64 uint64_t"},
      {SampleType::float32, "float"},
      {SampleType::float64, "double"},
  }};
  const std::string_view type = required_field(header, path, "type");
  const auto found = std::ranges::find_if(
      kTypes, [&](const auto& entry) { return is_in(entry.second, squeezed(type)); });
  if (found == kTypes.end()) {
    throw unsupported(path, "has samples of type '" + one_line(type, 40) +
                                "', expected integers of 8 to 64 bits, float or double");
  }
  return found->first;
}

const NrrdSpaceName& nrrd_space_named(const fs::path& path, std::string_view name) {
  static constexpr std::array<NrrdSpaceName, 12> kSpaces{{
      {"rightanteriorsuperior ras", 3, NrrdWorld::body, -1, -1},
      {"leftanteriorsuperior las", 3, NrrdWorld::body, 1, -1},
      {"leftposteriorsuperior lps", 3, NrrdWorld::body, 1, 1},
      {"rightanteriorsuperiortime rast", 4, NrrdWorld::body, -1, -1},
      {"leftanteriorsuperiortime last", 4, NrrdWorld::body, 1, -1},
      {"leftposteriorsuperiortime lpst", 4, NrrdWorld::body, 1, 1},
      {"scannerxyz", 3, NrrdWorld::scanner, 1, 1},
      {"scannerxyztime scannerxyzt", 4, NrrdWorld::scanner, 1, 1},
      {"3drighthanded", 3, NrrdWorld::right_handed, 1, 1},
      {"3dlefthanded", 3, NrrdWorld::left_handed, 1, 1},
      {"3drighthandedtime", 4, NrrdWorld::right_handed, 1, 1},
      {"3dlefthandedtime", 4, NrrdWorld::left_handed, 1, 1},
  }};
  const std::string word = squeezed(name, " \t-");
  const auto found = std::ranges::find_if(
      kSpaces, [&](const NrrdSpaceName& space) { return is_in(space.spellings, word); });
  if (found == kSpaces.end()) {
    throw unsupported(path, "lies in a space called '" + one_line(name, 40) +
                                "', expected one that NRRD knows, e.g. left-posterior-superior");
  }
  return *found;
}

}  // namespace isoatlas::detail::io
