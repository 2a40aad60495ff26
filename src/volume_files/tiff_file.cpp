// SPDX-License-Identifier: Apache-2.0
// ITK is not used: for a stack that is cut off it returns the remaining pages, and for pages of
// different sizes it returns wrong samples, both without an error.
#include "volume_files/tiff_file.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::string first_tiff_error, first_tiff_warning;  // guarded by the lock in LibraryMessages

void keep_first(std::string& kept, const char* format, va_list arguments) {
  if (kept.empty()) {
    std::array<char, 300> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    kept = text[0] == '\0' ? "unknown error" : text.data();
  }
}

void keep_first_error(const char* /*module*/, const char* format, va_list arguments) {
  std::string error;
  keep_first(error, format, arguments);
  // Ignores tifffile's values 4 and 5 (millimetre and micrometre). libtiff refuses the value and
  // continues; the tag is meant for printing.
  if (error.find("\"ResolutionUnit\"") == std::string::npos && first_tiff_error.empty()) {
    first_tiff_error = error;
  }
}

void keep_first_warning(const char* /*module*/, const char* format, va_list arguments) {
  keep_first(first_tiff_warning, format, arguments);
}

template <class Number>
Number tag_or(TIFF* tiff, std::uint32_t tag, Number otherwise) {
  Number value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 0 ? otherwise : value;
}

// Decoders of fax and photograph compression replace missing data and only warn.
bool warns_of_damage(TIFF* tiff) {
  switch (tag_or<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE)) {
    case COMPRESSION_CCITTRLE:
    case COMPRESSION_CCITTFAX3:
    case COMPRESSION_CCITTFAX4:
    case COMPRESSION_CCITTRLEW:
    case COMPRESSION_JPEG:
    case COMPRESSION_OJPEG:
      return true;
    default:
      return false;
  }
}

bool is_float(std::uint16_t sample_format) { return sample_format == SAMPLEFORMAT_IEEEFP; }

bool is_readable(const PageFormat& format) {
  switch (format.sample_format) {
    case SAMPLEFORMAT_IEEEFP:
      return format.bits == 16 || format.bits == 32 || format.bits == 64;
    case SAMPLEFORMAT_INT:
      return format.bits == 8 || format.bits == 16 || format.bits == 32 || format.bits == 64;
    case SAMPLEFORMAT_UINT:
    case SAMPLEFORMAT_VOID:
      return (format.bits >= 1 && format.bits <= 16) || format.bits == 32 || format.bits == 64;
    default:
      return false;
  }
}

std::string sample_format_name(const PageFormat& format) {
  switch (format.sample_format) {
    case SAMPLEFORMAT_IEEEFP:
      return "floating point";
    case SAMPLEFORMAT_INT:
      return "signed integer";
    case SAMPLEFORMAT_COMPLEXINT:
    case SAMPLEFORMAT_COMPLEXIEEEFP:
      return "complex";
    default:
      return "unsigned integer";
  }
}

std::string photometric_name(std::uint16_t photometric) {
  switch (photometric) {
    case PHOTOMETRIC_SEPARATED:
      return "CMYK";
    case PHOTOMETRIC_YCBCR:
      return "YCbCr";
    case PHOTOMETRIC_CIELAB:
    case PHOTOMETRIC_ICCLAB:
    case PHOTOMETRIC_ITULAB:
      return "CIE L*a*b*";
    case 32803:
      return "colour filter array";
    default:
      return "photometric " + std::to_string(photometric);
  }
}

void require_decodable(TIFF* tiff, const fs::path& path) {
  const auto compression = tag_or<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (TIFFIsCODECConfigured(compression) == 0) {
    const TIFFCodec* const codec = TIFFFindCODEC(compression);
    throw unsupported(path, "is compressed with scheme " + std::to_string(compression) +
                                (codec == nullptr ? "" : std::string(" (") + codec->name + ")") +
                                ", which this libtiff cannot decode; expected none, LZW, deflate "
                                "or another that it can");
  }
}

