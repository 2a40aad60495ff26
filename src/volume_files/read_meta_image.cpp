// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/header_text.h"
#include "volume_files/meta_image_header.h"
#include "volume_files/readers.h"
#include "volume_files/stored_samples.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::string shape_of(const std::vector<std::size_t>& sizes) {
  std::string shape;
  for (const std::size_t size : sizes) {
    shape += (shape.empty() ? "" : " x ") + std::to_string(size);
  }
  return shape;
}

/// The first three axes. Missing axes get one sample, which checked_sample_bytes() refuses.
std::array<std::size_t, 3> volume_size(const fs::path& path,
                                       const std::vector<std::size_t>& sizes) {
  const bool is_volume = std::ranges::all_of(
      sizes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(sizes.size(), 4)),
      sizes.end(), [](std::size_t size) { return size == 1; });
  if (!is_volume) {
    throw unsupported(path, "has " + std::to_string(sizes.size()) + " dimensions (" +
                                shape_of(sizes) + "), expected 3, or 4 with time");
  }
  std::array<std::size_t, 3> size{1, 1, 1};
  std::copy_n(sizes.begin(), std::min<std::size_t>(sizes.size(), 3), size.begin());
  return size;
}

// ITK's files name the directions of a body and are in millimetres; "???" states that the
// directions are unknown.
void decide_unit(Grid& grid, const MetaImageHeader& header, VolumeSource& source) {
  const std::string_view orientation = header.field("AnatomicalOrientation");
  grid.unit = length_unit_named(header.field("DistanceUnits"));
  if (grid.unit != LengthUnit::unknown) {
    source.decisions.push_back({"unit", std::string(symbol(grid.unit))});
  } else if (source.has_spacing && !orientation.empty() &&
             orientation.find('?') == std::string_view::npos) {
    grid.unit = LengthUnit::millimetre;
    source.decisions.push_back(
        {"unit", "mm, by convention of files with an AnatomicalOrientation"});
  }
}

/// If both names of a field exist, the later one wins where MetaIO lets it overwrite the earlier.
/// The centre of rotation and the anatomical orientation do not change the matrix or the offset, as
/// in ITK.
Grid meta_grid(const fs::path& path, const MetaImageHeader& header, std::size_t axes,
               const std::array<std::size_t, 3>& size, VolumeSource& source) {
  std::vector<double> spacing(3, 1);
  std::vector<double> offset(3, 0);
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const auto stated_spacing = meta_numbers(path, header, {"ElementSpacing", "ElementSize"}, axes);
  source.has_spacing = stated_spacing.has_value();
  spacing = stated_spacing.value_or(spacing);
  offset = meta_numbers(path, header, {"ImagePosition", "Origin", "Offset", "Position"}, axes)
               .value_or(offset);
  if (const auto m =
          meta_numbers(path, header, {"TransformMatrix", "Rotation", "Orientation"}, axes * axes)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double* const row = m->data() + axis * axes;
      directions[axis] = {row[0], row[1], row[2]};
      if (std::any_of(row + 3, row + axes, [](double x) { return x != 0; })) {
        throw unsupported(
            path, std::string("its ") + "xyz"[axis] + " axis runs through both space and time");
      }
    }
  }
  Grid grid = grid_of_file(path, size, {spacing[0], spacing[1], spacing[2]},
                           {offset[0], offset[1], offset[2]}, directions);
  decide_unit(grid, header, source);
  return grid;
}

/// Warns of a rescaling in the header, which MetaIO and ITK do not apply either.
void warn_of_rescale(const fs::path& path, const MetaImageHeader& header, VolumeSource& source) {
  const double slope = meta_numbers(path, header, {"ElementToIntensityFunctionSlope"}, 1)
                           .value_or(std::vector<double>{1})[0];
  const double intercept = meta_numbers(path, header, {"ElementToIntensityFunctionOffset"}, 1)
                               .value_or(std::vector<double>{0})[0];
  if (slope != 1 || intercept != 0) {
    source.warnings.push_back("states an ElementToIntensityFunction (slope " +
                              one_line(header.field("ElementToIntensityFunctionSlope").empty()
                                           ? "1"
                                           : header.field("ElementToIntensityFunctionSlope"),
                                       20) +
                              ", offset " +
                              one_line(header.field("ElementToIntensityFunctionOffset").empty()
                                           ? "0"
                                           : header.field("ElementToIntensityFunctionOffset"),
                                       20) +
                              "), which is not applied, as in ITK");
  }
}

