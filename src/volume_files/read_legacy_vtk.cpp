// SPDX-License-Identifier: Apache-2.0
// Legacy VTK structured points by ITK, which takes cell data for point data and does not notice missing samples.
#include <itkVTKImageIO.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/itk_image.h"
#include "files/library_messages.h"
#include "files/stored_data.h"
#include "files/text_scanner.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

std::string upper_case(std::string_view word) {
  std::string upper(word);
  std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return upper;
}

void check_stored_data(const fs::path& path, const ImageHeader& header) {
  constexpr std::size_t kHeaderLimit = std::size_t{1} << 16;
  const std::uint64_t file_bytes = readable_file_size(path);
  const std::string text = first_bytes(path, kHeaderLimit);
  TextScanner scanner(text, path);
  bool is_ascii = false;
  std::string attributes;  // POINT_DATA or CELL_DATA, whichever was last
  bool has_samples = false;
  while (!has_samples && scanner.next_line()) {
    const std::string keyword = upper_case(scanner.word());
    is_ascii = is_ascii || keyword == "ASCII";
    if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
      attributes = keyword;
    }
    has_samples = keyword == "SCALARS";
  }
  if (!has_samples) {
    throw unsupported(path, "has no SCALARS, expected one scalar per point");
  }
  if (attributes != "POINT_DATA") {
    throw unsupported(path, "its scalars are " + attributes + ", expected POINT_DATA");
  }
  // A line "LOOKUP_TABLE name" stands between SCALARS and the samples.
  std::size_t samples_begin = text.size() - scanner.remaining();
  if (scanner.next_line() && upper_case(scanner.word()) == "LOOKUP_TABLE") {
    samples_begin = text.size() - scanner.remaining();
  }
  if (is_ascii) {
    require_possible_bytes(path, header.sample_count(), file_bytes - samples_begin, 1);
    require_stored_numbers(path, std::string_view(file_contents(path)).substr(samples_begin), header.sample_count());
  } else {
    require_stored_bytes(path, header.sample_count() * bytes_per_sample(header.type), file_bytes - samples_begin);
  }
}

}  // namespace

VolumeFile read_legacy_vtk(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;
  VolumeFile file;
  file.source.format = "legacy VTK";
  file.volume = read_itk_volume(*itk::VTKImageIO::New(), path, "legacy VTK file with structured points",
                         [&](const ImageHeader& header) { check_stored_data(path, header); }, options);
  return file;
}

}  // namespace isoatlas::io
