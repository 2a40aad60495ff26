// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>

#include "core/vector_math.h"
#include "field/sample_type.h"
#include "files/file_error.h"
#include "volume_files/stored_volumes.h"
#include "volume_files/zarr_array.h"
#include "volume_files/zarr_json.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr std::size_t kMostZarrAxes = 8;

// Types by the name in version 3 and the code in version 2, which begins with the byte order.
struct ZarrType {
  std::string_view name, code;
  SampleType type;
  std::size_t bytes;
};
constexpr std::array<ZarrType, 12> kZarrTypes{{{"bool", "b1", SampleType::uint8, 1},
                                               {"int8", "i1", SampleType::int8, 1},
                                               {"uint8", "u1", SampleType::uint8, 1},
                                               {"int16", "i2", SampleType::int16, 2},
                                               {"uint16", "u2", SampleType::uint16, 2},
                                               {"int32", "i4", SampleType::int32, 4},
                                               {"uint32", "u4", SampleType::uint32, 4},
                                               {"int64", "i8", SampleType::int64, 8},
                                               {"uint64", "u8", SampleType::uint64, 8},
                                               {"float16", "f2", SampleType::float32, 2},
                                               {"float32", "f4", SampleType::float32, 4},
                                               {"float64", "f8", SampleType::float64, 8}}};

class ZarrMetadataReader {
 public:
  explicit ZarrMetadataReader(const fs::path& folder) {
    array_.folder = folder;
    json_ = zarr_json(folder, "zarr.json");
    array_.version = json_.is_object() ? 3 : 2;
    path_ = folder / (array_.version == 3 ? "zarr.json" : ".zarray");
    if (array_.version == 2) json_ = zarr_json(folder, ".zarray");
    if (!json_.is_object()) throw bad_file(folder, "is no array of Zarr: it has no .zarray");
  }

  ZarrArray read() {
    array_.size = counts_at(json_, "shape", path_);
    if (array_.size.empty() || array_.size.size() > kMostZarrAxes)
      throw unsupported(path_, "has " + std::to_string(array_.size.size()) +
                                   " axes, expected 3 to " + std::to_string(kMostZarrAxes));
    if (array_.version == 2) {
      read_version_2();
    } else {
      read_version_3();
    }
    check_chunk(array_.chunk, array_.size.size());
    read_fill_value();
    return std::move(array_);
  }

 private:
  void set_type(const ZarrType& type) {
    array_.type = type.type;
    array_.value_bytes = type.bytes;
    array_.is_half = type.name == "float16";
  }

  ZarrCodec codec(const std::string& name) const {
    ZarrCodec out{};
    if (!zarr_codec_named(name, out))
      throw unsupported(path_, "has chunks with the codec '" + one_line(name, 40) +
                                   "', expected none, blosc, zstd, gzip, zlib, lz4, bz2 or crc32c");
    return out;
  }

  void read_version_2() {
    const std::string dtype = text_at(json_, "dtype");
    const auto* const type = std::ranges::find_if(kZarrTypes, [&](const ZarrType& known) {
      return dtype.size() == 3 && dtype.substr(1) == known.code;
    });
    if (type == kZarrTypes.end())
      throw unsupported(path_, "has values of type " +
                                   one_line(json_.value("dtype", Json()).dump()) +
                                   ", expected integers or floating-point numbers");
    set_type(*type);
    const auto size = array_.size.size();
    ZarrChunk& chunk = array_.chunk;
    chunk.is_big_endian = dtype[0] == '>';
    chunk.size = counts_at(json_, "chunks", path_);
    chunk.order.resize(size);
    std::iota(chunk.order.begin(), chunk.order.end(), std::size_t{0});
    if (text_at(json_, "order") == "F") std::ranges::reverse(chunk.order);
    if (const Json filters = json_.value("filters", Json()); filters.is_array() && !filters.empty())
      throw unsupported(path_, "has filters, expected none");
    if (const Json compressor = json_.value("compressor", Json()); !compressor.is_null())
      chunk.codecs.push_back(codec(text_at(compressor, "id")));
    array_.separator = text_at(json_, "dimension_separator") == "/" ? '/' : '.';
    const Json names = zarr_attributes(array_.folder).value("_ARRAY_DIMENSIONS", Json());
    read_names(names);
  }

