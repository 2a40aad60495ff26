// SPDX-License-Identifier: Apache-2.0
// A dataset of an HDF5 file.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "isoatlas/length_unit.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/hdf5_library.h"
#include "volume_files/readers.h"
#include "volume_files/region.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostDatasetAxes = 8, kMostDatasets = 4096, kMostGroups = 100'000;
constexpr int kMostDepth = 32;  // of groups inside each other

constexpr unsigned kReadOnly = 0;  // H5F_ACC_RDONLY, whose macro would link the library

using Sizes = std::vector<hsize_t>;  // per axis, slowest first

class Hdf5Reader {
 public:
  Hdf5Reader(const fs::path& path, const ReadOptions& options)
      : path_(path),
        options_(options),
        library_(hdf5_library(path)),
        lock_(*library_.mutex),
        file_(library_.open_file(path.c_str(), kReadOnly, H5P_DEFAULT), library_.close_file) {
    if (file_ < 0) throw bad_file(path_, "cannot be opened: " + library_.error_text());
  }

  VolumeFile read(bool with_samples) {
    out_.source.format = "HDF5";
    out_.source.reader = library_.version();
    find_datasets(file_, "", 0);
    if (names_.empty())
      throw unsupported(path_, "has no dataset of numbers with three axes or more");
    const std::size_t chosen =
        take_choice(path_, out_.source, FileChoice{"array", names_, {}}, options_.array);
    name_ = names_[chosen];
    const Hdf5Id dataset = object(file_, name_);
    describe(dataset);
    if (with_samples) read_samples(dataset);
    return std::move(out_);
  }

 private:
  Hdf5Id object(hid_t parent, const std::string& name) const {
    return {library_.open_object(parent, name.c_str(), H5P_DEFAULT), library_.close_object};
  }
  Hdf5Id space_of(hid_t dataset) const {
    return {library_.dataset_space(dataset), library_.close_space};
  }

  Sizes sizes_of(hid_t dataset) const {
    const Hdf5Id space = space_of(dataset);
    const int axes = space < 0 ? 0 : library_.axis_count(space);
    Sizes out(axes > 0 ? static_cast<std::size_t>(axes) : 0);
    if (!out.empty()) library_.sizes(space, out.data(), nullptr);
    return out;
  }

  static std::size_t count_of_long(const Sizes& sizes) {
    return static_cast<std::size_t>(std::ranges::count_if(sizes, [](hsize_t n) { return n > 1; }));
  }

  // The names of datasets that can be volumes, in the order of the names.
  void find_datasets(hid_t group, const std::string& prefix, int depth) {
    H5G_info_t info{};
    if (depth > kMostDepth || ++visited_groups_ > kMostGroups ||
        library_.group_info(group, &info) < 0)
      return;
    for (hsize_t i = 0; i < info.nlinks && names_.size() < kMostDatasets; ++i) {
      std::array<char, 1024> name{};
      if (library_.link_name(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(),
                             H5P_DEFAULT) <= 0)
        continue;
      // A soft link is another name of a member, perhaps of a group around it; others lead to
      // other files.
      const H5G_obj_t link = library_.link_type(group, i);
      if (link == H5G_LINK || link == H5G_UDLINK) continue;
      const std::string path = prefix + "/" + name.data();
      const Hdf5Id member = object(group, name.data());
      if (member < 0) continue;  // a link to nothing
      const H5I_type_t type = library_.object_type(member);
      if (type == H5I_GROUP) find_datasets(member, path, depth + 1);
      if (type == H5I_DATASET && is_volume(member)) names_.push_back(path);
    }
  }

  bool is_volume(hid_t dataset) const {
    const Sizes sizes = sizes_of(dataset);
    SampleType type{};
    return sizes.size() <= kMostDatasetAxes && sizes.size() >= 3 && count_of_long(sizes) >= 2 &&
           type_of(dataset, type);
  }

  bool type_of(hid_t dataset, SampleType& to) const {
    const Hdf5Id type(library_.dataset_type(dataset), library_.close_type);
    if (type < 0) return false;
    const H5T_class_t kind = library_.type_class(type);
    const std::size_t bytes = library_.type_size(type);
    const bool is_signed = kind == H5T_INTEGER && library_.type_sign(type) == H5T_SGN_2;
    if (kind == H5T_FLOAT) {
      to = bytes > 4 ? SampleType::float64 : SampleType::float32;  // half precision as float32
      return bytes <= 8;
    }
    if (kind != H5T_INTEGER && kind != H5T_ENUM) return false;
    switch (bytes) {
      case 1:
        to = is_signed ? SampleType::int8 : SampleType::uint8;
        return true;
      case 2:
        to = is_signed ? SampleType::int16 : SampleType::uint16;
        return true;
      case 4:
        to = is_signed ? SampleType::int32 : SampleType::uint32;
        return true;
      case 8:
        to = is_signed ? SampleType::int64 : SampleType::uint64;
        return true;
      default:
        return false;
    }
  }

  hid_t memory_type() const {
    constexpr std::array kNames{"H5T_NATIVE_INT8_g",   "H5T_NATIVE_UINT8_g",  "H5T_NATIVE_INT16_g",
                                "H5T_NATIVE_UINT16_g", "H5T_NATIVE_INT32_g",  "H5T_NATIVE_UINT32_g",
                                "H5T_NATIVE_INT64_g",  "H5T_NATIVE_UINT64_g", "H5T_NATIVE_FLOAT_g",
                                "H5T_NATIVE_DOUBLE_g"};
    return library_.native_type(kNames[static_cast<std::size_t>(out_.volume.view.type)]);
  }

