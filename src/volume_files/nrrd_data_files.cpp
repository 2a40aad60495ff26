// SPDX-License-Identifier: Apache-2.0
#include "volume_files/nrrd_data_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/header_text.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

struct Encoding {
  SampleEncoding samples = SampleEncoding::binary;
  Packing packing = Packing::none;
};

Encoding encoding_of(const NrrdHeader& header, const fs::path& path) {
  const std::string name = lower_case(required_field(header, path, "encoding"));
  if (name == "raw") return {};
  if (name == "gz" || name == "gzip") return {SampleEncoding::binary, Packing::deflate};
  if (name == "bz2" || name == "bzip2") return {SampleEncoding::binary, Packing::bzip2};
  if (name == "txt" || name == "text" || name == "ascii")
    return {SampleEncoding::text, Packing::none};
  if (name == "hex") return {SampleEncoding::hexadecimal, Packing::none};
  throw unsupported(path, "has samples in the encoding '" + one_line(name, 40) +
                              "', expected raw, ascii, hex, gzip or bzip2");
}

std::int64_t skip_of(const NrrdHeader& header, const fs::path& path, std::string_view name,
                     std::int64_t least) {
  const std::string_view value = header.field(name);
  const std::optional<std::int64_t> skip =
      value.empty() ? std::optional<std::int64_t>(0) : integer_of(value);
  if (!skip || *skip < least) {
    throw bad_file(path, "its header field '" + std::string(name) + "' is '" + one_line(value, 40) +
                             "', expected a number of at least " + std::to_string(least));
  }
  return *skip;
}

/// The number of bytes of the next lines of `piece`.
std::uint64_t bytes_of_lines(const SamplePiece& piece, std::int64_t lines) {
  ByteSource source(piece.file, piece.offset, piece.packing);
  source.skip(piece.skipped_bytes);
  std::array<char, 4096> buffer{};
  std::uint64_t bytes = 0;
  while (lines > 0) {
    const std::size_t count = source.read(buffer.data(), buffer.size());
    if (count == 0) {
      throw bad_file(piece.file, "is cut off: it ends " + std::to_string(lines) +
                                     " lines before its samples begin");
    }
    for (std::size_t i = 0; i < count && lines > 0; ++i, ++bytes) {
      lines -= buffer[i] == '\n' ? 1 : 0;
    }
  }
  return bytes;
}

/// Moves the beginning of a piece by `bytes` of the data before its own compression.
void advance(SamplePiece& piece, std::uint64_t bytes) {
  (piece.packing == Packing::none ? piece.offset : piece.skipped_bytes) += bytes;
}

/// Skips from the end: -1 means that the samples are the file's last bytes, -2 that one byte
/// follows them, and so on.
void skip_from_end(SamplePiece& piece, const fs::path& header_file, std::uint64_t bytes_after,
                   std::uint64_t piece_bytes) {
  if (piece.packing != Packing::none) {
    throw unsupported(
        header_file,
        "has 'byte skip: -1' with compressed samples, expected it with the encoding raw only");
  }
  const std::uint64_t file_bytes = readable_file_size(piece.file);
  require_stored_bytes(piece.file, piece_bytes, file_bytes - std::min(bytes_after, file_bytes));
  piece.offset = file_bytes - bytes_after - piece_bytes;
}

bool is_gzipped_at(const fs::path& file, std::uint64_t offset) {
  std::array<char, 2> mark{};
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(mark.data(), mark.size());
  return mark[0] == '\x1F' && mark[1] == '\x8B';
}

/// Sets the compression of the samples. Teem reads samples whose header states gzip but which are
/// not gzipped as they are, so such files exist.
void unpack(SamplePiece& piece, const fs::path& header_file, Packing packing,
            std::uint64_t piece_bytes, VolumeSource& source) {
  if (packing == Packing::none) {
    return;
  }
  if (piece.packing != Packing::none) {
    throw unsupported(
        header_file,
        "is gzipped as a whole and has compressed samples inside, expected one compression");
  }
  const bool is_plain =
      packing == Packing::deflate && !is_gzipped_at(piece.file, piece.offset) &&
      readable_file_size(piece.file) - std::min(piece.offset, readable_file_size(piece.file)) ==
          piece_bytes;
  if (!is_plain) {
    piece.packing = packing;
  } else if (source.warnings.empty() ||
             source.warnings.back().find("not gzipped") == std::string::npos) {
    source.warnings.push_back("states that its samples are gzipped, but they are not gzipped");
  }
}

struct NrrdFileList {
  std::vector<std::string> names;
  std::size_t dimension = 0;  // dimension of the part of the array in each file
};

std::size_t piece_dimension(const fs::path& path, std::string_view word, std::size_t axes) {
  const std::int64_t dimension =
      word.empty() ? static_cast<std::int64_t>(axes) - 1 : integer_of(word).value_or(0);
  if (dimension < 1 || dimension > static_cast<std::int64_t>(axes)) {
    throw bad_file(path, "its data files are of dimension '" + one_line(word, 20) +
                             "', expected 1 to " + std::to_string(axes));
  }
  return static_cast<std::size_t>(dimension);
}

