// SPDX-License-Identifier: Apache-2.0
// DICOM: a folder with the slices of one or more series, or one file with an image of one or more frames.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/library_messages.h"
#include "files/memory_limit.h"
#include "isoatlas/length_unit.h"
#include "volume_files/choice.h"
#include "volume_files/dicom_codec.h"
#include "volume_files/dicom_image.h"
#include "volume_files/dicom_samples.h"
#include "volume_files/dicom_volumes.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

constexpr double kSameSpacingTolerance = 1e-3;  // relative

/// All files below a folder, by name. Links to folders are followed, but no folder is entered twice.
class FolderWalk {
 public:
  explicit FolderWalk(bool enters_subfolders) : enters_subfolders_(enters_subfolders) {}

  std::vector<fs::path> files_of(const fs::path& folder) {
    enter(folder);
    std::ranges::sort(files_);
    return std::move(files_);
  }

 private:
  void enter(const fs::path& folder) {
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !entered_.insert(real).second) {
      return;
    }
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      std::error_code ignored;
      if (entry->path().filename().string().starts_with('.')) {
        continue;  // hidden
      }
      if (entry->is_regular_file(ignored)) {
        files_.push_back(entry->path());
      } else if (enters_subfolders_ && entry->is_directory(ignored)) {
        enter(entry->path());
      }
    }
    if (error) {
      throw bad_file(folder, "cannot be listed: " + error.message());
    }
  }

  bool enters_subfolders_;
  std::set<fs::path> entered_;
  std::vector<fs::path> files_;
};

// Files without extension, and those whose extension is a number or one that DICOM files have: "IM012", "a.dcm", "1.2.840.7".
bool is_named_like_dicom(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension.empty() || extension == ".dcm" || extension == ".ima" || extension == ".dicom" ||
         extension.find_first_not_of("0123456789", 1) == std::string::npos;
}

std::string name_list(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    list += (i > 0 ? ", " : "") + dicom_text(names[i]);
  }
  return list + (names.size() > kMost ? ", ..." : "");
}

std::string counted(std::size_t count, const std::string& noun) { return std::to_string(count) + " " + noun + (count == 1 ? "" : "s"); }

/// What there is to read, and what is left out.
class Collection {
 public:
  Collection(fs::path root, std::uint64_t max_memory) : root_(std::move(root)), max_memory_(max_memory) {}

  void add_folder() {
    for (const fs::path& file : FolderWalk(true).files_of(root_)) {
      const std::string name = file.lexically_relative(root_).string();
      if (is_named_like_dicom(file)) {
        readable_file_size(file);  // an empty or unreadable one is a slice that was lost
      }
      if (looks_like_dicom(file)) {
        add_file(file, name);
      } else {
        left_out_["no DICOM"].push_back(name);
      }
    }
  }

  /// One file; if it is a slice, the others of its series beside it as well.
  void add_file_with_neighbours() {
    if (!looks_like_dicom(root_)) {
      throw bad_file(root_, "is not a DICOM file");
    }
    DicomFileFrames own = read_dicom_frames(root_, root_.filename().string(), max_memory_);
    if (own.is_directory) {
      throw unsupported(root_, "is a DICOMDIR, a list of files; expected the folder, or a file with an image");
    }
    if (!own.unusable.empty()) {
      throw unsupported(root_, own.unusable + "; expected a DICOM image that is a slice or a volume");
    }
    const bool is_slice = own.frames.size() == 1;
    if (!is_slice) {
      frames_ = std::move(own.frames);
      return;
    }
    const fs::path folder = root_.has_parent_path() ? root_.parent_path() : fs::path(".");
    for (const fs::path& file : FolderWalk(false).files_of(folder)) {
      const bool is_own = file.filename() == root_.filename();
      if (!is_own && (readable_neighbour(file) && looks_like_dicom(file))) {
        add_neighbour(file, own);
      }
    }
    frames_.push_back(std::move(own.frames.front()));
    std::ranges::sort(frames_, {}, [](const DicomFrame& frame) { return frame.image->path; });
  }

  /// The usable frames. @throws Error if there are none
  std::vector<DicomFrame> take_frames(std::vector<std::string>& warnings) {
    leave_out_localizers();
    require_frames();
    refuse_unusable_members();
    for (const auto& [what, names] : left_out_) {
      warnings.push_back(counted(names.size(), "file") + (names.size() == 1 ? " is " : " are ") + "left out (" + what +
                         "): " + name_list(names));
    }
    return std::move(frames_);
  }

 private:
  void add_file(const fs::path& file, const std::string& name) {
    DicomFileFrames found;
    try {
      found = read_dicom_frames(file, name, max_memory_);
    } catch (const Error&) {
      if (has_dicom_mark(file)) {
        throw;
      }
      left_out_["no DICOM"].push_back(name);
      return;
    }
    if (found.is_directory) {
      return;
    }
    if (!found.is_image) {
      left_out_[found.unusable].push_back(name);
      return;
    }
    if (!found.unusable.empty()) {
      unusable_.emplace_back(file, found);
      left_out_[found.unusable].push_back(name);
    }
    frames_.insert(frames_.end(), found.frames.begin(), found.frames.end());
  }

