// SPDX-License-Identifier: Apache-2.0
// Which reader a file is for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "volume_files/readers.h"

namespace isoatlas::detail::io {

struct VolumeFormat {
  std::string_view name;                           ///< for messages: "NRRD"
  std::string_view extensions;                     ///< with dots, between blanks, lower case
  bool (*has_mark)(std::string_view first_bytes);  ///< does a file that begins like this have the
                                                   ///< format? Null: nothing tells
  VolumeFile (*read)(const std::filesystem::path& path, const ReadOptions& options);
  bool is_read_gzipped =
      true;  ///< the whole file may be gzipped, or the reader refuses that itself
};

/// The format whose mark the file has, else the one that its extension names. Names are compared
/// without regard to case.
/// @throws Error(unsupported)  neither; the message says what the file seems to be where that is
/// known
const VolumeFormat& format_of(const std::filesystem::path& path);

/// All extensions, between blanks.
std::string volume_extensions();

}  // namespace isoatlas::detail::io
