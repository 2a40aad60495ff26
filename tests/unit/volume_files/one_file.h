// SPDX-License-Identifier: Apache-2.0
// Hand-written files of formats that describe their samples in text.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/packed_bytes.h"

namespace isoatlas::detail::test {

using Strings = std::vector<std::string>;

inline const std::filesystem::path kField = ISOATLAS_FIELD_DATA;

inline std::string samples_of(const Volume& volume) {
  return {static_cast<const char*>(volume.view.samples),
          volume.view.grid.sample_count() * bytes_per_sample(volume.view.type)};
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

/// A file in a temporary folder, and other files in that folder.
class OneFile {
 public:
  explicit OneFile(const std::string& bytes, const std::string& name = "a.bin")
      : path(folder_ / name) {
    write_bytes(path, bytes);
  }
  OneFile& with(const std::string& name, const std::string& bytes) {
    write_bytes(folder_ / name, bytes);
    return *this;
  }
  VolumeFile file(const ReadOptions& options = {}) const { return read_volume_file(path, options); }
  std::string samples(const ReadOptions& options = {}) const {
    return samples_of(file(options).volume);
  }
  void expect_refused(ErrorCode code, const std::string& message,
                      const ReadOptions& options = {}) const {
    expect_error(code, message, path, [&] { read_volume_file(path, options); });
  }

 private:
  TempFolder folder_;

 public:
  std::filesystem::path path;
};

}  // namespace isoatlas::detail::test