  static bool readable_neighbour(const fs::path& file) {
    if (is_named_like_dicom(file)) {
      readable_file_size(file);
    }
    std::error_code ignored;
    return fs::file_size(file, ignored) > 0 && !ignored;
  }

  void add_neighbour(const fs::path& file, const DicomFileFrames& own) {
    DicomFileFrames found = read_dicom_frames(file, file.filename().string(), max_memory_);
    if (found.series != own.series || !found.is_image) {
      return;
    }
    if (!found.unusable.empty()) {
      unusable_.emplace_back(file, found);
      left_out_[found.unusable].push_back(file.filename().string());
    }
    frames_.insert(frames_.end(), found.frames.begin(), found.frames.end());
  }

  // Overview images lie in series with slices that they are no part of.
  void leave_out_localizers() {
    const auto is_localizer = [](const DicomFrame& frame) { return frame.image->is_localizer; };
    if (std::ranges::all_of(frames_, is_localizer)) {
      return;
    }
    for (const DicomFrame& frame : frames_) {
      if (is_localizer(frame)) {
        left_out_["localizer"].push_back(frame.name());
      }
    }
    std::erase_if(frames_, is_localizer);
  }

  void require_frames() const {
    if (!frames_.empty()) {
      return;
    }
    if (!unusable_.empty()) {
      const auto& [file, found] = unusable_.front();
      throw unsupported(file, found.unusable + "; expected slices of a volume");
    }
    std::string others;
    for (const auto& [what, names] : left_out_) {
      others += (others.empty() ? "; it has " : ", ") + counted(names.size(), "file") + " (" + what + ")";
    }
    throw bad_file(root_, "is a folder without DICOM images, expected a DICOM series" + others);
  }

  // An image that looks like a slice of a series but cannot be one would be missing from it.
  void refuse_unusable_members() const {
    for (const auto& [file, found] : unusable_) {
      const bool is_member = std::ranges::any_of(frames_, [&, &unusable = found](const DicomFrame& frame) {
        return frame.image->series == unusable.series && frame.image->rows == unusable.rows && frame.image->columns == unusable.columns;
      });
      if (is_member) {
        throw unsupported(file, found.unusable + ", which the other slices of its series are not; take it out of the folder to read them");
      }
    }
  }

  fs::path root_;
  std::uint64_t max_memory_;
  std::vector<DicomFrame> frames_;
  std::vector<std::pair<fs::path, DicomFileFrames>> unusable_;
  std::map<std::string, std::vector<std::string>> left_out_;  // by reason
};

// The number of the entry that a UID, or the end of one, names; otherwise what was wanted as it is.
std::string entry_wanted(const std::vector<DicomSeries>& all, const std::string& wanted) {
  const bool is_number = !wanted.empty() && wanted.size() < 6 && wanted.find_first_not_of("0123456789") == std::string::npos;
  if (wanted.empty() || (is_number && std::stoul(wanted) < all.size())) {
    return wanted;
  }
  std::string found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].image().series.ends_with(wanted)) {
      if (!found.empty()) {
        return wanted;  // names several
      }
      found = std::to_string(i);
    }
  }
  return found.empty() ? wanted : found;
}

DicomSeries choose_series(const fs::path& path, std::vector<DicomSeries> all, const ReadOptions& options, VolumeSource& source) {
  FileChoice choice{"series", {}, {}};
  for (const DicomSeries& series : all) {
    choice.entries.push_back(series.description());
  }
  const std::size_t entry = take_choice(path, source, std::move(choice), entry_wanted(all, options.series));
  return std::move(all[entry]);
}

DicomStack choose_volume(const fs::path& path, DicomSeries series, const ReadOptions& options, VolumeSource& source) {
  std::size_t entry = 0;
  if (series.volumes.size() > 1) {
    entry = take_choice(path, source, FileChoice{"time", series.volume_names, {}}, options.time);
    source.decisions.push_back({"time", series.volume_names[entry]});
  }
  return std::move(series.volumes[entry]);
}

bool have_same_bytes(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::file_size(a, ignored) == fs::file_size(b, ignored) && file_contents(a) == file_contents(b);
}

// A file that was copied into the folder twice is one slice.
void leave_out_copies(std::vector<DicomFrame>& frames, std::vector<std::string>& warnings) {
  std::ranges::stable_sort(frames, {}, [](const DicomFrame& frame) {
    return std::tuple(frame.image->series, frame.position.x, frame.position.y, frame.position.z);
  });
  const auto is_copy = [](const DicomFrame& first, const DicomFrame& second) {
    return first.image->frames == 1 && second.image->frames == 1 && first.image->series == second.image->series &&
           first.position == second.position && first.image->instance_number == second.image->instance_number &&
           have_same_bytes(first.image->path, second.image->path);
  };
  std::vector<std::string> copies;
  std::vector<DicomFrame> kept;
  for (DicomFrame& frame : frames) {
    if (!kept.empty() && is_copy(kept.back(), frame)) {
      copies.push_back(frame.image->name);
    } else {
      kept.push_back(std::move(frame));
    }
  }
  frames = std::move(kept);
  if (!copies.empty()) {
    warnings.push_back(counted(copies.size(), "file") + (copies.size() == 1 ? " is a copy" : " are copies") + " of another and left out: " +
                       name_list(copies));
  }
}

