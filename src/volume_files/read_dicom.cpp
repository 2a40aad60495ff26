// SPDX-License-Identifier: Apache-2.0
// DICOM: a folder with the slices of one or more series, or one file with an image of one or more
// frames.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/library_messages.h"
#include "files/memory_limit.h"
#include "isoatlas/length_unit.h"
#include "volume_files/choice.h"
#include "volume_files/dicom_codec.h"
#include "volume_files/dicom_collection.h"
#include "volume_files/dicom_image.h"
#include "volume_files/dicom_samples.h"
#include "volume_files/dicom_volumes.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr double kSameSpacingTolerance = 1e-3;  // relative

// The index of the entry whose UID, or the end of whose UID, is `wanted`; otherwise `wanted`
// unchanged.
std::string entry_wanted(const std::vector<DicomSeries>& all, const std::string& wanted) {
  const bool is_number = !wanted.empty() && wanted.size() < 6 &&
                         wanted.find_first_not_of("0123456789") == std::string::npos;
  if (wanted.empty() || (is_number && std::stoul(wanted) < all.size())) {
    return wanted;
  }
  std::string found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].image().series.ends_with(wanted)) {
      if (!found.empty()) {
        return wanted;  // `wanted` matches several entries
      }
      found = std::to_string(i);
    }
  }
  return found.empty() ? wanted : found;
}

DicomSeries choose_series(const fs::path& path, std::vector<DicomSeries> all,
                          const ReadOptions& options, VolumeSource& source) {
  FileChoice choice{"series", {}, {}};
  for (const DicomSeries& series : all) {
    choice.entries.push_back(series.description());
  }
  const std::size_t entry =
      take_choice(path, source, std::move(choice), entry_wanted(all, options.series));
  return std::move(all[entry]);
}

DicomStack choose_volume(const fs::path& path, DicomSeries series, const ReadOptions& options,
                         VolumeSource& source) {
  std::size_t entry = 0;
  if (series.volumes.size() > 1) {
    entry = take_choice(path, source, FileChoice{"time", series.volume_names, {}}, options.time);
    source.decisions.push_back({"time", series.volume_names[entry]});
  }
  return std::move(series.volumes[entry]);
}

// Computes in ITK's order of operations, so that a grid has the same bits as in ITK.
std::array<Vec3, 3> orthogonal_axes(const DicomFrame& frame) {
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto unit = [](const Vec3& v) {
    const double factor = 1 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return Vec3{factor * v.x, factor * v.y, factor * v.z};
  };
  const Vec3 normal = unit(cross(frame.along_row, frame.along_column));
  const Vec3 row = unit(cross(frame.along_column, normal));
  return {row, cross(normal, row), normal};
}

void require_readable(const fs::path& path, const DicomStack& stack) {
  if (!stack.problem.empty()) {
    throw Error(stack.has_equal_positions ? ErrorCode::unsupported : ErrorCode::bad_file,
                one_line(path.string() + ": " + stack.problem, 2000));
  }
  const DicomFrame& first = stack.frames.front();
  for (const DicomFrame& frame : stack.frames) {
    if (!frame.image->damage.empty()) {
      throw bad_file(frame.image->path, frame.image->damage);
    }
    if (std::abs(frame.spacing_x - first.spacing_x) > kSameSpacingTolerance * first.spacing_x ||
        std::abs(frame.spacing_y - first.spacing_y) > kSameSpacingTolerance * first.spacing_y) {
      throw bad_file(frame.image->path,
                     "differs in pixel spacing (" + dicom_number(frame.spacing_x) + " x " +
                         dicom_number(frame.spacing_y) + ", not " + dicom_number(first.spacing_x) +
                         " x " + dicom_number(first.spacing_y) + ") from " + first.name() +
                         " of the same series");
    }
  }
}

std::string range_text(const std::vector<DicomFrame>& frames, double DicomFrame::*member) {
  const auto [low, high] = std::ranges::minmax(frames, {}, member);
  return dicom_number(low.*member) +
         (low.*member == high.*member ? "" : " to " + dicom_number(high.*member));
}

