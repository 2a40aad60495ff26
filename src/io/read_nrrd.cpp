// SPDX-License-Identifier: Apache-2.0
// NRRD by ITK (Teem), which notices samples that are missing or damaged, but allocates for any size it is told first.
#include <itkNrrdImageIO.h>

#include <string>

#include "io/file_error.h"
#include "io/formats.h"
#include "io/itk_image.h"
#include "io/library_messages.h"
#include "io/stored_data.h"
#include "io/text_scanner.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

// The file that holds the samples: named by the header's "data file" field, else the file itself. Empty if the samples
// are spread over several files.
fs::path data_file_of(const fs::path& path) {
  constexpr std::size_t kHeaderLimit = std::size_t{1} << 20;
  const std::string text = first_bytes(path, kHeaderLimit);
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (line.empty() || line == "\r") {
      break;  // the samples follow
    }
    for (const std::string_view field : {"data file:", "datafile:"}) {
      if (line.starts_with(field)) {
        const std::string value = one_line(line.substr(field.size()), 4096);
        const bool is_list = value.starts_with("LIST") || value.find('%') != std::string::npos;
        return is_list ? fs::path{} : path.parent_path() / value;
      }
    }
  }
  return path;
}

}  // namespace

Volume read_nrrd(const fs::path& path) {
  const LibraryMessages messages;
  return read_itk_volume(*itk::NrrdImageIO::New(), path, "NRRD file", [&](const ImageHeader& header) {
    const fs::path data_file = data_file_of(path);
    if (!data_file.empty()) {
      require_possible_bytes(path, header.sample_count() * bytes_per_sample(header.type), readable_file_size(data_file));
    }
  });
}

}  // namespace isoatlas::io
