// SPDX-License-Identifier: Apache-2.0
// The header of a MetaImage. https://itk.org/Wiki/ITK/MetaIO/Documentation
//
// Read here and not by MetaIO (which ITK uses): MetaIO returns success with less than the stated
// samples, whatever the encoding, reads past its buffers if a header has more values than it
// expects, and takes only files with the extension .mha or .mhd.
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

/// The fields of a header. The last value counts where a field is repeated.
struct MetaImageHeader {
  std::map<std::string, std::string, std::less<>> fields = {};
  std::vector<std::string> listed_files = {};  ///< the lines after "ElementDataFile = LIST"
  std::uint64_t bytes = 0;  ///< of the header up to the end of the line ElementDataFile
  bool is_gzipped = false;  ///< the file as a whole

  std::string_view field(std::string_view name) const;

  /// The first of these fields that there is.
  std::string_view field(std::initializer_list<std::string_view> names) const;

  bool is_true(std::string_view name, bool if_missing) const;
};

/// @throws Error(bad_file) if there is no ElementDataFile
MetaImageHeader read_meta_image_header(const std::filesystem::path& path);

/// Integer of a field. @throws Error(bad_file) if it is not one of at least `least`
std::int64_t meta_integer(const std::filesystem::path& path, const MetaImageHeader& header,
                          std::string_view name, std::int64_t if_missing, std::int64_t least);

/// The numbers of the first of these fields that there is; none if there is none of them.
/// @throws Error(bad_file) if there are not `count` of them
std::optional<std::vector<double>> meta_numbers(const std::filesystem::path& path,
                                                const MetaImageHeader& header,
                                                std::initializer_list<std::string_view> names,
                                                std::size_t count);

/// Number of samples along each axis, fastest first; one for each of NDims.
std::vector<std::size_t> meta_sizes(const std::filesystem::path& path,
                                    const MetaImageHeader& header);

SampleType meta_sample_type(const std::filesystem::path& path, const MetaImageHeader& header);

}  // namespace isoatlas::detail::io