void add_decisions(const DicomSeries& series, const std::vector<DicomFrame>& frames,
                   VolumeSource& source) {
  const DicomImage& image = *frames.front().image;
  const auto add = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) {
      source.decisions.push_back({key, value});
    }
  };
  add("series", series.description());
  const bool is_rescaled = std::ranges::any_of(
      frames, [](const DicomFrame& f) { return f.slope != 1 || f.intercept != 0; });
  if (!image.dose_units.empty()) {
    add("dose",
        "DoseGridScaling " + range_text(frames, &DicomFrame::slope) + ", " + image.dose_units);
  } else if (is_rescaled) {
    add("rescale", "slope " + range_text(frames, &DicomFrame::slope) + ", intercept " +
                       range_text(frames, &DicomFrame::intercept) +
                       (image.rescale_type.empty() ? "" : " (" + image.rescale_type + ")"));
  }
  add("slices",
      image.position_source.empty() ? "by ImagePositionPatient" : "by " + image.position_source);
  add("compression", image.pixels.is_compressed ? compression_name(image.transfer_syntax) : "");
  add("lossy", image.is_lossy ? "the image was compressed with loss" : "");
  add("photometric interpretation",
      image.is_inverted_display ? "MONOCHROME1; values are as stored" : "");
  add("padding value", image.padding.empty() ? "" : image.padding + "; kept as samples");
}

void add_image_warnings(const std::vector<DicomFrame>& frames, VolumeSource& source) {
  std::shared_ptr<const DicomImage> last;
  for (const DicomFrame& frame : frames) {
    if (frame.image == last) {
      continue;
    }
    last = frame.image;
    for (const std::string& warning : last->warnings) {
      if (std::ranges::find(source.warnings, warning) == source.warnings.end()) {
        source.warnings.push_back(warning);
      }
    }
  }
}

// Attributes that are usually the same in all slices of a volume. If they differ, the slices may be
// of several volumes.
void warn_of_differences(const std::vector<DicomFrame>& frames, VolumeSource& source) {
  constexpr std::array<std::string_view, 5> kSuspicious{"inversion time", "flip angle",
                                                        "image type", "sequence", "kernel"};
  std::map<std::string, std::set<std::string>> values;
  for (const DicomFrame& frame : frames) {
    for (const DicomLabel& label : *frame.labels) {
      if (label.kind == DicomLabel::Kind::volume ||
          std::ranges::find(kSuspicious, label.name) != kSuspicious.end()) {
        values[label.name].insert(label.value);
      }
    }
  }
  for (const auto& [name, found] : values) {
    if (found.size() > 1) {
      source.warnings.push_back("its slices differ in " + name + " (" + *found.begin() + ", " +
                                *std::next(found.begin()) + (found.size() > 2 ? ", ..." : "") +
                                "); they are read as one volume");
    }
  }
}

Volume read_stack(const fs::path& path, const DicomStack& stack, const ReadOptions& options,
                  std::uint64_t max_memory) {
  const DicomFrame& first = stack.frames.front();
  const std::array<std::size_t, 3> size{first.image->columns, first.image->rows,
                                        stack.frames.size()};
  Volume volume;
  volume.view.type = dicom_sample_type(stack.frames);
  if (size[2] == 1) {
    throw unsupported(path, "has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                                " x 1 samples, a single slice (" + first.name() +
                                "); expected at least 2 slices of its series");
  }
  const std::uint64_t bytes = checked_sample_bytes(path, size, bytes_per_sample(volume.view.type));
  std::array<Vec3, 3> axes = orthogonal_axes(first);
  axes[2] = stack.step;  // grid_of_file() moves its length to the spacing
  volume.view.grid =
      grid_of_file(path, size, {first.spacing_x, first.spacing_y, 1}, first.position, axes);
  volume.view.grid.unit = LengthUnit::millimetre;
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  read_dicom_samples(stack.frames, volume.view.type, max_memory, samples.get());
  volume.view.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace

VolumeFile read_dicom(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;  // DCMTK writes to std::cerr
  const std::uint64_t max_memory =
      options.max_memory == 0 ? default_memory_limit() : options.max_memory;
  std::error_code ignored;
  VolumeFile file;
  VolumeSource& source = file.source;
  std::vector<DicomFrame> frames = fs::is_directory(path, ignored)
                                       ? frames_of_folder(path, max_memory, source.warnings)
                                       : frames_of_file(path, max_memory, source.warnings);
  const bool is_multi_frame =
      std::ranges::any_of(frames, [](const DicomFrame& frame) { return frame.image->frames > 1; });
  source.format = is_multi_frame ? "multi-frame DICOM" : "DICOM series";
  const DicomSeries series = choose_series(path, series_of(std::move(frames)), options, source);
  const DicomStack stack = choose_volume(path, series, options, source);
  source.reader = decoder_name(*stack.frames.front().image);
  require_readable(path, stack);
  add_image_warnings(stack.frames, source);
  warn_of_differences(stack.frames, source);
  add_decisions(series, stack.frames, source);
  file.volume = read_stack(path, stack, options, max_memory);
  return file;
}

}  // namespace isoatlas::detail::io
