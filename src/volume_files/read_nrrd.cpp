// SPDX-License-Identifier: Apache-2.0
// NRRD by ITK (Teem), which notices samples that are missing or damaged, but allocates for any size it is told first.
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/itk_image.h"
#include "files/library_messages.h"
#include "files/stored_data.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

struct NrrdHeader {
  fs::path data_file;  // the file itself unless its "data file" field names another; empty if there are several
};

NrrdHeader scan_header(const fs::path& path) {
  constexpr std::size_t kHeaderLimit = std::size_t{1} << 20;
  // Teem quotes a field it does not understand in a message of 512 bytes at most, and aborts if that is too small.
  constexpr std::size_t kFieldLimit = 400;
  const std::string text = first_bytes(path, kHeaderLimit);
  if (!text.starts_with("NRRD")) {
    throw bad_file(path, "is not a NRRD file");
  }
  NrrdHeader header{path};
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (line.empty() || line == "\r") {
      break;  // the samples follow
    }
    const bool is_free_text = line.starts_with('#') || line.starts_with("content:") || line.find(":=") != std::string_view::npos;
    if (!is_free_text && line.size() > kFieldLimit) {
      throw bad_file(path, "has a header line of " + std::to_string(line.size()) + " characters: " + one_line(line, 40));
    }
    for (const std::string_view field : {"data file:", "datafile:"}) {
      if (line.starts_with(field)) {
        const std::string value = one_line(line.substr(field.size()), kFieldLimit);
        const bool is_list = value.starts_with("LIST") || value.find('%') != std::string::npos;
        header.data_file = is_list ? fs::path{} : path.parent_path() / value;
        if (is_list) {
          return header;
        }
      }
    }
  }
  return header;
}

}  // namespace

VolumeFile read_nrrd(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;
  const fs::path data_file = scan_header(path).data_file;
  VolumeFile file;
  file.source.format = "NRRD";
  file.volume = read_itk_volume(*itk::NrrdImageIO::New(), path, "NRRD file", [&](const ImageHeader& header) {
    if (data_file.empty()) {
      return;
    }
    check_data_file(path, data_file, [&] {
      require_possible_bytes(data_file, header.sample_count() * bytes_per_sample(header.type), readable_file_size(data_file));
    });
  }, options);
  return file;
}

}  // namespace isoatlas::io
