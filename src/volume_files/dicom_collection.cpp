// SPDX-License-Identifier: Apache-2.0
#include "volume_files/dicom_collection.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/file_name.h"
#include "files/file_error.h"
#include "volume_files/dicom_contents.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::string name_list(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    list += (i > 0 ? ", " : "") + dicom_text(names[i]);
  }
  return list + (names.size() > kMost ? ", ..." : "");
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Lists all files below a folder, sorted by name. Follows links to folders, but enters no folder
/// twice.
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
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
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

// True for files without an extension, and for extensions that are a number or usual for DICOM
// files: "IM012", "a.dcm", "1.2.840.7".
bool is_named_like_dicom(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension.empty() || extension == ".dcm" || extension == ".ima" || extension == ".dicom" ||
         extension.find_first_not_of("0123456789", 1) == std::string::npos;
}

bool have_same_bytes(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::file_size(a, ignored) == fs::file_size(b, ignored) &&
         file_contents(a) == file_contents(b);
}

// Removes copies: a file that is in the folder twice is one slice.
void remove_copies(std::vector<DicomFrame>& frames, std::vector<std::string>& warnings) {
  std::ranges::stable_sort(frames, {}, [](const DicomFrame& frame) {
    return std::tuple(frame.image->series, frame.position.x, frame.position.y, frame.position.z);
  });
  const auto is_copy = [](const DicomFrame& first, const DicomFrame& second) {
    return first.image->frames == 1 && second.image->frames == 1 &&
           first.image->series == second.image->series && first.position == second.position &&
           first.image->instance_number == second.image->instance_number &&
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
    warnings.push_back(counted(copies.size(), "file") +
                       (copies.size() == 1 ? " is a copy" : " are copies") +
                       " of another and skipped: " + name_list(copies));
  }
}

/// The files to read and the skipped files.
class Collection {
 public:
  Collection(fs::path root, std::uint64_t max_memory)
      : root_(std::move(root)), max_memory_(max_memory) {}

  void add_folder() {
    for (const fs::path& file : FolderWalk(true).files_of(root_)) {
      const std::string name = file.lexically_relative(root_).string();
      if (is_named_like_dicom(file)) {
        readable_file_size(file);  // an empty or unreadable file is a lost slice
      }
      if (looks_like_dicom(file)) {
        add_file(file, name);
      } else {
        skipped_["not DICOM"].push_back(name);
      }
    }
  }

  /// Adds one file; if it is a slice, also the other files of its series in the same folder.
  void add_file_with_neighbours() {
    if (!looks_like_dicom(root_)) {
      throw bad_file(root_, "is not a DICOM file");
    }
    DicomFileFrames own = read_dicom_frames(root_, root_.filename().string(), max_memory_);
    if (own.is_directory) {
      throw unsupported(
          root_, "is a DICOMDIR, a list of files; expected the folder, or a file with an image");
    }
    if (!own.unusable.empty()) {
      throw unsupported(root_,
                        own.unusable + "; expected a DICOM image that is a slice or a volume");
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

  /// Moves out the usable frames. @throws Error if no frame is usable
  std::vector<DicomFrame> take_frames(std::vector<std::string>& warnings) {
    leave_out_localizers();
    require_frames();
    refuse_unusable_members();
    for (const auto& [what, names] : skipped_) {
      warnings.push_back(counted(names.size(), "file") + (names.size() == 1 ? " is " : " are ") +
                         "skipped (" + what + "): " + name_list(names));
    }
    remove_copies(frames_, warnings);
    return std::move(frames_);
  }

 private:
  // Nothing if the file is not DICOM after all: it looked like DICOM, but has no "DICM" and cannot
  // be parsed.
  std::optional<DicomFileFrames> frames_in(const fs::path& file, const std::string& name) const {
    try {
      return read_dicom_frames(file, name, max_memory_);
    } catch (const Error&) {
      if (has_dicom_mark(file)) {
        throw;
      }
      return std::nullopt;
    }
  }

  void add_file(const fs::path& file, const std::string& name) {
    const std::optional<DicomFileFrames> read = frames_in(file, name);
    if (!read) {
      skipped_["not DICOM"].push_back(name);
      return;
    }
    const DicomFileFrames& found = *read;
    if (found.is_directory) {
      return;
    }
    if (!found.is_image) {
      skipped_[found.unusable].push_back(name);
      return;
    }
    if (!found.unusable.empty()) {
      unusable_.emplace_back(file, found);
      skipped_[found.unusable].push_back(name);
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
    const std::optional<DicomFileFrames> read = frames_in(file, file.filename().string());
    if (!read || read->series != own.series || !read->is_image) {
      return;
    }
    const DicomFileFrames& found = *read;
    if (!found.unusable.empty()) {
      unusable_.emplace_back(file, found);
      skipped_[found.unusable].push_back(file.filename().string());
    }
    frames_.insert(frames_.end(), found.frames.begin(), found.frames.end());
  }

  // Overview images belong to a series but are not slices of its volume.
  void leave_out_localizers() {
    const auto is_localizer = [](const DicomFrame& frame) { return frame.image->is_localizer; };
    if (std::ranges::all_of(frames_, is_localizer)) {
      return;
    }
    for (const DicomFrame& frame : frames_) {
      if (is_localizer(frame)) {
        skipped_["localizer"].push_back(frame.name());
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
    for (const auto& [what, names] : skipped_) {
      others +=
          (others.empty() ? "; it has " : ", ") + counted(names.size(), "file") + " (" + what + ")";
    }
    throw bad_file(root_,
                   "is a folder without DICOM images or TIFF or PNG slices, expected a series or a "
                   "stack of them" +
                       others);
  }

  // An image of a series that looks like a slice but cannot be one would leave a gap in the volume.
  void refuse_unusable_members() const {
    for (const auto& [file, found] : unusable_) {
      const bool is_member =
          std::ranges::any_of(frames_, [&, &unusable = found](const DicomFrame& frame) {
            return frame.image->series == unusable.series && frame.image->rows == unusable.rows &&
                   frame.image->columns == unusable.columns;
          });
      if (is_member) {
        throw unsupported(file, found.unusable +
                                    ", unlike the other slices of its series; move it out "
                                    "of the folder to read the series");
      }
    }
  }

  fs::path root_;
  std::uint64_t max_memory_;
  std::vector<DicomFrame> frames_;
  std::vector<std::pair<fs::path, DicomFileFrames>> unusable_;
  std::map<std::string, std::vector<std::string>> skipped_;  // by reason
};

}  // namespace

std::vector<DicomFrame> frames_of_folder(const fs::path& folder, std::uint64_t max_memory,
                                         std::vector<std::string>& warnings) {
  Collection collection(folder, max_memory);
  collection.add_folder();
  return collection.take_frames(warnings);
}

std::vector<DicomFrame> frames_of_file(const fs::path& file, std::uint64_t max_memory,
                                       std::vector<std::string>& warnings) {
  Collection collection(file, max_memory);
  collection.add_file_with_neighbours();
  return collection.take_frames(warnings);
}

}  // namespace isoatlas::detail::io
