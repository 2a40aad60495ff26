// SPDX-License-Identifier: Apache-2.0
// The codecs of Zarr's chunks: compressors and checksums of bytes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::io {

enum class ZarrCodec { gzip, zlib, bzip2, zstd, lz4, blosc, crc32c };

/// The codec with this name in the metadata of either version of Zarr, with or without the prefix
/// "numcodecs.".
/// @return false if the name is unknown
bool zarr_codec_named(std::string_view name, ZarrCodec& codec);

/// Undoes the codecs of a chunk, which were applied in this order.
/// @param bytes  size of the result
/// @throws const char*  what is wrong with the chunk, for example "its checksum is wrong"
std::string decode_chunk(std::string stored, const std::vector<ZarrCodec>& codecs,
                         std::size_t bytes);

/// The libraries that decode, with their versions.
std::string zarr_libraries();

}  // namespace isoatlas::detail::io
