// SPDX-License-Identifier: Apache-2.0
#include "volume_files/png_image.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

/// The state passed to libpng. libpng leaves a function by longjmp, so a function that calls it
/// must not have local objects with destructors.
struct Decoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::FILE* file = nullptr;
  char message[200] = "";
  ~Decoder() {
    if (png != nullptr) png_destroy_read_struct(&png, &info, nullptr);
    if (file != nullptr) std::fclose(file);
  }
};

void keep_message(png_structp png, png_const_charp text) {
  auto* const decoder = static_cast<Decoder*>(png_get_error_ptr(png));
  std::snprintf(decoder->message, sizeof decoder->message, "%s", text);
  png_longjmp(png, 1);
}

void no_message(png_structp, png_const_charp) {}

bool read_header(Decoder& decoder, PngFormat& format) {
  if (setjmp(png_jmpbuf(decoder.png)) != 0) return false;
  png_init_io(decoder.png, decoder.file);
  png_set_user_limits(decoder.png, 0x7FFFFFFF,
                      0x7FFFFFFF);  // no limits: sizes are checked against the file
  png_read_info(decoder.png, decoder.info);
  format.width = png_get_image_width(decoder.png, decoder.info);
  format.height = png_get_image_height(decoder.png, decoder.info);
  format.bits = png_get_bit_depth(decoder.png, decoder.info);
  format.values_per_sample = png_get_channels(decoder.png, decoder.info);
  format.is_palette = png_get_color_type(decoder.png, decoder.info) == PNG_COLOR_TYPE_PALETTE;
  return true;
}

bool read_rows(Decoder& decoder, png_bytepp rows) {
  if (setjmp(png_jmpbuf(decoder.png)) != 0) return false;
  png_set_packing(decoder.png);  // values of fewer than 8 bits get a byte each, unchanged
  png_set_interlace_handling(decoder.png);
  png_read_update_info(decoder.png, decoder.info);
  png_read_image(decoder.png, rows);
  png_read_end(decoder.png, nullptr);
  return true;
}

Error damaged(const fs::path& path, const Decoder& decoder) {
  return bad_file(path, std::string("is cut off or damaged: ") + one_line(decoder.message));
}

PngFormat open(const fs::path& path, Decoder& decoder) {
  readable_file_size(path);
  decoder.file = std::fopen(path.c_str(), "rb");
  decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, keep_message, no_message);
  decoder.info = decoder.png == nullptr ? nullptr : png_create_info_struct(decoder.png);
  if (decoder.file == nullptr || decoder.info == nullptr) {
    throw bad_file(path, "cannot be opened");
  }
  PngFormat format;
  if (!read_header(decoder, format)) {
    throw damaged(path, decoder);
  }
  return format;
}

void require_opaque(const fs::path& path, const PngFormat& format, const std::byte* stored) {
  const std::size_t value_bytes = format.bits / 8;
  const std::size_t sample_bytes = value_bytes * format.values_per_sample;
  const std::size_t count = std::size_t{format.width} * format.height;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* const alpha = stored + (i + 1) * sample_bytes - value_bytes;
    if (alpha[0] != std::byte{0xFF} || alpha[value_bytes - 1] != std::byte{0xFF}) {
      throw unsupported(path,
                        "has transparent samples (an alpha channel), expected opaque samples");
    }
  }
}

}  // namespace

std::uint64_t PngFormat::stored_bytes() const {
  return (std::uint64_t{width} * values_per_sample * bits + 7) / 8 *
         height;  // does not overflow: below 2^31 * 2^6 / 2^3 * 2^31
}

std::string to_string(const PngFormat& format) {
  const std::string kind = format.is_palette               ? "-bit palette indices"
                           : format.values_per_sample == 1 ? "-bit grey values"
                           : format.values_per_sample == 2 ? "-bit grey and alpha"
                           : format.values_per_sample == 3 ? "-bit red, green and blue"
                                                           : "-bit red, green, blue and alpha";
  return std::to_string(format.width) + " x " + std::to_string(format.height) + " samples of " +
         std::to_string(format.bits) + kind;
}

PngFormat png_format(const fs::path& path) {
  Decoder decoder;
  return open(path, decoder);
}

void read_png(const fs::path& path, const PngFormat& format, std::size_t value,
              const ReadOptions& options, std::byte* samples) {
  Decoder decoder;
  if (open(path, decoder) != format) {
    throw bad_file(path, "changed while it was read");
  }
  const std::size_t value_bytes = bytes_per_sample(format.type());
  const std::size_t values = format.values_per_sample;
  const std::size_t count = std::size_t{format.width} * format.height;
  const bool is_direct = values == 1;
  const std::shared_ptr<std::byte[]> stored =
      allocate_samples(path, is_direct ? 0 : count * values * value_bytes, options);
  std::byte* const to = is_direct ? samples : stored.get();
  std::vector<png_bytep> rows(format.height);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    rows[row] = reinterpret_cast<png_bytep>(to + row * format.width * values * value_bytes);
  }
  if (!read_rows(decoder, rows.data())) {
    throw damaged(path, decoder);
  }
  if (format.has_alpha()) {
    require_opaque(path, format, stored.get());
  }
  for (std::size_t i = 0; i < count && !is_direct; ++i) {
    std::memcpy(samples + i * value_bytes, stored.get() + (i * values + value) * value_bytes,
                value_bytes);
  }
  if (value_bytes == 2 && std::endian::native == std::endian::little) {
    swap_byte_order(samples, count, value_bytes);
  }
}

std::string png_library_version() { return std::string("libpng ") + png_get_libpng_ver(nullptr); }

}  // namespace isoatlas::detail::io
