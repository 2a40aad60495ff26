// SPDX-License-Identifier: Apache-2.0
// NumPy's .npy with a three-dimensional array a[z][y][x], the order of isoatlas' Python module.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "field/sample_type.h"
#include "files/file_error.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/header_fields.h"
#include "volume_files/readers.h"
#include "volume_files/stored_volumes.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kNpyMark = "\x93NUMPY";

struct NpyHeader {
  std::string descr = {};  ///< type of a sample, e.g. "<f4"
  bool is_fortran_order = false;
  std::vector<std::uint64_t> shape = {};
  std::size_t samples_offset = 0;
};

/// Reads the header, which is the literal of a Python dictionary. Never executes it.
class LiteralReader {
 public:
  LiteralReader(std::string_view text, const fs::path& path) : text_(text), path_(path) {}

  bool take(char c) {
    skip_blanks();
    if (text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  void require(char c) {
    if (!take(c)) refuse(std::string("expected '") + c + "'");
  }
  std::string string() {
    skip_blanks();
    const char quote = text_.empty() ? '\0' : text_.front();
    const std::size_t end =
        quote == '\'' || quote == '"' ? text_.find(quote, 1) : std::string_view::npos;
    if (end == std::string_view::npos) refuse("expected a string");
    std::string value(text_.substr(1, end - 1));
    text_.remove_prefix(end + 1);
    return value;
  }
  bool boolean() {
    skip_blanks();
    for (const std::string_view word : {"True", "False"}) {
      if (text_.starts_with(word)) {
        text_.remove_prefix(word.size());
        return word == "True";
      }
    }
    refuse("expected True or False");
  }
  std::vector<std::uint64_t> tuple() {
    require('(');
    std::vector<std::uint64_t> values;
    while (!take(')')) {
      skip_blanks();
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
      if (error != std::errc{}) refuse("expected sizes");
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      if (text_.starts_with('L')) text_.remove_prefix(1);  // Python 2
      values.push_back(value);
      if (!take(',')) {
        require(')');
        break;
      }
    }
    return values;
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw bad_file(path_,
                   "its header is damaged: " + what + " before '" + one_line(text_, 40) + "'");
  }

 private:
  void skip_blanks() {
    text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size()));
  }

  std::string_view text_;
  const fs::path& path_;
};

void parse_dictionary(std::string_view text, const fs::path& path, NpyHeader& header) {
  LiteralReader reader(text, path);
  bool has_descr = false, has_order = false, has_shape = false;
  reader.require('{');
  while (!reader.take('}')) {
    const std::string key = reader.string();
    reader.require(':');
    if (key == "descr") {
      if (reader.take('['))
        throw unsupported(
            path,
            "holds records of several values (a structured array), expected an array of numbers");
      header.descr = reader.string();
      has_descr = true;
    } else if (key == "fortran_order") {
      header.is_fortran_order = reader.boolean();
      has_order = true;
    } else if (key == "shape") {
      header.shape = reader.tuple();
      has_shape = true;
    } else {
      reader.refuse("unknown key '" + one_line(key, 40) + "'");
    }
    if (!reader.take(',')) {
      reader.require('}');
      break;
    }
  }
  if (!has_descr || !has_order || !has_shape)
    reader.refuse("expected descr, fortran_order and shape");
}

NpyHeader read_header(const fs::path& path) {
  constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20;
  const std::string bytes = unpacked_start(path, kMostHeaderBytes);
  if (!bytes.starts_with(kNpyMark) || bytes.size() < 12)
    throw bad_file(path, "is not a .npy file, or its header is cut off");
  const HeaderFields fields(bytes, std::endian::native == std::endian::big);
  const int version = bytes[6];
  if (version < 1 || version > 3) {
    throw unsupported(
        path, "has version " + std::to_string(version) + " of the .npy format, expected 1 to 3");
  }
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length =
      version == 1 ? fields.at<std::uint16_t>(8) : fields.at<std::uint32_t>(8);
  if (length > bytes.size() - start) {
    throw bad_file(path, "its header is cut off: it states " + std::to_string(length) +
                             " bytes and has " + std::to_string(bytes.size() - start));
  }
  NpyHeader header;
  header.samples_offset = start + length;
  parse_dictionary(std::string_view(bytes).substr(start, length), path, header);
  return header;
}

struct NpyType {
  SampleType type = SampleType::uint8;
  std::size_t bytes = 1;
  bool is_half = false;  ///< 16-bit floats, which are read as float32
};

NpyType npy_type(const std::string& descr, const fs::path& path) {
  struct Known {
    std::string_view code;
    NpyType stored;
  };
  constexpr std::array kKnown{
      Known{"b1", {SampleType::uint8, 1}},   Known{"u1", {SampleType::uint8, 1}},
      Known{"i1", {SampleType::int8, 1}},    Known{"u2", {SampleType::uint16, 2}},
      Known{"i2", {SampleType::int16, 2}},   Known{"u4", {SampleType::uint32, 4}},
      Known{"i4", {SampleType::int32, 4}},   Known{"u8", {SampleType::uint64, 8}},
      Known{"i8", {SampleType::int64, 8}},   Known{"f2", {SampleType::float32, 2, true}},
      Known{"f4", {SampleType::float32, 4}}, Known{"f8", {SampleType::float64, 8}}};
  const bool has_order =
      !descr.empty() && std::string_view("<>=|").find(descr[0]) != std::string_view::npos;
  const std::string code = descr.substr(has_order ? 1 : 0);
  for (const Known& known : kKnown) {
    if (known.code == code) return known.stored;
  }
  std::string kind = "an unknown type";
  if (code.starts_with('O')) kind = "Python objects, which are never unpickled";
  if (code.starts_with('c')) kind = "complex numbers";
  if (code.starts_with('f')) kind = "extended floating-point numbers";
  if (code.starts_with('S') || code.starts_with('U') || code.starts_with('a')) kind = "text";
  if (code.starts_with('V')) kind = "records";
  if (code.starts_with('m') || code.starts_with('M')) kind = "times";
  throw unsupported(path, "holds " + kind + " ('" + one_line(descr, 40) +
                              "'), expected integers of 8 to 64 bits, booleans or floats");
}

