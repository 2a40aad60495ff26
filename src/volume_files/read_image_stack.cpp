// SPDX-License-Identifier: Apache-2.0
// A folder of TIFF or PNG images, each of which is a slice.
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/image_stack.h"
#include "volume_files/png_image.h"
#include "volume_files/readers.h"
#include "volume_files/rescale_samples.h"
#include "volume_files/slice_names.h"
#include "volume_files/tiff_spacing.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

bool is_png(const fs::path& path) { return lower_case_extension(path) == ".png"; }

bool is_image(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".tif" || extension == ".tiff" || extension == ".png";
}

// Names with a leading dot are skipped: macOS and others store metadata in such files.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && !entry->path().filename().string().starts_with('.')) {
      files.push_back(entry->path());
    }
  }
  return files;
}

bool is_dicom(const fs::path& path) {
  std::array<char, 132> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  return std::string_view(start.data() + 128, 4) == "DICM";
}

/// The images of a folder, all TIFF or all PNG.
class SliceFiles {
 public:
  virtual ~SliceFiles() = default;
  /// The size along x and y.
  virtual std::array<std::size_t, 2> size() const = 0;
  virtual SampleType type() const = 0;
  virtual std::uint64_t stored_bytes() const = 0;
  virtual std::vector<std::string> value_names() const = 0;
  virtual void read(const fs::path& file, std::size_t value, const ReadOptions& options,
                    std::byte* samples) const = 0;
};

Error differs(const fs::path& file, const std::string& format, const fs::path& first,
              const std::string& first_format) {
  return unsupported(file, "has " + format + ", " + first.filename().string() + " has " +
                               first_format + "; expected slices of one volume");
}

class TiffSlices final : public SliceFiles {
 public:
  TiffSlices(const fs::path& first, TiffStack& stack, VolumeSource& source) : first_(first) {
    TiffFile tiff(first);
    select_only_page(tiff);
    format_ = tiff.format();
    value_names_ = tiff.value_names();
    if (format_.photometric == PHOTOMETRIC_MINISWHITE) {
      source.decisions.push_back({"photometric", "white is zero; samples are kept as stored"});
    }
    stack = describe_slice(tiff, source);
    rescale_ = stack.rescale;
    source.reader = tiff.library_version();
  }
  std::array<std::size_t, 2> size() const override { return {format_.width, format_.height}; }
  SampleType type() const override {
    return rescale_ ? rescaled_type(format_.type(), rescale_->slope, rescale_->intercept)
                    : format_.type();
  }
  std::uint64_t stored_bytes() const override { return format_.stored_bytes(); }
  std::vector<std::string> value_names() const override { return value_names_; }
  void read(const fs::path& file, std::size_t value, const ReadOptions& options,
            std::byte* samples) const override {
    TiffFile tiff(file);
    select_only_page(tiff);
    if (const PageFormat format = tiff.format(); !format.has_same_samples(format_)) {
      throw differs(file, to_string(format), first_, to_string(format_));
    }
    VolumeSource ignored;
    if (describe_slice(tiff, ignored).rescale != rescale_) {
      throw unsupported(file, "has another calibration function than " +
                                  first_.filename().string() + ", expected slices of one volume");
    }
    if (!rescale_) {
      tiff.read_samples(format_, value, options, samples);
      return;
    }
    const std::size_t count = std::size_t{format_.width} * format_.height;
    std::vector<std::byte> stored(count * bytes_per_sample(format_.type()));
    tiff.read_samples(format_, value, options, stored.data());
    rescale_samples(format_.type(), stored.data(), count, rescale_->slope, rescale_->intercept,
                    samples);
  }

 private:
  static void select_only_page(TiffFile& tiff) {
    VolumeSource ignored;
    const std::vector<std::size_t> pages = pages_without_previews(tiff, ignored);
    if (pages.size() > 1) {
      throw unsupported(tiff.path(), "has " + std::to_string(pages.size()) +
                                         " pages, expected one slice in each file of the folder; "
                                         "read a file of many slices by its own path");
    }
    tiff.select(pages.front());
  }

  fs::path first_;
  PageFormat format_;
  std::vector<std::string> value_names_;
  std::optional<LinearRescale> rescale_;
};

