// SPDX-License-Identifier: Apache-2.0
// Files of formats that say in text what their samples are, made by hand.
#pragma once

#include <bzlib.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"

namespace isoatlas::test {

using Strings = std::vector<std::string>;

inline const std::filesystem::path kField = ISOATLAS_FIELD_DATA;

inline std::string samples_of(const Volume& volume) {
  return {static_cast<const char*>(volume.samples), volume.grid.sample_count() * bytes_per_sample(volume.type)};
}

inline std::string decision(const VolumeFile& file, const std::string& key) {
  for (const ReadDecision& decision : file.source.decisions) {
    if (decision.key == key) return decision.value;
  }
  return "none";
}

/// The bytes first, first + step, ...
inline std::string counted(std::size_t count, std::size_t first = 0, std::size_t step = 1) {
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes += static_cast<char>(first + i * step);
  }
  return bytes;
}

/// A gzip stream, or a zlib stream.
inline std::string gzipped(const std::string& bytes, bool gzip = true) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY);
  std::string packed(bytes.size() + 1000, '\0');
  std::string copy = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(copy.data());
  stream.avail_in = static_cast<uInt>(copy.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string bzipped(std::string bytes) {
  std::string packed(bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()), 9, 0, 0);
  packed.resize(size);
  return packed;
}

/// One file in a folder of its own, and what is beside it.
class OneFile {
 public:
  explicit OneFile(const std::string& bytes, const std::string& name = "a.bin") : path(folder_ / name) { write_bytes(path, bytes); }
  OneFile& with(const std::string& name, const std::string& bytes) {
    write_bytes(folder_ / name, bytes);
    return *this;
  }
  VolumeFile file(const ReadOptions& options = {}) const { return read_volume_file(path, options); }
  std::string samples(const ReadOptions& options = {}) const { return samples_of(file(options).volume); }
  void expect_refused(ErrorCode code, const std::string& says, const ReadOptions& options = {}) const {
    expect_error(code, says, path, [&] { read_volume_file(path, options); });
  }

 private:
  TempFolder folder_;

 public:
  std::filesystem::path path;
};

}  // namespace isoatlas::test
