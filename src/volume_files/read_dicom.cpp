// SPDX-License-Identifier: Apache-2.0
// A folder with one DICOM series.
//
// ITK sorts the slices along their normal; the slices are then read and checked here. An itk::ImageSeriesReader would
// only warn about a missing slice and stretch the rest over the gap.
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "volume_files/dicom_file_end.h"
#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/itk_image.h"
#include "files/library_messages.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

// A slice may lie this fraction of the slice distance off its place: positions are written with few digits. A missing
// slice is off by a whole one.
constexpr double kPlaceTolerance = 0.1;
constexpr double kSameDirectionTolerance = 1e-3;
constexpr double kSameSpacingTolerance = 1e-3;  // relative

Vec3 difference(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double length(const Vec3& v) { return std::hypot(v.x, v.y, v.z); }

std::vector<std::string> files_of_only_series(const fs::path& folder) {
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(true);  // separates what cannot be one volume: other orientation, other matrix size
  names->SetDirectory(folder.string());
  const std::vector<std::string> series = names->GetSeriesUIDs();
  if (series.empty()) {
    throw bad_file(folder, "is a folder without DICOM images, expected one DICOM series");
  }
  if (series.size() > 1) {
    std::string list;
    for (const std::string& id : series) {
      list += (list.empty() ? "" : ", ") + id + " (" + std::to_string(names->GetFileNames(id).size()) + " files)";
    }
    throw unsupported(folder, "holds " + std::to_string(series.size()) +
                                  " DICOM series, expected one; put one in a folder of its own: " + one_line(list, 1000));
  }
  return names->GetFileNames(series.front());
}

void require_same_layout(const ImageHeader& first, const fs::path& first_path, const ImageHeader& slice, const fs::path& slice_path) {
  const auto differ = [&](const std::string& what) {
    throw bad_file(slice_path, "differs in " + what + " from " + first_path.filename().string() + " of the same series");
  };
  if (slice.size != first.size) {
    differ("image size");
  }
  if (slice.type != first.type) {
    differ("sample type (" + std::string(name(slice.type)) + ", not " + std::string(name(first.type)) + ")");
  }
  if (std::abs(slice.spacing.x - first.spacing.x) > kSameSpacingTolerance * std::abs(first.spacing.x) ||
      std::abs(slice.spacing.y - first.spacing.y) > kSameSpacingTolerance * std::abs(first.spacing.y)) {
    differ("pixel spacing");
  }
  if (length(difference(slice.axes[0], first.axes[0])) > kSameDirectionTolerance ||
      length(difference(slice.axes[1], first.axes[1])) > kSameDirectionTolerance) {
    differ("orientation");
  }
}

// The vector from slice to slice, after a check that it is the same everywhere. It need not be perpendicular to the
// slices: a CT with a tilted gantry is a sheared grid, and is kept as one.
Vec3 slice_step(const fs::path& folder, const std::vector<std::string>& files, const std::vector<Vec3>& positions) {
  const auto file_name = [&](std::size_t i) { return fs::path(files[i]).filename().string(); };
  std::vector<Vec3> steps;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    steps.push_back(difference(positions[i], positions[i - 1]));
    if (length(steps.back()) == 0) {
      throw unsupported(folder,
                        "has several slices at one place (" + file_name(i - 1) + " and " + file_name(i) + "): more than one volume?");
    }
  }
  std::vector<Vec3> by_length = steps;
  const auto middle = by_length.begin() + static_cast<std::ptrdiff_t>(by_length.size() / 2);
  std::nth_element(by_length.begin(), middle, by_length.end(), [](const Vec3& a, const Vec3& b) { return length(a) < length(b); });
  const Vec3 usual = *middle;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (length(difference(steps[i], usual)) > kPlaceTolerance * length(usual)) {
      throw bad_file(folder, "slices are not evenly spaced: " + std::to_string(length(steps[i])) + " from " + file_name(i) + " to " +
                                 file_name(i + 1) + ", usually " + std::to_string(length(usual)) + "; is a slice missing?");
    }
  }
  const auto count = static_cast<double>(steps.size());
  const Vec3 whole = difference(positions.back(), positions.front());
  return {whole.x / count, whole.y / count, whole.z / count};
}

}  // namespace

VolumeFile read_dicom(const fs::path& folder, const ReadOptions& options) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      require_whole_dicom_file(entry.path());
    }
  }
  const LibraryMessages messages;
  std::vector<std::string> files;
  translate_itk_errors(folder, [&] { files = files_of_only_series(folder); });

  ImageHeader header;
  std::vector<Vec3> positions;
  for (const std::string& file : files) {
    const auto image_io = itk::GDCMImageIO::New();
    const ImageHeader slice = read_itk_header(*image_io, file, "DICOM image");
    if (positions.empty()) {
      header = slice;
    }
    require_same_layout(header, files.front(), slice, file);
    positions.push_back(slice.origin);
  }
  const bool is_stack_of_slices = header.size[2] == 1;
  if (!is_stack_of_slices && files.size() > 1) {
    throw unsupported(folder, "holds several multi-frame DICOM files, expected one, or single slices");
  }
  if (is_stack_of_slices) {
    header.size[2] = files.size();
    if (files.size() > 1) {
      header.axes[2] = slice_step(folder, files, positions);
      header.spacing.z = 1;  // grid_of_file moves the length of the step here
    }
  }

  const std::uint64_t bytes = checked_sample_bytes(folder, header.size, bytes_per_sample(header.type));
  Volume volume;
  volume.grid = grid_of_file(folder, header.size, header.spacing, header.origin, header.axes);
  volume.type = header.type;
  const std::shared_ptr<std::byte[]> samples = allocate_samples(folder, bytes, options);
  const std::uint64_t bytes_per_file = bytes / files.size();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto image_io = itk::GDCMImageIO::New();
    read_itk_header(*image_io, files[i], "DICOM image");
    read_itk_samples(*image_io, files[i], samples.get() + i * bytes_per_file);
  }
  volume.samples = samples.get();
  volume.owner = samples;
  VolumeFile file{std::move(volume), {}};
  file.source.format = "DICOM series";
  return file;
}

}  // namespace isoatlas::io
