// SPDX-License-Identifier: Apache-2.0
// A TIFF stack, one page per slice, by libtiff.
//
// Not through ITK: of a stack that is cut off it returns the pages that are left, and of pages of different size
// something that is none of them, both without an error.
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/grid_of_file.h"
#include "files/library_messages.h"
#include "files/stored_data.h"
#include "files/text_scanner.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

std::string first_tiff_error;  // guarded by the lock in LibraryMessages

void keep_first_error(const char* /*module*/, const char* format, va_list arguments) {
  if (first_tiff_error.empty()) {
    std::array<char, 300> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    first_tiff_error = text.data();
  }
}

class TiffMessages {
 public:
  TiffMessages() : error_handler_(TIFFSetErrorHandler(keep_first_error)), warning_handler_(TIFFSetWarningHandler(nullptr)) {
    first_tiff_error.clear();
  }
  ~TiffMessages() {
    TIFFSetErrorHandler(error_handler_);
    TIFFSetWarningHandler(warning_handler_);
  }
  TiffMessages(const TiffMessages&) = delete;
  TiffMessages& operator=(const TiffMessages&) = delete;

 private:
  TIFFErrorHandler error_handler_, warning_handler_;
};

struct Page {
  std::uint32_t width = 0, height = 0;
  SampleType type = SampleType::uint8;
  friend bool operator==(const Page&, const Page&) = default;
};

// libtiff's first error, without the path that most of them start with.
std::string tiff_error(const fs::path& path) {
  const std::string prefix = path.string() + ": ";
  return one_line(first_tiff_error.starts_with(prefix) ? first_tiff_error.substr(prefix.size()) : first_tiff_error);
}

Error damaged(const fs::path& path, std::size_t page) {
  return bad_file(path,
                  "is cut off or damaged in page " + std::to_string(page + 1) + (first_tiff_error.empty() ? "" : ": " + tiff_error(path)));
}

SampleType sample_type_of(std::uint16_t format, std::uint16_t bits, const fs::path& path) {
  const auto pick = [&](SampleType unsigned_type, SampleType signed_type) {
    return format == SAMPLEFORMAT_INT ? signed_type : unsigned_type;
  };
  if (format == SAMPLEFORMAT_IEEEFP && (bits == 32 || bits == 64)) {
    return bits == 32 ? SampleType::float32 : SampleType::float64;
  }
  if (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_INT || format == SAMPLEFORMAT_VOID) {
    switch (bits) {
      case 8:
        return pick(SampleType::uint8, SampleType::int8);
      case 16:
        return pick(SampleType::uint16, SampleType::int16);
      case 32:
        return pick(SampleType::uint32, SampleType::int32);
      case 64:
        return pick(SampleType::uint64, SampleType::int64);
      default:
        break;
    }
  }
  throw unsupported(path, "has samples of " + std::to_string(bits) + " bits (sample format " + std::to_string(format) +
                              "), expected integers of 8 to 64 bits, float or double");
}

Page read_page_header(TIFF* tiff, const fs::path& path, std::size_t page_number) {
  Page page;
  std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT, values_per_sample = 1, photometric = PHOTOMETRIC_MINISBLACK;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width) == 0 || TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height) == 0) {
    throw damaged(path, page_number);
  }
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &values_per_sample);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  if (values_per_sample != 1) {
    throw unsupported(path, "has " + std::to_string(values_per_sample) + " values per sample (colour), expected one");
  }
  if (photometric != PHOTOMETRIC_MINISBLACK && photometric != PHOTOMETRIC_MINISWHITE) {
    throw unsupported(path, "has colour pages (photometric " + std::to_string(photometric) + "), expected grey values");
  }
  page.type = sample_type_of(format, bits, path);
  return page;
}

// Pages that are previews or masks of other pages are no slices.
bool is_slice(TIFF* tiff) {
  std::uint32_t kind = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
  return (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0;
}

void read_page_samples(TIFF* tiff, const fs::path& path, const Page& page, std::size_t page_number, std::byte* samples) {
  const std::size_t row_bytes = page.width * bytes_per_sample(page.type);
  if (TIFFIsTiled(tiff) == 0) {
    std::uint32_t rows_per_strip = page.height;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &rows_per_strip);
    rows_per_strip = std::min(std::max(rows_per_strip, 1U), page.height);
    std::uint32_t strip = 0;
    for (std::uint32_t row = 0; row < page.height; row += rows_per_strip, ++strip) {
      const std::size_t bytes = std::min(rows_per_strip, page.height - row) * row_bytes;
      if (TIFFReadEncodedStrip(tiff, strip, samples + row * row_bytes, static_cast<tmsize_t>(bytes)) != static_cast<tmsize_t>(bytes)) {
        throw damaged(path, page_number);
      }
    }
    return;
  }
  std::uint32_t tile_width = 0, tile_height = 0;
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
  const std::size_t tile_row_bytes = tile_width * bytes_per_sample(page.type);
  const tmsize_t tile_bytes = TIFFTileSize(tiff);
  if (tile_width == 0 || tile_height == 0 || static_cast<std::uint64_t>(tile_bytes) != tile_row_bytes * tile_height) {
    throw damaged(path, page_number);
  }
  require_possible_bytes(path, static_cast<std::uint64_t>(tile_bytes), readable_file_size(path), 5000);
  std::vector<std::byte> tile(static_cast<std::size_t>(tile_bytes));
  for (std::uint32_t row = 0; row < page.height; row += tile_height) {
    for (std::uint32_t column = 0; column < page.width; column += tile_width) {
      if (TIFFReadTile(tiff, tile.data(), column, row, 0, 0) != tile_bytes) {
        throw damaged(path, page_number);
      }
      const std::size_t bytes = std::min(tile_width, page.width - column) * bytes_per_sample(page.type);
      for (std::uint32_t r = 0; r < std::min(tile_height, page.height - row); ++r) {
        std::memcpy(samples + (row + r) * row_bytes + column * bytes_per_sample(page.type), tile.data() + r * tile_row_bytes, bytes);
      }
    }
  }
}

