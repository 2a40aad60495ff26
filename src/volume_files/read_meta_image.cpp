// SPDX-License-Identifier: Apache-2.0
// MetaImage by ITK. MetaIO returns success with less than the promised samples, whatever the encoding: all is checked
// here before it reads.
#include <itkMetaImageIO.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/itk_image.h"
#include "files/library_messages.h"
#include "files/stored_data.h"
#include "files/text_scanner.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

struct MetaFields {
  std::map<std::string, std::string, std::less<>> values;  // the last line of the header is ElementDataFile
  std::uint64_t header_bytes = 0;

  std::string value_of(std::string_view key) const {
    const auto found = values.find(key);
    return found == values.end() ? std::string() : found->second;
  }
  bool is_true(std::string_view key) const {
    const std::string value = value_of(key);
    return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
  }
};

MetaFields read_fields(const fs::path& path) {
  constexpr std::size_t kHeaderLimit = std::size_t{1} << 20;
  const std::string text = first_bytes(path, kHeaderLimit);
  MetaFields fields;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t line_end = rest.find('\n');
    const std::string_view line = rest.substr(0, line_end);
    rest.remove_prefix(line_end == std::string_view::npos ? rest.size() : line_end + 1);
    const std::size_t separator = line.find_first_of("=:");
    if (separator == std::string_view::npos) {
      continue;
    }
    const std::string key = one_line(line.substr(0, separator));
    fields.values[key] = one_line(line.substr(separator + 1), 4096);
    if (key == "ElementDataFile") {
      fields.header_bytes = text.size() - rest.size();
      return fields;
    }
  }
  throw bad_file(path, "has no ElementDataFile in its header");
}

// HeaderSize: what MetaIO skips of a data file of its own. -1 says that the samples are the last bytes, whatever is
// before them.
std::uint64_t skipped_bytes(const MetaFields& fields, const fs::path& path) {
  const std::string value = fields.value_of("HeaderSize");
  const std::int64_t bytes = value.empty() ? 0 : TextScanner({}, path).to_integer(value, "a number of bytes in HeaderSize");
  return static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
}

void check_stored_data(const fs::path& path, const ImageHeader& header) {
  const std::uint64_t promised = header.sample_count() * bytes_per_sample(header.type);
  const MetaFields fields = read_fields(path);
  const std::string file_name = fields.value_of("ElementDataFile");
  if (file_name.starts_with("LIST") || file_name.find('%') != std::string::npos) {
    throw unsupported(path, "its samples are spread over several files (" + file_name + "), expected one file");
  }
  const bool is_local = file_name == "LOCAL" || file_name == "Local" || file_name == "local";
  const fs::path data_file = is_local ? path : path.parent_path() / file_name;
  check_data_file(path, data_file, [&] {
    const std::uint64_t file_bytes = readable_file_size(data_file);
    const std::uint64_t offset = std::min(is_local ? fields.header_bytes : skipped_bytes(fields, path), file_bytes);
    if (fields.is_true("CompressedData")) {
      require_possible_bytes(data_file, promised, file_bytes - offset);
      require_inflated_bytes(data_file, offset, promised);
    } else if (!fields.value_of("BinaryData").empty() && !fields.is_true("BinaryData")) {
      require_possible_bytes(data_file, header.sample_count(), file_bytes - offset, 1);
      require_stored_numbers(data_file, std::string_view(file_contents(data_file)).substr(offset), header.sample_count());
    } else {
      require_stored_bytes(data_file, promised, file_bytes - offset);
    }
  });
}

}  // namespace

VolumeFile read_meta_image(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;
  VolumeFile file;
  file.source.format = "MetaImage";
  file.volume = read_itk_volume(*itk::MetaImageIO::New(), path, "MetaImage file",
                         [&](const ImageHeader& header) { check_stored_data(path, header); }, options);
  return file;
}

}  // namespace isoatlas::io