// ITK's order of operations, so that a grid has the same bits wherever it was read.
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
    throw Error(stack.is_at_one_place ? ErrorCode::unsupported : ErrorCode::bad_file, one_line(path.string() + ": " + stack.problem, 2000));
  }
  const DicomFrame& first = stack.frames.front();
  for (const DicomFrame& frame : stack.frames) {
    if (!frame.image->damage.empty()) {
      throw bad_file(frame.image->path, frame.image->damage);
    }
    if (std::abs(frame.spacing_x - first.spacing_x) > kSameSpacingTolerance * first.spacing_x ||
        std::abs(frame.spacing_y - first.spacing_y) > kSameSpacingTolerance * first.spacing_y) {
      throw bad_file(frame.image->path, "differs in pixel spacing (" + dicom_number(frame.spacing_x) + " x " + dicom_number(frame.spacing_y) +
                                            ", not " + dicom_number(first.spacing_x) + " x " + dicom_number(first.spacing_y) + ") from " +
                                            first.name() + " of the same series");
    }
  }
}

std::string range_text(const std::vector<DicomFrame>& frames, double DicomFrame::*member) {
  const auto [low, high] = std::ranges::minmax(frames, {}, member);
  return dicom_number(low.*member) + (low.*member == high.*member ? "" : " to " + dicom_number(high.*member));
}

void add_decisions(const DicomSeries& series, const std::vector<DicomFrame>& frames, VolumeSource& source) {
  const DicomImage& image = *frames.front().image;
  const auto add = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) {
      source.decisions.push_back({key, value});
    }
  };
  add("series", series.description());
  const bool is_rescaled = std::ranges::any_of(frames, [](const DicomFrame& f) { return f.slope != 1 || f.intercept != 0; });
  if (!image.dose_units.empty()) {
    add("dose", "DoseGridScaling " + range_text(frames, &DicomFrame::slope) + ", " + image.dose_units);
  } else if (is_rescaled) {
    add("rescale", "slope " + range_text(frames, &DicomFrame::slope) + ", intercept " + range_text(frames, &DicomFrame::intercept) +
                       (image.rescale_type.empty() ? "" : " (" + image.rescale_type + ")"));
  }
  add("slices", image.frame_places.empty() ? "by ImagePositionPatient" : "by " + image.frame_places);
  add("compression", image.pixels.is_compressed ? compression_name(image.transfer_syntax) : "");
  add("lossy", image.is_lossy ? "the image was compressed with loss" : "");
  add("photometric interpretation", image.is_inverted_display ? "MONOCHROME1; values are as stored" : "");
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

Volume read_stack(const fs::path& path, const DicomStack& stack, const ReadOptions& options, std::uint64_t max_memory) {
  const DicomFrame& first = stack.frames.front();
  const std::array<std::size_t, 3> size{first.image->columns, first.image->rows, stack.frames.size()};
  Volume volume;
  volume.type = dicom_sample_type(stack.frames);
  if (size[2] == 1) {
    throw unsupported(path, "has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x 1 samples, a single slice (" +
                                first.name() + "); expected at least 2 slices of its series");
  }
  const std::uint64_t bytes = checked_sample_bytes(path, size, bytes_per_sample(volume.type));
  std::array<Vec3, 3> axes = orthogonal_axes(first);
  axes[2] = stack.step;  // grid_of_file moves its length to the spacing
  volume.grid = grid_of_file(path, size, {first.spacing_x, first.spacing_y, 1}, first.position, axes);
  volume.grid.unit = LengthUnit::millimetre;
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  read_dicom_samples(stack.frames, volume.type, max_memory, samples.get());
  volume.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace

VolumeFile read_dicom(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;  // the decoders of GDCM write to std::cerr
  const std::uint64_t max_memory = options.max_memory == 0 ? default_memory_limit() : options.max_memory;
  std::error_code ignored;
  Collection collection(path, max_memory);
  if (fs::is_directory(path, ignored)) {
    collection.add_folder();
  } else {
    collection.add_file_with_neighbours();
  }
  VolumeFile file;
  VolumeSource& source = file.source;
  std::vector<DicomFrame> frames = collection.take_frames(source.warnings);
  leave_out_copies(frames, source.warnings);
  const bool is_multi_frame = std::ranges::any_of(frames, [](const DicomFrame& frame) { return frame.image->frames > 1; });
  source.format = is_multi_frame ? "multi-frame DICOM" : "DICOM series";
  const DicomSeries series = choose_series(path, series_of(std::move(frames)), options, source);
  const DicomStack stack = choose_volume(path, series, options, source);
  source.reader = stack.frames.front().image->pixels.is_compressed ? decoder_name() : "isoatlas";
  require_readable(path, stack);
  add_image_warnings(stack.frames, source);
  add_decisions(series, stack.frames, source);
  file.volume = read_stack(path, stack, options, max_memory);
  return file;
}

}  // namespace isoatlas::io