// With other compressions libtiff ignores the predictor and returns differences instead of samples.
void require_predictor_is_undone(TIFF* tiff, std::uint32_t predictor, const fs::path& path) {
  constexpr std::array<std::uint16_t, 5> kWithPredictor{COMPRESSION_LZW, COMPRESSION_DEFLATE,
                                                        COMPRESSION_ADOBE_DEFLATE, COMPRESSION_LZMA,
                                                        COMPRESSION_ZSTD};
  const auto compression = tag_or<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (predictor != PREDICTOR_NONE &&
      std::ranges::find(kWithPredictor, compression) == kWithPredictor.end()) {
    const TIFFCodec* const codec = TIFFFindCODEC(compression);
    throw unsupported(path, "has predictor " + std::to_string(predictor) + " with compression " +
                                (codec == nullptr ? "" : codec->name) +
                                ", which libtiff does not undo; expected a predictor with LZW, "
                                "deflate, LZMA or zstandard, or none");
  }
}

void require_readable(const PageFormat& format, const fs::path& path) {
  constexpr std::array kPlainValues{PHOTOMETRIC_MINISWHITE, PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_RGB,
                                    PHOTOMETRIC_PALETTE};
  if (std::ranges::find(kPlainValues, format.photometric) == kPlainValues.end()) {
    throw unsupported(path, "has colour pages (" + photometric_name(format.photometric) +
                                "), expected grey values or red, green and blue");
  }
  if (!is_readable(format)) {
    throw unsupported(path, "has " + sample_format_name(format) + " samples of " +
                                std::to_string(format.bits) +
                                " bits, expected unsigned integers of 1 to 16, 32 or 64 bits, "
                                "signed integers of 8, 16, 32 or 64 bits, "
                                "or floating point of 16, 32 or 64 bits");
  }
}

}  // namespace

class TiffFile::Messages {
 public:
  Messages()
      : error_handler_(TIFFSetErrorHandler(keep_first_error)),
        warning_handler_(TIFFSetWarningHandler(keep_first_warning)) {
    first_tiff_error.clear();
    first_tiff_warning.clear();
  }
  ~Messages() {
    TIFFSetErrorHandler(error_handler_);
    TIFFSetWarningHandler(warning_handler_);
  }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  /// The first error, without the path with which most errors begin.
  static std::string first_error(const fs::path& path) {
    const std::string prefix = path.string() + ": ";
    return one_line(first_tiff_error.starts_with(prefix) ? first_tiff_error.substr(prefix.size())
                                                         : first_tiff_error);
  }

 private:
  TIFFErrorHandler error_handler_, warning_handler_;
};

SampleType PageFormat::type() const {
  const bool is_signed = sample_format == SAMPLEFORMAT_INT;
  if (is_float(sample_format)) {
    return bits == 64 ? SampleType::float64 : SampleType::float32;
  }
  if (bits <= 8) return is_signed ? SampleType::int8 : SampleType::uint8;
  if (bits <= 16) return is_signed ? SampleType::int16 : SampleType::uint16;
  if (bits == 32) return is_signed ? SampleType::int32 : SampleType::uint32;
  return is_signed ? SampleType::int64 : SampleType::uint64;
}

bool PageFormat::has_same_samples(const PageFormat& other) const {
  return width == other.width && height == other.height && bits == other.bits &&
         type() == other.type() && values_per_sample == other.values_per_sample;
}

std::uint64_t PageFormat::stored_bytes() const {
  const std::uint64_t row =
      packed_bytes(std::uint64_t{width} * values_per_sample, bits);  // at most 2^51
  constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
  return row > kMost / height ? kMost : row * height;
}

std::string to_string(const PageFormat& format) {
  const std::string values =
      format.values_per_sample > 1 ? std::to_string(format.values_per_sample) + " values of " : "";
  const bool is_native = format.bits == 8 * bytes_per_sample(format.type());
  const std::string type = is_native
                               ? std::string(name(format.type()))
                               : std::to_string(format.bits) + "-bit " + sample_format_name(format);
  return std::to_string(format.width) + " x " + std::to_string(format.height) + " samples of " +
         values + type;
}