/// A data file with the given name, or with .gz appended to it.
SamplePiece detached_piece(const fs::path& path, const std::string& name, bool is_packed) {
  const fs::path file = data_file_path(path, name);
  fs::path packed = file;
  packed += ".gz";
  std::error_code ignored;
  if (!fs::exists(file, ignored) && fs::exists(packed, ignored)) {
    return {packed, 0, Packing::deflate, 0};
  }
  return {file, 0, is_packed ? Packing::deflate : Packing::none, 0};
}

struct MetaImageFileList {
  std::vector<std::string> names;
  std::size_t dimension = 0;  // dimension of the part of the image in each file
};

/// Reads "LIST [<dimension>]".
MetaImageFileList listed_files(const fs::path& path, const MetaImageHeader& header,
                               const std::vector<std::size_t>& sizes) {
  const std::vector<std::string_view> words = words_of(header.field("ElementDataFile"));
  const std::int64_t dimension = words.size() > 1 ? integer_of(words[1]).value_or(-1) : 0;
  if (dimension < 0) {
    throw bad_file(path, "its ElementDataFile is '" +
                             one_line(header.field("ElementDataFile"), 40) +
                             "', expected LIST and a dimension");
  }
  const auto stated = static_cast<std::size_t>(dimension);
  return {header.listed_files,
          stated == 0 || stated > sizes.size() ? sizes.size() - 1 : stated};  // as in MetaIO
}

/// Reads "name%03d.raw [<first> [<last> [<step>]]]", a file for each sample of the last axis.
/// Nothing if `value` does not have this form.
std::optional<MetaImageFileList> numbered_files(const fs::path& path, std::string_view value,
                                                const std::vector<std::size_t>& sizes) {
  const std::vector<std::string_view> words = words_of(value);
  std::vector<std::int64_t> numbers;
  std::size_t name_words = words.size();  // a name may contain blanks
  while (name_words > 1 && numbers.size() < 3 && integer_of(words[name_words - 1])) {
    numbers.insert(numbers.begin(), *integer_of(words[--name_words]));
  }
  const std::string_view& last_word = words[name_words - 1];
  const std::string_view pattern =
      value.substr(0, static_cast<std::size_t>(last_word.data() + last_word.size() - value.data()));
  if (!numbered_name(pattern, 0)) {
    return std::nullopt;
  }
  const auto count = static_cast<std::int64_t>(sizes.back());
  const std::int64_t first = numbers.empty() ? 1 : numbers[0];
  const std::int64_t range = numbers.size() > 1 ? numbers[1] - first : 0;
  const std::int64_t step = numbers.size() > 2        ? numbers[2]
                            : range != 0 && count > 1 ? range / (count - 1)
                                                      : 1;
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const bool is_in_range =
      std::ranges::all_of(numbers, [](std::int64_t n) { return n <= kMost && n >= -kMost; });
  if (!is_in_range || step == 0 || (numbers.size() > 1 && range / step < count - 1) ||
      static_cast<std::uint64_t>(count) > kMostDataFiles) {
    throw bad_file(path, "its ElementDataFile is '" + one_line(value, 80) +
                             "', expected numbers for the " + std::to_string(count) +
                             " samples of the last axis");
  }
  MetaImageFileList list{{}, sizes.size() - 1};
  const auto name = [&](std::int64_t i) { return *numbered_name(pattern, first + i * step); };
  const fs::path first_file =
      detached_piece(path, name(0), false).file;  // throws before memory is allocated for all names
  check_data_file(path, first_file, [&] { readable_file_size(first_file); });
  for (std::int64_t i = 0; i < count; ++i) {
    list.names.push_back(name(i));
  }
  return list;
}

void require_file_count(const fs::path& path, const MetaImageFileList& list,
                        const std::vector<std::size_t>& sizes) {
  std::uint64_t expected = 1;
  for (std::size_t axis = list.dimension; axis < sizes.size(); ++axis) {
    expected *= sizes[axis];
  }
  if (list.names.size() != expected) {
    throw bad_file(path, "names " + std::to_string(list.names.size()) + " data files, expected " +
                             std::to_string(expected) + ", each of dimension " +
                             std::to_string(list.dimension));
  }
}

/// Applies HeaderSize: the number of bytes before the samples in each file; -1 means that the
/// samples are the file's last bytes.
void skip_header(SamplePiece& piece, const fs::path& path, std::int64_t header_size,
                 std::uint64_t piece_bytes) {
  if (header_size > 0) {
    (piece.file == path && piece.skipped_bytes > 0 ? piece.skipped_bytes : piece.offset) =
        static_cast<std::uint64_t>(header_size);
  } else if (header_size == -1 && piece.packing != Packing::none) {
    throw unsupported(path,
                      "has 'HeaderSize = -1' with compressed samples, expected it with "
                      "uncompressed samples only");
  } else if (header_size == -1) {
    const std::uint64_t file_bytes = readable_file_size(piece.file);
    piece.offset = file_bytes - std::min(piece_bytes, file_bytes);
  }
}

