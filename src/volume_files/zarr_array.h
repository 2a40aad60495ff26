// SPDX-License-Identifier: Apache-2.0
// Arrays of Zarr version 2 and 3 in folders: their metadata and their chunks.
// https://zarr-specs.readthedocs.io
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"
#include "volume_files/zarr_codec.h"

namespace isoatlas::detail::io {

/// How the values of a chunk are stored.
struct ZarrChunk {
  std::vector<std::uint64_t> size = {};  ///< per axis
  std::vector<std::size_t> order = {};   ///< the axes, slowest first
  std::vector<ZarrCodec> codecs = {};    ///< after the values were made bytes
  bool is_big_endian = false;
};

/// The metadata of an array.
struct ZarrArray {
  std::filesystem::path folder = {};
  int version = 2;
  std::vector<std::uint64_t> size = {};      ///< per axis, slowest first
  std::vector<std::string> axis_names = {};  ///< empty if they are not stated
  SampleType type = SampleType::uint8;
  std::size_t value_bytes = 1;  ///< as stored
  bool is_half = false;         ///< half-precision numbers, read as float32
  std::string fill_value = {};  ///< bytes of a value of the type, of this machine
  ZarrChunk chunk = {};
  /// With sharding, a file has several chunks and an index of them, and `chunk` is that of a file;
  /// only its size is used.
  struct Sharding {
    ZarrChunk chunk;
    std::vector<ZarrCodec> index_codecs;
    bool is_index_big_endian = false, is_index_first = false;
  };
  std::optional<Sharding> sharding = {};
  bool has_prefix = false;  ///< names of chunks begin with "c"
  char separator = '.';     ///< between the numbers in the name of a chunk
};

/// Whether the folder is an array or a group.
bool is_zarr(const std::filesystem::path& folder);
bool is_zarr_array(const std::filesystem::path& folder);

/// @throws Error(bad_file) if the metadata is damaged; Error(unsupported) for a type, codec or grid
///         of chunks that is not read
ZarrArray read_zarr_metadata(const std::filesystem::path& folder);

/// A part of an array with three axes: one index along all others.
struct ZarrSelection {
  std::size_t x_axis = 0, y_axis = 0, z_axis = 0;
  std::vector<std::uint64_t> first = {};  ///< per axis
  Size3 size{};                           ///< along x, y and z
};

/// Numbers of chunks.
struct ZarrChunkCount {
  std::uint64_t stored = 0, all = 0;
};

/// Reads the samples of a part, x fastest, in this machine's byte order. Chunks that are not stored
/// have the fill value, as the specification states.
/// @param samples  memory for them, of the type of the array
/// @return how many of the chunks are stored, and how many there are
/// @throws Error(bad_file) if a chunk is damaged; the message has its index
ZarrChunkCount read_zarr_samples(const ZarrArray& array, const ZarrSelection& selection,
                                 std::byte* samples);

}  // namespace isoatlas::detail::io