  void read_names(const Json& names) {
    if (!names.is_array() || names.size() != array_.size.size()) return;
    for (const Json& name : names)
      array_.axis_names.push_back(name.is_string() ? name.get<std::string>() : "");
  }

  void read_version_3() {
    if (text_at(json_, "node_type") != "array")
      throw bad_file(path_, "describes no array, expected node_type 'array'");
    const std::string name = text_at(json_, "data_type");
    const auto* const type = std::ranges::find(kZarrTypes, name, &ZarrType::name);
    if (type == kZarrTypes.end())
      throw unsupported(path_, "has values of type " +
                                   one_line(json_.value("data_type", Json()).dump()) +
                                   ", expected integers or floating-point numbers");
    set_type(*type);
    const Json grid = json_.value("chunk_grid", Json());
    if (text_at(grid, "name") != "regular")
      throw unsupported(path_, "has a grid of chunks that is not regular");
    array_.chunk.size = counts_at(configuration(grid), "chunk_shape", path_);
    const Json keys = json_.value("chunk_key_encoding", Json());
    array_.has_prefix = text_at(keys, "name") != "v2";
    const std::string separator = text_at(configuration(keys), "separator");
    array_.separator = separator.empty() ? (array_.has_prefix ? '/' : '.') : separator[0];
    if (array_.separator != '/' && array_.separator != '.')
      throw unsupported(path_, "separates the numbers of chunks by neither '/' nor '.'");
    const Json codecs = json_.value("codecs", Json());
    if (const Json sharding = sharding_codec(codecs); sharding.is_object()) {
      read_sharding(configuration(sharding));
    } else {
      read_codecs(codecs, array_.chunk);
    }
    read_names(json_.value("dimension_names", Json()));
  }

  static Json configuration(const Json& named) {
    return named.is_object() ? named.value("configuration", Json::object()) : Json::object();
  }

  static Json sharding_codec(const Json& codecs) {
    if (!codecs.is_array() || codecs.empty()) return nullptr;
    return text_at(codecs[0], "name") == "sharding_indexed" ? codecs[0] : Json();
  }

  void read_sharding(const Json& sharding) {
    ZarrArray::Sharding& out = array_.sharding.emplace();
    out.chunk.size = counts_at(sharding, "chunk_shape", path_);
    read_codecs(sharding.value("codecs", Json()), out.chunk);
    check_chunk(out.chunk, array_.size.size());
    for (std::size_t a = 0; a < std::min(out.chunk.size.size(), array_.chunk.size.size()); ++a) {
      if (array_.chunk.size[a] % out.chunk.size[a] != 0)
        throw bad_file(path_, "has chunks that do not fill their shard");
    }
    ZarrChunk index;
    index.size.resize(array_.size.size());
    read_codecs(sharding.value("index_codecs", Json()), index);
    if (std::ranges::any_of(index.codecs, [](ZarrCodec c) { return c != ZarrCodec::crc32c; }))
      throw unsupported(path_, "has compressed indices of shards, expected them as they are");
    out.index_codecs = index.codecs;
    out.is_index_big_endian = index.is_big_endian;
    out.is_index_first = text_at(sharding, "index_location") == "start";
  }

  // Of version 3: transpositions, then how values become bytes, then codecs of bytes.
  void read_codecs(const Json& codecs, ZarrChunk& chunk) const {
    chunk.order.resize(array_.size.size());
    std::iota(chunk.order.begin(), chunk.order.end(), std::size_t{0});
    for (const Json& entry : codecs.is_array() ? codecs : Json::array()) {
      const std::string name =
          entry.is_string() ? entry.get<std::string>() : text_at(entry, "name");
      if (name == "bytes") {
        chunk.is_big_endian = text_at(configuration(entry), "endian") == "big";
      } else if (name == "transpose") {
        chunk.order = transposed(chunk.order, configuration(entry));
      } else {
        chunk.codecs.push_back(codec(name));
      }
    }
  }