TiffFile::TiffFile(const fs::path& path)
    : path_(path),
      file_size_(readable_file_size(path)),
      directories_(tiff_directories(path, file_size_)),
      messages_(std::make_unique<Messages>()),
      tiff_(TIFFOpen(path.c_str(), "rm"), TIFFClose) {  // m: no memory mapping
  if (!tiff_) {
    throw bad_file(path, "is not a readable TIFF file: " + Messages::first_error(path));
  }
}

TiffFile::~TiffFile() { tiff_.reset(); }

Error TiffFile::damaged(std::size_t page) const {
  const std::string error = Messages::first_error(path_);
  return bad_file(path_, "is cut off or damaged in page " + std::to_string(page + 1) +
                             (error.empty() ? "" : ": " + error));
}

void TiffFile::select(std::size_t page) {
  const bool is_there = TIFFSetSubDirectory(tiff_.get(), directories_[page].offset) != 0;
  page_ = page;
  if (!is_there || !first_tiff_error.empty()) {
    throw damaged(page);
  }
}

PageFormat TiffFile::format() const {
  PageFormat format;
  if (TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &format.width) == 0 ||
      TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &format.height) == 0 || format.width == 0 ||
      format.height == 0) {
    throw damaged(page_);
  }
  format.bits = tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_BITSPERSAMPLE, 1);
  format.sample_format =
      tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  format.values_per_sample = tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
  format.photometric = PHOTOMETRIC_MINISBLACK;
  TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &format.photometric);
  require_readable(format, path_);
  require_decodable(tiff_.get(), path_);
  require_predictor_is_undone(tiff_.get(), directories_[page_].predictor, path_);
  if (const auto depth = tag_or<std::uint32_t>(tiff_.get(), TIFFTAG_IMAGEDEPTH, 1); depth > 1) {
    throw unsupported(path_, "has pages of " + std::to_string(depth) +
                                 " layers each (ImageDepth), expected one slice per page");
  }
  if (format.values_per_sample == 0) {
    throw damaged(page_);
  }
  return format;
}

std::string TiffFile::description() const {
  const char* text = nullptr;
  return TIFFGetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, &text) == 0 || text == nullptr ? ""
                                                                                            : text;
}

bool TiffFile::is_preview() const {
  return (tag_or<std::uint32_t>(tiff_.get(), TIFFTAG_SUBFILETYPE, 0) &
          (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0;
}

std::string TiffFile::bytes_of_tag(std::uint32_t tag) const {
  std::uint32_t count = 0;
  const void* bytes = nullptr;
  for (const TIFFDataType type : {TIFF_BYTE, TIFF_UNDEFINED}) {
    const TIFFField* field = TIFFFindField(tiff_.get(), tag, type);
    if (field != nullptr && TIFFFieldPassCount(field) != 0 &&
        TIFFFieldReadCount(field) == TIFF_VARIABLE2 &&
        TIFFGetField(tiff_.get(), tag, &count, &bytes) != 0 && bytes != nullptr) {
      return {static_cast<const char*>(bytes), count};
    }
  }
  return "";
}

bool TiffFile::has_tag(std::uint32_t tag) const {
  for (int i = 0; i < TIFFGetTagListCount(tiff_.get()); ++i) {
    if (TIFFGetTagListEntry(tiff_.get(), i) == tag) {
      return true;
    }
  }
  return false;
}

std::uint16_t TiffFile::orientation() const {
  return tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
}

double TiffFile::samples_per_length(std::uint32_t tag) const {
  const auto value = static_cast<double>(tag_or<float>(tiff_.get(), tag, 0));
  return value > 0 ? value : 0;
}

std::uint16_t TiffFile::resolution_unit() const {
  return tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
}

bool TiffFile::packs_without_bound() const {
  switch (tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE)) {
    case COMPRESSION_NONE:
    case COMPRESSION_LZW:
    case COMPRESSION_PACKBITS:
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
    case COMPRESSION_JPEG:
    case COMPRESSION_OJPEG:
      return false;
    default:
      return true;
  }
}

std::vector<std::string> TiffFile::value_names() const {
  const PageFormat page = format();
  std::vector<std::string> names;
  if (page.photometric == PHOTOMETRIC_RGB && page.values_per_sample >= 3) {
    names = {"red", "green", "blue"};
  } else {
    names.push_back(page.photometric == PHOTOMETRIC_PALETTE ? "index" : "0");
  }
  std::uint16_t extra_count = 0;
  const std::uint16_t* extras = nullptr;
  TIFFGetField(tiff_.get(), TIFFTAG_EXTRASAMPLES, &extra_count, &extras);
  for (std::size_t i = names.size(), first_extra = i; i < page.values_per_sample; ++i) {
    const bool is_alpha = i - first_extra < extra_count && extras != nullptr &&
                          extras[i - first_extra] != EXTRASAMPLE_UNSPECIFIED;
    names.push_back(is_alpha ? "alpha" : std::to_string(i));
  }
  return names;
}

bool TiffFile::are_values_separate() const {
  return tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) ==
         PLANARCONFIG_SEPARATE;
}

