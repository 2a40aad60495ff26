// SPDX-License-Identifier: Apache-2.0
// The header of a MetaImage. https://itk.org/Wiki/ITK/MetaIO/Documentation
//
// MetaIO, which ITK uses, is not used: it returns success with fewer samples than stated, for every
// encoding, reads past its buffers if a header has more values than it expects, and accepts only
// files with the extension .mha or .mhd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail::io {

/// The fields of a header. If a field is repeated, the last value counts.
struct MetaImageHeader {
  std::map<std::string, std::string, std::less<>> fields = {};
  std::vector<std::string> listed_files = {};  ///< the lines after "ElementDataFile = LIST"
  std::uint64_t bytes = 0;  ///< size of the header, up to the end of the line ElementDataFile
  bool is_gzipped = false;  ///< the file as a whole

  std::string_view field(std::string_view name) const;

  /// The first of these fields that the header has.
  std::string_view field(std::initializer_list<std::string_view> names) const;

  bool is_true(std::string_view name, bool if_missing) const;
};

/// @throws Error(bad_file) if there is no ElementDataFile
MetaImageHeader read_meta_image_header(const std::filesystem::path& path);

/// A field as an integer. @throws Error(bad_file) if it is not an integer of at least `least`
std::int64_t meta_integer(const std::filesystem::path& path, const MetaImageHeader& header,
                          std::string_view name, std::int64_t if_missing, std::int64_t least);

/// The numbers of the first of these fields that the header has; nothing if it has none of them.
/// @throws Error(bad_file) if there are not `count` of them
std::optional<std::vector<double>> meta_numbers(const std::filesystem::path& path,
                                                const MetaImageHeader& header,
                                                std::initializer_list<std::string_view> names,
                                                std::size_t count);

/// The number of samples along each of the NDims axes, fastest axis first.
std::vector<std::size_t> meta_sizes(const std::filesystem::path& path,
                                    const MetaImageHeader& header);

SampleType meta_sample_type(const std::filesystem::path& path, const MetaImageHeader& header);

}  // namespace isoatlas::detail::io