  std::vector<std::size_t> transposed(const std::vector<std::size_t>& order,
                                      const Json& configuration) const {
    const std::vector<std::uint64_t> by = counts_at(configuration, "order", path_);
    std::vector<std::size_t> out;
    for (const std::uint64_t axis : by) {
      if (axis < order.size()) out.push_back(order[axis]);
    }
    std::vector<std::size_t> sorted = out;
    std::ranges::sort(sorted);
    for (std::size_t a = 0; a < order.size(); ++a) {
      if (sorted.size() != order.size() || sorted[a] != a)
        throw bad_file(path_, "has a transposition that is no permutation of the axes");
    }
    return out;
  }

  void check_chunk(const ZarrChunk& chunk, std::size_t axes) const {
    std::uint64_t count = array_.value_bytes;
    for (const std::uint64_t n : chunk.size) {
      if (n == 0 || count > std::numeric_limits<std::int64_t>::max() / n)
        throw bad_file(path_, "has chunks whose size is 0 or overflows");
      count *= n;
    }
    if (chunk.size.size() != axes)
      throw bad_file(path_, "has chunks of " + std::to_string(chunk.size.size()) + " axes, but " +
                                std::to_string(axes) + " axes itself");
  }

  template <class Sample>
  static Sample integer_of(double value) {
    using Limits = std::numeric_limits<Sample>;
    const bool fits = value > static_cast<double>(Limits::lowest()) - 1 &&
                      value < static_cast<double>(Limits::max());
    return fits ? static_cast<Sample>(value) : Sample{};
  }

  // "NaN", "Infinity", "-Infinity", or the bits of a number as "0x7fc00000".
  double special_number(const std::string& text) const {
    const bool is_integer =
        array_.type != SampleType::float32 && array_.type != SampleType::float64;
    if (text == "Infinity" && !is_integer) return INFINITY;
    if (text == "-Infinity" && !is_integer) return -INFINITY;
    if (text == "NaN" && !is_integer) return NAN;
    std::uint64_t bits = 0;
    const char* const end = text.data() + text.size();
    if (is_integer || text.size() != 2 + 2 * array_.value_bytes || !text.starts_with("0x") ||
        std::from_chars(text.data() + 2, end, bits, 16).ptr != end)
      throw unsupported(path_,
                        "has the fill value '" + one_line(text, 40) + "', expected a number");
    if (array_.is_half) return float_of_half(static_cast<std::uint16_t>(bits));
    return array_.value_bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                                   : std::bit_cast<double>(bits);
  }

  // A number, one that JSON does not have, as text, or null, which leaves the value undefined.
  void read_fill_value() {
    const Json value = json_.value("fill_value", Json());
    visit_sample_type(array_.type, [&](auto* null) {
      using Sample = std::remove_cvref_t<decltype(*null)>;
      Sample sample{};
      if (value.is_number_float() && std::numeric_limits<Sample>::is_integer) {
        sample = integer_of<Sample>(value.get<double>());
      } else if (value.is_number()) {
        sample = value.get<Sample>();
      } else if (value.is_boolean()) {
        sample = static_cast<Sample>(value.get<bool>());
      } else if (value.is_string()) {
        sample = static_cast<Sample>(special_number(value.get<std::string>()));
      }
      array_.fill_value.assign(reinterpret_cast<const char*>(&sample), sizeof sample);
    });
  }

  Json json_;
  fs::path path_;
  ZarrArray array_;
};

bool has_file(const fs::path& folder, const char* name) {
  std::error_code error;
  return fs::is_regular_file(folder / name, error);
}

}  // namespace

bool is_zarr(const fs::path& folder) {
  return has_file(folder, "zarr.json") || has_file(folder, ".zarray") ||
         has_file(folder, ".zgroup") || has_file(folder, ".zattrs");
}

bool is_zarr_array(const fs::path& folder) {
  if (has_file(folder, ".zarray")) return true;
  return has_file(folder, "zarr.json") &&
         text_at(zarr_json(folder, "zarr.json"), "node_type") == "array";
}

ZarrArray read_zarr_metadata(const fs::path& folder) { return ZarrMetadataReader(folder).read(); }

}  // namespace isoatlas::detail::io