/// The end of the compressed stream counts; CompressedDataSize is ignored, since it is often
/// missing or wrong.
void find_samples(StoredSamples& stored, const fs::path& path, const MetaImageHeader& header,
                  const std::vector<std::size_t>& sizes) {
  const std::string_view name = header.field("ElementDataFile");
  const bool is_binary = header.is_true("BinaryData", true);
  const bool is_packed = is_binary && header.is_true("CompressedData", false);
  stored.format = {is_binary ? SampleEncoding::binary : SampleEncoding::text,
                   meta_sample_type(path, header)};
  stored.is_big_endian = header.is_true(
      "BinaryDataByteOrderMSB",
      header.is_true("ElementByteOrderMSB", std::endian::native == std::endian::big));
  const std::uint64_t all_bytes = checked_sample_count(path, stored.axes, stored.format.type) *
                                  bytes_per_sample(stored.format.type);
  if (lower_case(name) == "local") {
    if (is_packed && header.is_gzipped) {
      throw unsupported(
          path,
          "is gzipped as a whole and has compressed samples inside, expected one compression");
    }
    stored.pieces.push_back(
        header.is_gzipped
            ? SamplePiece{path, 0, Packing::deflate, header.bytes}
            : SamplePiece{path, header.bytes, is_packed ? Packing::deflate : Packing::none, 0});
  } else {
    MetaImageFileList list{{std::string(name)}, sizes.size()};
    if (name.starts_with("LIST")) {
      list = listed_files(path, header, sizes);
    } else if (std::optional<MetaImageFileList> numbered = numbered_files(path, name, sizes)) {
      list = *numbered;
    }
    require_file_count(path, list, sizes);
    for (const std::string& file_name : list.names) {
      stored.pieces.push_back(detached_piece(path, file_name, is_packed));
    }
  }
  const std::int64_t header_size = meta_integer(path, header, "HeaderSize", 0, -1);
  for (SamplePiece& piece : stored.pieces) {
    check_data_file(path, piece.file, [&] {
      skip_header(piece, path, header_size, all_bytes / stored.pieces.size());
    });
  }
}

std::vector<StoredAxis> select(const fs::path& path, const MetaImageHeader& header,
                               const std::vector<std::size_t>& sizes, const ReadOptions& options,
                               VolumeSource& source) {
  std::vector<StoredAxis> axes;
  for (const std::size_t size : sizes) {
    axes.push_back({size, {}});
  }
  for (std::size_t axis = 3; axis < axes.size(); ++axis) {
    axes[axis].selected =
        axes[axis].size == 1
            ? 0
            : take_choice(path, source, checked_choice(path, "time", axes[axis].size),
                          options.time);
  }
  const std::int64_t channels = meta_integer(path, header, "ElementNumberOfChannels", 1, 1);
  if (channels > 1) {
    const FileChoice choice = checked_choice(path, "channel", static_cast<std::uint64_t>(channels));
    axes.insert(axes.begin(), {static_cast<std::uint64_t>(channels),
                               take_choice(path, source, choice, options.channel)});
  }
  return axes;
}

}  // namespace

VolumeFile read_meta_image(const fs::path& path, const ReadOptions& options) {
  VolumeFile file;
  file.source.format = "MetaImage";
  const MetaImageHeader header = read_meta_image_header(path);
  if (const std::string_view type = header.field("ObjectType");
      !type.empty() && lower_case(type) != "image") {
    throw unsupported(path, "is a MetaIO file of a " + one_line(type, 40) + ", expected an Image");
  }
  file.volume.view.type = meta_sample_type(path, header);
  const std::vector<std::size_t> sizes = meta_sizes(path, header);
  const std::array<std::size_t, 3> size = volume_size(path, sizes);
  checked_sample_bytes(path, size, bytes_per_sample(file.volume.view.type));
  file.volume.view.grid = meta_grid(path, header, sizes.size(), size, file.source);
  warn_of_rescale(path, header, file.source);
  StoredSamples stored;
  stored.axes = select(path, header, sizes, options, file.source);
  find_samples(stored, path, header, sizes);
  const std::shared_ptr<std::byte[]> samples =
      read_stored_samples(path, stored, options, file.source);
  file.volume.view.samples = samples.get();
  file.volume.owner = samples;
  return file;
}

}  // namespace isoatlas::detail::io