std::uint64_t TiffFile::offset_of_plain_samples() const {
  const PageFormat page = format();
  if (tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE) !=
          COMPRESSION_NONE ||
      TIFFIsTiled(tiff_.get()) != 0 || (are_values_separate() && page.values_per_sample > 1) ||
      tag_or<std::uint16_t>(tiff_.get(), TIFFTAG_FILLORDER, 1) != FILLORDER_MSB2LSB) {
    return 0;
  }
  const std::uint32_t strips = TIFFNumberOfStrips(tiff_.get());
  const std::uint64_t start = TIFFGetStrileOffset(tiff_.get(), 0);
  std::uint64_t end = start;
  for (std::uint32_t strip = 0; strip < strips; ++strip) {
    if (TIFFGetStrileOffset(tiff_.get(), strip) != end) {
      return 0;
    }
    end += TIFFGetStrileByteCount(tiff_.get(), strip);
  }
  return end - start == page.stored_bytes() ? start : 0;
}

void TiffFile::require_stored(std::uint32_t strip_or_tile) const {
  if (TIFFGetStrileByteCount(tiff_.get(), strip_or_tile) == 0) {
    throw bad_file(
        path_,
        "page " + std::to_string(page_ + 1) +
            " has only a part of its samples (a sparse or damaged TIFF), expected all of them");
  }
}

void TiffFile::read_strips(const PageFormat& format, std::size_t value, const ReadOptions& options,
                           std::byte* samples) {
  const bool is_separate = are_values_separate();
  const std::size_t values = is_separate ? 1 : format.values_per_sample;
  const std::uint64_t stored_row = packed_bytes(std::uint64_t{format.width} * values, format.bits);
  const std::uint64_t row_bytes = format.width * bytes_per_sample(format.type());
  const bool is_direct = values == 1 && format.bits == 8 * bytes_per_sample(format.type());
  const std::uint32_t strip_rows = std::clamp(
      tag_or<std::uint32_t>(tiff_.get(), TIFFTAG_ROWSPERSTRIP, format.height), 1U, format.height);
  const std::shared_ptr<std::byte[]> stored =
      allocate_samples(path_, is_direct ? 0 : strip_rows * stored_row, options);
  for (std::uint32_t row = 0; row < format.height; row += strip_rows) {
    const std::uint32_t rows = std::min(strip_rows, format.height - row);
    const std::uint32_t strip =
        TIFFComputeStrip(tiff_.get(), row, static_cast<std::uint16_t>(is_separate ? value : 0));
    const auto bytes = static_cast<tmsize_t>(rows * stored_row);
    require_stored(strip);
    if (TIFFReadEncodedStrip(tiff_.get(), strip,
                             is_direct ? samples + row * row_bytes : stored.get(),
                             bytes) != bytes) {
      throw damaged(page_);
    }
    for (std::uint32_t r = 0; r < rows && !is_direct; ++r) {
      unpack_values(format, values, is_separate ? 0 : value, stored.get() + r * stored_row,
                    format.width, samples + (row + r) * row_bytes);
    }
    if (rows == format.height - row) {
      break;  // row + strip_rows might not fit in 32 bits
    }
  }
}