std::string text_of(const std::vector<std::uint64_t>& shape) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(shape.size(), 8); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return "(" + text + (shape.size() == 1 ? "," : shape.size() > 8 ? ", ..." : "") + ")";
}

/// The sizes along x, y and z: the last three axes of the array, in reverse order. If there are
/// more than three axes, those of size 1 are dropped.
std::array<std::size_t, 3> size_of(const std::vector<std::uint64_t>& shape, const fs::path& path) {
  std::vector<std::uint64_t> axes = shape;
  if (axes.size() > 3) std::erase(axes, 1U);
  if (axes.size() != 3) {
    throw unsupported(
        path, "holds an array of shape " + text_of(shape) + ", expected three axes (z, y, x)" +
                  (axes.size() > 3 ? "; save one of its volumes to its own file" : ""));
  }
  return {axes[2], axes[1], axes[0]};
}

using Size = std::array<std::size_t, 3>;

/// Transposes samples in blocks that fit into the cache. In `from`, z is fastest and x has `count`
/// indices; `to` is the whole volume, x fastest, from the first of these x on.
template <class Stored, class Sample, class Convert>
void reverse_axes(const Stored* from, std::size_t count, Sample* to, const Size& size,
                  Convert convert) {
  constexpr std::size_t kBlock = 32;
  const auto [nx, ny, nz] = size;
  for (std::size_t y = 0; y < ny; ++y) {
    for (std::size_t first_z = 0; first_z < nz; first_z += kBlock) {
      for (std::size_t first_x = 0; first_x < count; first_x += kBlock) {
        for (std::size_t z = first_z; z < std::min(first_z + kBlock, nz); ++z) {
          for (std::size_t x = first_x; x < std::min(first_x + kBlock, count); ++x) {
            to[x + nx * (y + ny * z)] = convert(from[z + nz * (y + ny * x)]);
          }
        }
      }
    }
  }
}

/// Reads samples in Fortran order, in which the first axis, z, is fastest. Only some planes of
/// equal x are in memory twice.
template <class Stored, class Sample, class Convert>
void read_reversed(ByteSource& stream, const StoredVolumes& stored, bool swap, Sample* samples,
                   const Size& size, Convert convert) {
  constexpr std::size_t kBufferBytes = std::size_t{1} << 24;
  const std::size_t plane = size[1] * size[2];
  const std::size_t most =
      std::clamp<std::size_t>(kBufferBytes / (plane * sizeof(Stored)), 1, size[0]);
  std::vector<Stored> values(most * plane);
  for (std::size_t x = 0; x < size[0]; x += most) {
    const std::size_t count = std::min(most, size[0] - x);
    const std::size_t wanted = count * plane * sizeof(Stored);
    const std::size_t found = stream.read(values.data(), wanted);
    if (found < wanted)
      require_stored_bytes(stored.file, stored.volume_bytes, x * plane * sizeof(Stored) + found);
    if (swap) swap_byte_order(values.data(), count * plane, sizeof(Stored));
    reverse_axes(values.data(), count, samples + x, size, convert);
  }
}

void read_fortran_samples(const StoredVolumes& stored, bool is_half, bool swap, VolumeFile& file,
                          const ReadOptions& options) {
  const Size size = file.volume.view.grid.size;
  read_stored_volume(stored, 0, file, options, [&](ByteSource& stream, std::byte* samples) {
    if (is_half) {
      return read_reversed<std::uint16_t>(stream, stored, swap, reinterpret_cast<float*>(samples),
                                          size, float_of_half);
    }
    visit_sample_type(file.volume.view.type, [&](auto* null) {
      using Sample = std::remove_cvref_t<decltype(*null)>;
      read_reversed<Sample>(stream, stored, swap, reinterpret_cast<Sample*>(samples), size,
                            std::identity());
    });
  });
  file.source.decisions.push_back({"order", "Fortran, transposed to (z, y, x)"});
}

}  // namespace

VolumeFile read_npy(const fs::path& path, const ReadOptions& options) {
  const NpyHeader header = read_header(path);
  const NpyType type = npy_type(header.descr, path);
  const bool is_big_endian = header.descr[0] == '>';
  const bool swap = (header.descr[0] == '<' || is_big_endian) &&
                    is_big_endian != (std::endian::native == std::endian::big);

  VolumeFile file;
  Volume& volume = file.volume;
  file.source.format = "NumPy array";
  file.source.has_spacing = false;
  volume.view.grid.size = size_of(header.shape, path);
  volume.view.type = type.type;
  const StoredVolumes stored{
      .file = path,
      .offset = header.samples_offset,
      .volume_bytes = checked_sample_bytes(path, volume.view.grid.size, type.bytes)};
  require_stored_volumes(stored, file.source);
  if (header.is_fortran_order) {
    read_fortran_samples(stored, type.is_half, swap, file, options);
  } else if (type.is_half) {
    read_half_samples(stored, 0, swap, file, options);
  } else {
    read_plain_samples(stored, 0, swap, file, options);
  }
  return file;
}

}  // namespace isoatlas::detail::io
