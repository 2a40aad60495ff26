// SPDX-License-Identifier: Apache-2.0
// Selects the reader for a file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "volume_files/readers.h"

namespace isoatlas::detail::io {

struct VolumeFormat {
  std::string_view name;        ///< for messages: "NRRD"
  std::string_view extensions;  ///< with dots, separated by blanks, in lower case
  bool (*has_mark)(std::string_view first_bytes);  ///< true if a file with these first bytes has
                                                   ///< the format; null if the bytes do not show it
  VolumeFile (*read)(const std::filesystem::path& path, const ReadOptions& options);
  bool is_read_gzipped =
      true;  ///< the whole file may be gzipped, or the reader itself refuses a gzipped file
};

/// The format that the file's first bytes show, otherwise the format of its extension. Upper and
/// lower case are equal.
/// @throws Error(unsupported)  if the format is unknown; the message names the kind of file if it
/// is known
const VolumeFormat& format_of(const std::filesystem::path& path);

/// All extensions, separated by blanks.
std::string volume_extensions();

}  // namespace isoatlas::detail::io