void TiffFile::read_tiles(const PageFormat& format, std::size_t value, const ReadOptions& options,
                          std::byte* samples) {
  const bool is_separate = are_values_separate();
  const std::size_t values = is_separate ? 1 : format.values_per_sample;
  const std::uint64_t sample_bytes = bytes_per_sample(format.type());
  const auto tile_width = tag_or<std::uint32_t>(tiff_.get(), TIFFTAG_TILEWIDTH, 0);
  const auto tile_height = tag_or<std::uint32_t>(tiff_.get(), TIFFTAG_TILELENGTH, 0);
  const std::uint64_t stored_row = packed_bytes(std::uint64_t{tile_width} * values, format.bits);
  const tmsize_t tile_bytes = TIFFTileSize(tiff_.get());
  if (tile_width == 0 || tile_height == 0 || tile_bytes <= 0 ||
      static_cast<std::uint64_t>(tile_bytes) / tile_height != stored_row) {
    throw damaged(page_);
  }
  if (!packs_without_bound()) {
    constexpr std::uint64_t kMostPerByte = 5000;  // LZW on constant data
    require_possible_bytes(path_, static_cast<std::uint64_t>(tile_bytes), file_size_, kMostPerByte);
  }
  const std::shared_ptr<std::byte[]> tile =
      allocate_samples(path_, static_cast<std::uint64_t>(tile_bytes), options);
  for (std::uint64_t row = 0; row < format.height; row += tile_height) {
    for (std::uint64_t column = 0; column < format.width; column += tile_width) {
      const auto x = static_cast<std::uint32_t>(column), y = static_cast<std::uint32_t>(row);
      const std::uint32_t index = TIFFComputeTile(
          tiff_.get(), x, y, 0, static_cast<std::uint16_t>(is_separate ? value : 0));
      require_stored(index);
      if (TIFFReadEncodedTile(tiff_.get(), index, tile.get(), tile_bytes) != tile_bytes) {
        throw damaged(page_);
      }
      const std::size_t count = std::min(tile_width, format.width - x);
      for (std::uint32_t r = 0; r < std::min(tile_height, format.height - y); ++r) {
        unpack_values(format, values, is_separate ? 0 : value, tile.get() + r * stored_row, count,
                      samples + ((row + r) * format.width + column) * sample_bytes);
      }
    }
  }
}

void TiffFile::read_samples(const PageFormat& format, std::size_t value, const ReadOptions& options,
                            std::byte* samples) {
  first_tiff_warning.clear();
  if (TIFFIsTiled(tiff_.get()) != 0) {
    read_tiles(format, value, options, samples);
  } else {
    read_strips(format, value, options, samples);
  }
  if (first_tiff_error.empty() && warns_of_damage(tiff_.get())) {
    first_tiff_error = first_tiff_warning;
  }
  if (!first_tiff_error.empty()) {
    throw damaged(page_);
  }
}

std::string TiffFile::library_version() const {
  const std::string text = TIFFGetVersion();  // "LIBTIFF, Version 4.5.0\nCopyright ..."
  const std::size_t begin = text.find_first_of("0123456789");
  return "libtiff " + (begin == std::string::npos
                           ? ""
                           : text.substr(begin, text.find_first_of(" \n", begin) - begin));
}

}  // namespace isoatlas::detail::io
