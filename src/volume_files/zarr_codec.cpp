// SPDX-License-Identifier: Apache-2.0
#include "volume_files/zarr_codec.h"

#include <blosc.h>
#include <lz4.h>
#include <zstd.h>

#include <array>
#include <boost/crc.hpp>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "files/decompressor.h"

namespace isoatlas::detail::io {
namespace {

constexpr const char* kWrongSize = "its size is wrong once it is decompressed";
constexpr std::size_t kChecksumBytes = 4;

std::uint32_t little_endian_32(const char* bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

std::string decompress(const std::string& stored, Packing packing, std::size_t bytes) {
  const std::unique_ptr<Decompressor> decompressor = decompressor_for(packing);
  std::string out(bytes + 1, '\0');  // one more, to notice a longer stream
  std::size_t read = 0, written = 0;
  for (;;) {
    const Decompressor::Step step = decompressor->step(stored.data() + read, stored.size() - read,
                                                       out.data() + written, out.size() - written);
    read += step.consumed;
    written += step.produced;
    if (written > bytes) throw kWrongSize;
    if (step.at_end) break;
    if (step.consumed == 0 && step.produced == 0) throw "it is cut off";
  }
  if (written != bytes) throw kWrongSize;
  out.resize(bytes);
  return out;
}

std::string decompress_zstd(const std::string& stored, std::size_t bytes) {
  std::string out(bytes, '\0');
  const std::size_t size = ZSTD_decompress(out.data(), bytes, stored.data(), stored.size());
  if (ZSTD_isError(size)) throw "it is damaged, or its size is wrong once it is decompressed";
  if (size != bytes) throw kWrongSize;
  return out;
}

std::string decompress_blosc(const std::string& stored, std::size_t bytes) {
  std::size_t stated = 0;
  if (blosc_cbuffer_validate(stored.data(), stored.size(), &stated) != 0)
    throw "it is damaged or cut off";
  if (stated != bytes) throw kWrongSize;
  std::string out(bytes, '\0');
  const int size = blosc_decompress_ctx(stored.data(), out.data(), bytes, 1);
  if (size < 0 || static_cast<std::size_t>(size) != bytes) throw "it is damaged";
  return out;
}

// As numcodecs writes it: the size as 4 bytes, little endian, before the data.
std::string decompress_lz4(const std::string& stored, std::size_t bytes) {
  constexpr std::size_t kLargest = std::numeric_limits<int>::max();
  if (stored.size() < 4 || stored.size() > kLargest) throw "it is cut off";
  if (little_endian_32(stored.data()) != bytes || bytes > kLargest) throw kWrongSize;
  std::string out(bytes, '\0');
  const int size = LZ4_decompress_safe(
      stored.data() + 4, out.data(), static_cast<int>(stored.size() - 4), static_cast<int>(bytes));
  if (size < 0 || static_cast<std::size_t>(size) != bytes) throw "it is damaged";
  return out;
}

std::string without_checksum(std::string stored) {
  if (stored.size() < kChecksumBytes) throw "it is cut off";
  const std::size_t bytes = stored.size() - kChecksumBytes;
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> checksum;
  checksum.process_bytes(stored.data(), bytes);
  if (checksum.checksum() != little_endian_32(stored.data() + bytes)) throw "its checksum is wrong";
  stored.resize(bytes);
  return stored;
}

std::string decode(std::string stored, ZarrCodec codec, std::size_t bytes) {
  switch (codec) {
    case ZarrCodec::gzip:
    case ZarrCodec::zlib:
      return decompress(stored, Packing::deflate, bytes);
    case ZarrCodec::bzip2:
      return decompress(stored, Packing::bzip2, bytes);
    case ZarrCodec::zstd:
      return decompress_zstd(stored, bytes);
    case ZarrCodec::lz4:
      return decompress_lz4(stored, bytes);
    case ZarrCodec::blosc:
      return decompress_blosc(stored, bytes);
    case ZarrCodec::crc32c:
      return without_checksum(std::move(stored));
  }
  return stored;
}

}  // namespace

bool zarr_codec_named(std::string_view name, ZarrCodec& codec) {
  constexpr std::string_view kPrefix = "numcodecs.";
  if (name.starts_with(kPrefix)) name.remove_prefix(kPrefix.size());
  constexpr std::array<std::pair<std::string_view, ZarrCodec>, 7> kNames{
      {{"gzip", ZarrCodec::gzip},
       {"zlib", ZarrCodec::zlib},
       {"bz2", ZarrCodec::bzip2},
       {"zstd", ZarrCodec::zstd},
       {"lz4", ZarrCodec::lz4},
       {"blosc", ZarrCodec::blosc},
       {"crc32c", ZarrCodec::crc32c}}};
  for (const auto& [known, value] : kNames) {
    if (name != known) continue;
    codec = value;
    return true;
  }
  return false;
}

std::string decode_chunk(std::string stored, const std::vector<ZarrCodec>& codecs,
                         std::size_t bytes) {
  for (std::size_t k = codecs.size(); k-- > 0;) {
    // Checksums that were added before this codec are part of what it compressed.
    std::size_t expected = bytes;
    for (std::size_t i = 0; i < k; ++i) {
      if (codecs[i] == ZarrCodec::crc32c) expected += kChecksumBytes;
    }
    stored = decode(std::move(stored), codecs[k], expected);
  }
  if (stored.size() != bytes) throw kWrongSize;
  return stored;
}

std::string zarr_libraries() {
  return std::string("c-blosc ") + blosc_get_version_string() + ", zstd " + ZSTD_versionString();
}

}  // namespace isoatlas::detail::io