class PngSlices final : public SliceFiles {
 public:
  PngSlices(const fs::path& first, VolumeSource& source)
      : first_(first), format_(png_format(first)) {
    source.reader = png_library_version();
    if (format_.is_palette) {
      source.decisions.push_back({"colours", "palette; samples are its indices"});
    }
    if (format_.has_alpha()) {
      source.decisions.push_back({"alpha", "ignored; all samples are opaque"});
    }
  }
  std::array<std::size_t, 2> size() const override { return {format_.width, format_.height}; }
  SampleType type() const override { return format_.type(); }
  std::uint64_t stored_bytes() const override { return format_.stored_bytes(); }
  std::vector<std::string> value_names() const override {
    return format_.values_per_sample >= 3 ? std::vector<std::string>{"red", "green", "blue"}
                                          : std::vector<std::string>{"grey"};
  }
  void read(const fs::path& file, std::size_t value, const ReadOptions& options,
            std::byte* samples) const override {
    if (const PngFormat format = png_format(file); format != format_) {
      throw differs(file, to_string(format), first_, to_string(format_));
    }
    read_png(file, format_, value, options, samples);
  }

 private:
  fs::path first_;
  PngFormat format_;
};

void require_possible_images(const std::vector<fs::path>& files, const SliceFiles& slices) {
  constexpr std::uint64_t kMostPerByte = 5000;
  const std::uint64_t image_bytes = slices.stored_bytes();
  for (const fs::path& file : files) {
    require_possible_bytes(file, image_bytes, readable_file_size(file), kMostPerByte);
  }
}

Volume read_all(const fs::path& folder, const std::vector<fs::path>& files,
                const SliceFiles& slices, std::size_t value, const TiffStack& stack,
                const Vec3& spacing, const ReadOptions& options) {
  const std::array<std::size_t, 3> size{slices.size()[0], slices.size()[1], files.size()};
  const std::uint64_t bytes = checked_sample_bytes(folder, size, bytes_per_sample(slices.type()));
  require_possible_images(files, slices);
  Volume volume;
  volume.view.grid = grid_of_file(folder, size, spacing, stack.origin,
                                  {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  volume.view.grid.unit = stack.unit;
  volume.view.type = slices.type();
  const std::shared_ptr<std::byte[]> samples = allocate_samples(folder, bytes, options);
  const std::uint64_t slice_bytes = bytes / files.size();
  for (std::size_t slice = 0; slice < files.size(); ++slice) {
    slices.read(files[slice], value, options, samples.get() + slice * slice_bytes);
  }
  volume.view.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace

bool is_image_stack(const fs::path& folder) {
  const std::vector<fs::path> files = files_in(folder);
  return std::ranges::any_of(files, is_image) &&
         std::ranges::none_of(
             files, [](const fs::path& file) { return !is_image(file) && is_dicom(file); });
}

VolumeFile read_image_stack(const fs::path& folder, const ReadOptions& options) {
  std::vector<fs::path> files = files_in(folder);
  std::erase_if(files, [](const fs::path& file) { return !is_image(file); });
  if (files.size() < 2) {
    throw unsupported(
        folder,
        "is a folder with one image, '" + one_line(files.front().filename().string(), 80) +
            "'; expected a slice in each of several images, or the path of a file with all slices");
  }
  files = in_slice_order(folder, std::move(files));
  VolumeFile file;
  VolumeSource& source = file.source;
  source.format = is_png(files.front()) ? "PNG slices" : "TIFF slices";
  TiffStack stack;
  std::unique_ptr<SliceFiles> slices;
  if (is_png(files.front())) {
    slices = std::make_unique<PngSlices>(files.front(), source);
  } else {
    slices = std::make_unique<TiffSlices>(files.front(), stack, source);
  }
  source.decisions.push_back({"slices", std::to_string(files.size()) + " from '" +
                                            one_line(files.front().filename().string(), 80) +
                                            "' to '" +
                                            one_line(files.back().filename().string(), 80) +
                                            "', by the number in their names"});
  std::size_t value = 0;
  if (const std::vector<std::string> names = slices->value_names(); names.size() > 1) {
    value = take_choice(folder, source, FileChoice{"channel", names, {}}, options.channel);
  }
  const Vec3 spacing = take_spacing(stack, source);
  file.volume = read_all(folder, files, *slices, value, stack, spacing, options);
  return file;
}

}  // namespace isoatlas::detail::io