/// Reads "name%03d.raw <first> <last> <step> [<dimension>]". Nothing if `value` does not have this
/// form.
std::optional<NrrdFileList> numbered_files(const fs::path& path, std::string_view value,
                                           std::size_t axes) {
  const std::vector<std::string_view> words = words_of(value);
  if (words.size() < 4 || words.size() > 5 || !numbered_name(words[0], 0)) {
    return std::nullopt;
  }
  const std::optional<std::int64_t> first = integer_of(words[1]), last = integer_of(words[2]),
                                    step = integer_of(words[3]);
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto is_out_of_range = [](const std::optional<std::int64_t>& number) {
    return !number || *number > kMost || *number < -kMost;
  };
  if (is_out_of_range(first) || is_out_of_range(last) || is_out_of_range(step) || *step == 0 ||
      (*last - *first) / *step < 0) {
    throw bad_file(path, "its data file is '" + one_line(value, 80) +
                             "', expected a name with %d and the first and last number and a step");
  }
  NrrdFileList list{{}, piece_dimension(path, words.size() > 4 ? words[4] : "", axes)};
  const auto count = static_cast<std::uint64_t>((*last - *first) / *step) + 1;
  if (count > kMostDataFiles) {
    throw unsupported(path, "has " + std::to_string(count) + " data files, expected at most " +
                                std::to_string(kMostDataFiles));
  }
  const auto name = [&](std::uint64_t i) {
    return *numbered_name(words[0], *first + static_cast<std::int64_t>(i) * *step);
  };
  const fs::path first_file =
      data_file_path(path, name(0));  // throws before memory is allocated for all names
  check_data_file(path, first_file, [&] { readable_file_size(first_file); });
  for (std::uint64_t i = 0; i < count; ++i) {
    list.names.push_back(name(i));
  }
  return list;
}

NrrdFileList data_files(const NrrdHeader& header, const fs::path& path, std::size_t axes) {
  const std::string_view value = header.field("datafile");
  if (value.starts_with("LIST")) {
    return {header.listed_files, piece_dimension(path, trimmed(value.substr(4)), axes)};
  }
  if (std::optional<NrrdFileList> list = numbered_files(path, value, axes)) {
    return *list;
  }
  return {{std::string(value)}, axes};
}

/// Checks the number of files. Files with all dimensions of the array share its slowest axis
/// evenly.
void require_file_count(const fs::path& path, const NrrdFileList& list,
                        const std::vector<StoredAxis>& axes) {
  std::uint64_t expected = 1;
  for (std::size_t axis = list.dimension; axis < axes.size(); ++axis) {
    expected *= axes[axis].size;
  }
  const std::uint64_t found = list.names.size();
  const bool is_right =
      list.dimension < axes.size() ? found == expected : found > 0 && axes.back().size % found == 0;
  if (!is_right) {
    throw bad_file(path, "names " + std::to_string(found) + " data files, expected " +
                             (list.dimension < axes.size()
                                  ? std::to_string(expected)
                                  : "a divisor of the " + std::to_string(axes.back().size) +
                                        " samples of the last axis") +
                             ", each of dimension " + std::to_string(list.dimension));
  }
}

bool is_big_endian(const NrrdHeader& header, const fs::path& path, const SampleFormat& format) {
  const std::string endian = lower_case(header.field("endian"));
  if (endian == "big" || endian == "little") {
    return endian == "big";
  }
  if (endian.empty() &&
      (format.encoding == SampleEncoding::text || bytes_per_sample(format.type) == 1)) {
    return false;
  }
  throw bad_file(
      path,
      endian.empty()
          ? "does not state the byte order of its samples, expected a header field 'endian'"
          : "its header field 'endian' is '" + one_line(endian, 40) + "', expected little or big");
}

}  // namespace

void find_nrrd_samples(StoredSamples& stored, const NrrdHeader& header, const fs::path& path,
                       VolumeSource& source) {
  const Encoding encoding = encoding_of(header, path);
  stored.format = {encoding.samples, nrrd_sample_type(header, path)};
  stored.is_big_endian = is_big_endian(header, path, stored.format);
  const std::uint64_t all_bytes = checked_sample_count(path, stored.axes, stored.format.type) *
                                  bytes_per_sample(stored.format.type);
  if (header.field("datafile").empty()) {
    stored.pieces.push_back({path, 0, header.is_gzipped ? Packing::deflate : Packing::none, 0});
    advance(stored.pieces.front(), header.bytes);
  } else {
    const NrrdFileList list = data_files(header, path, stored.axes.size());
    require_file_count(path, list, stored.axes);
    for (const std::string& name : list.names) {
      stored.pieces.push_back({data_file_path(path, name), 0, Packing::none, 0});
    }
  }
  const std::int64_t line_skip = skip_of(header, path, "lineskip", 0);
  const std::int64_t byte_skip =
      skip_of(header, path, "byteskip", std::numeric_limits<std::int64_t>::min() + 1);
  if (byte_skip < 0 && stored.format.encoding != SampleEncoding::binary) {
    throw unsupported(path, "counts the bytes of its samples from the end (byte skip " +
                                std::to_string(byte_skip) +
                                "), expected this with raw samples only, but these are text");
  }
  const std::uint64_t piece_bytes = all_bytes / stored.pieces.size();
  for (SamplePiece& piece : stored.pieces) {
    check_data_file(path, piece.file, [&] {
      readable_file_size(piece.file);
      advance(piece, line_skip > 0 ? bytes_of_lines(piece, line_skip) : 0);
      unpack(piece, path, encoding.packing, piece_bytes, source);
      if (byte_skip < 0) {
        skip_from_end(piece, path, static_cast<std::uint64_t>(-byte_skip - 1), piece_bytes);
      } else {
        advance(piece, static_cast<std::uint64_t>(byte_skip));
      }
    });
  }
}

}  // namespace isoatlas::detail::io