// Directories are a linked list, and libtiff takes a link that is cut off with the file for the end of the list.
bool is_whole_directory(TIFF* tiff, const fs::path& path, std::uint64_t offset) {
  const bool is_big = TIFFIsBigTIFF(tiff) != 0;
  std::array<unsigned char, 8> count{};
  const std::size_t count_bytes = is_big ? 8 : 2;
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(count.data()), static_cast<std::streamsize>(count_bytes));
  if (TIFFIsBigEndian(tiff) == 0) {
    std::reverse(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(count_bytes));
  }
  std::uint64_t entries = 0;
  for (std::size_t i = 0; i < count_bytes; ++i) {
    entries = entries << 8 | count[i];
  }
  const std::uint64_t directory_bytes = count_bytes + entries * (is_big ? 20 : 12) + (is_big ? 8 : 4);
  return file.good() && offset + directory_bytes <= readable_file_size(path);
}

// The resolution tags of TIFF are about print and say nothing of the distance of slices, so alone they would stretch
// the volume: spacing is 1, except that ImageJ writes the slice distance ("spacing=...") beside a resolution in its
// own unit.
Vec3 spacing_of(TIFF* tiff, const fs::path& path) {
  const char* description = nullptr;
  float x_resolution = 0, y_resolution = 0;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description) == 0 || description == nullptr ||
      !std::string_view(description).starts_with("ImageJ=") || TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x_resolution) == 0 ||
      TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y_resolution) == 0 || !(x_resolution > 0) || !(y_resolution > 0)) {
    return {1, 1, 1};
  }
  const std::string text(description);
  constexpr std::string_view kKey = "\nspacing=";
  const std::size_t key = text.find(kKey);
  if (key == std::string::npos) {
    return {1, 1, 1};
  }
  const std::size_t begin = key + kKey.size();
  const std::string value = one_line(std::string_view(text).substr(begin, text.find('\n', begin) - begin));
  const double slice_distance = TextScanner({}, path).to_number(value, "a length after 'spacing=' in ImageJ's description");
  return {1.0 / x_resolution, 1.0 / y_resolution, slice_distance};
}

}  // namespace

VolumeFile read_tiff(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;
  const TiffMessages tiff_messages;
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(path.c_str(), "rm"), TIFFClose);  // m: no memory mapping
  if (!tiff) {
    throw bad_file(path, "is not a readable TIFF file: " + tiff_error(path));
  }
  const Vec3 spacing = spacing_of(tiff.get(), path);
  Page first_page;
  std::size_t slices = 0;
  std::size_t page_number = 0;
  std::uint64_t directory_offset = 0;
  do {
    directory_offset = TIFFCurrentDirOffset(tiff.get());
    if (is_slice(tiff.get())) {
      const Page page = read_page_header(tiff.get(), path, page_number);
      if (slices == 0) {
        first_page = page;
      } else if (page != first_page) {
        throw unsupported(path, "page " + std::to_string(page_number + 1) + " has " + std::to_string(page.width) + " x " +
                                    std::to_string(page.height) + " samples of " + std::string(name(page.type)) + ", the first has " +
                                    std::to_string(first_page.width) + " x " + std::to_string(first_page.height) + " of " +
                                    std::string(name(first_page.type)));
      }
      ++slices;
    }
    ++page_number;
  } while (TIFFReadDirectory(tiff.get()) != 0);
  if (!first_tiff_error.empty() || !is_whole_directory(tiff.get(), path, directory_offset)) {
    throw damaged(path, page_number);
  }

  Volume volume;
  const std::array<std::size_t, 3> size{first_page.width, first_page.height, slices};
  const std::uint64_t bytes = checked_sample_bytes(path, size, bytes_per_sample(first_page.type));
  constexpr std::uint64_t kMostSamplesPerByte = 5000;  // LZW, the best a TIFF can do on constant data
  require_possible_bytes(path, bytes, readable_file_size(path), kMostSamplesPerByte);
  volume.grid = grid_of_file(path, size, spacing, {}, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  volume.type = first_page.type;
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  const std::uint64_t page_bytes = bytes / slices;
  std::size_t slice = 0;
  if (TIFFSetDirectory(tiff.get(), 0) == 0) {
    throw damaged(path, 0);
  }
  for (std::size_t page = 0; page < page_number; ++page) {
    if (is_slice(tiff.get())) {
      read_page_samples(tiff.get(), path, first_page, page, samples.get() + slice * page_bytes);
      ++slice;
    }
    if (page + 1 < page_number && TIFFReadDirectory(tiff.get()) == 0) {
      throw damaged(path, page + 1);
    }
  }
  volume.samples = samples.get();
  volume.owner = samples;
  VolumeFile file{std::move(volume), {}};
  file.source.format = "TIFF";
  return file;
}

}  // namespace isoatlas::io