  void describe(hid_t dataset) {
    sizes_ = sizes_of(dataset);
    for (std::size_t a = 0; a < sizes_.size(); ++a) {
      if (sizes_.size() == 3 || sizes_[a] > 1) axes_.push_back(a);
    }
    if (axes_.size() != 3)
      throw unsupported(path_, "'" + one_line(name_, 60) + "' has " + std::to_string(axes_.size()) +
                                   " axes with several entries, expected 3");
    std::ranges::reverse(axes_);  // x, y, z
    const Size3 size{sizes_[axes_[0]], sizes_[axes_[1]], sizes_[axes_[2]]};
    VolumeView& view = out_.volume.view;
    type_of(dataset, view.type);
    checked_sample_bytes(path_, size, bytes_per_sample(view.type));
    Vec3 spacing{1, 1, 1};
    out_.source.has_spacing = read_element_size(dataset, spacing);
    Grid grid =
        grid_of_file(path_, size, spacing, {}, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
    if (out_.source.has_spacing) grid.unit = LengthUnit::micrometre;
    region_ = selected_region(path_, size, options_, out_.source);
    view.grid = grid_of_region(grid, region_, out_.source);
  }

  // Fiji and ilastik store the size of a voxel in micrometres, in the order of the axes.
  bool read_element_size(hid_t dataset, Vec3& spacing) const {
    constexpr const char* kName = "element_size_um";
    if (library_.has_attribute(dataset, kName) <= 0) return false;
    const Hdf5Id attribute(library_.open_attribute(dataset, kName, H5P_DEFAULT),
                           library_.close_attribute);
    const Hdf5Id space(library_.attribute_space(attribute), library_.close_space);
    hsize_t count = 0;
    std::array<double, 3> lengths{};
    if (library_.axis_count(space) != 1 || library_.sizes(space, &count, nullptr) < 0 ||
        count != 3 ||
        library_.read_attribute(attribute, library_.native_type("H5T_NATIVE_DOUBLE_g"),
                                lengths.data()) < 0)
      return false;
    spacing = {lengths[2], lengths[1], lengths[0]};
    return true;
  }

  // Reads a box of the dataset, given along x, y and z. Returns the error, or an empty text.
  std::string read_box(hid_t dataset, const Size3& first, const Size3& size, std::byte* to) const {
    Sizes start(sizes_.size(), 0), count(sizes_.size(), 1);
    for (std::size_t k = 0; k < 3; ++k) {
      start[axes_[k]] = first[k];
      count[axes_[k]] = size[k];
    }
    const Hdf5Id space = space_of(dataset);
    library_.select_box(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    const Hdf5Id memory(
        library_.create_space(static_cast<int>(count.size()), count.data(), nullptr),
        library_.close_space);
    const herr_t result = library_.read(dataset, memory_type(), memory, space, H5P_DEFAULT, to);
    return result < 0 ? library_.error_text() : "";  // before other calls, which discard it
  }

  void read_samples(hid_t dataset) {
    VolumeView& view = out_.volume.view;
    const std::uint64_t bytes =
        checked_sample_bytes(path_, view.grid.size, bytes_per_sample(view.type));
    const std::shared_ptr<std::byte[]> samples = allocate_samples(path_, bytes, options_);
    const std::string error = read_box(dataset, region_.first, view.grid.size, samples.get());
    if (!error.empty())
      throw bad_file(path_, "'" + one_line(name_, 60) +
                                "' cannot be read: " + with_chunk(error, dataset, samples.get()));
    view.samples = samples.get();
    out_.volume.owner = samples;
  }

  // The error with the first chunk that cannot be read.
  std::string with_chunk(const std::string& error, hid_t dataset, std::byte* samples) const {
    const Hdf5Id properties(library_.dataset_properties(dataset), library_.close_properties);
    Sizes chunk(sizes_.size());
    if (properties < 0 ||
        library_.chunk_size(properties, static_cast<int>(chunk.size()), chunk.data()) < 0)
      return error;
    const auto step = [&](std::size_t k) { return static_cast<std::size_t>(chunk[axes_[k]]); };
    for (std::size_t z = region_.first[2] / step(2); z <= region_.last[2] / step(2); ++z) {
      for (std::size_t y = region_.first[1] / step(1); y <= region_.last[1] / step(1); ++y) {
        for (std::size_t x = region_.first[0] / step(0); x <= region_.last[0] / step(0); ++x) {
          const std::array at{x, y, z};
          Size3 first{}, size{};
          for (std::size_t k = 0; k < 3; ++k) {
            first[k] = std::max(region_.first[k], at[k] * step(k));
            size[k] = std::min(region_.last[k] + 1, (at[k] + 1) * step(k)) - first[k];
          }
          if (const std::string cause = read_box(dataset, first, size, samples); !cause.empty())
            return "chunk (" + std::to_string(z) + ", " + std::to_string(y) + ", " +
                   std::to_string(x) + "): " + cause;
        }
      }
    }
    return error;
  }

  const fs::path& path_;
  const ReadOptions& options_;
  const Hdf5Library& library_;
  std::lock_guard<std::mutex> lock_;
  Hdf5Id file_;
  std::size_t visited_groups_ = 0;
  std::vector<std::string> names_;
  std::string name_;
  Sizes sizes_;
  std::vector<std::size_t> axes_;  // of x, y and z
  SelectedRegion region_;
  VolumeFile out_;
};

}  // namespace

bool is_hdf5(const fs::path& path) {
  constexpr std::string_view kMark = "\x89HDF\r\n\x1a\n";
  std::error_code error;
  return fs::is_regular_file(path, error) && !has_extension(path, ".vtkhdf") &&
         first_bytes(path, kMark.size()) == kMark;
}

VolumeFile read_hdf5(const fs::path& path, const ReadOptions& options, bool with_samples) {
  return Hdf5Reader(path, options).read(with_samples);
}

}  // namespace isoatlas::detail::io
