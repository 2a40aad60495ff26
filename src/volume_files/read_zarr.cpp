// SPDX-License-Identifier: Apache-2.0
// Zarr and OME-Zarr folders. There is no maintained Zarr library for C++ in the distributions, so
// metadata and chunks are read here; c-blosc, zstd, zlib, bzip2 and lz4 decompress.
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "files/file_error.h"
#include "files/memory_limit.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/ome_zarr.h"
#include "volume_files/readers.h"
#include "volume_files/region.h"
#include "volume_files/zarr_array.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

class ZarrReader {
 public:
  ZarrReader(const fs::path& path, const ReadOptions& options)
      : options_(options),
        image_(find_ome_level(path)),
        path_(image_.array),
        array_(read_zarr_metadata(path_)) {}

  VolumeFile read(bool with_samples) {
    VolumeSource& source = file_.source;
    const std::string zarr = "Zarr " + std::to_string(array_.version);
    source.format = image_.version.empty() ? zarr : "OME-Zarr " + image_.version + ", " + zarr;
    source.reader = zarr_libraries();
    find_axes();
    if (image_.level_count > 1)
      source.decisions.push_back({"resolution", std::to_string(image_.level) + " of 0 to " +
                                                    std::to_string(image_.level_count - 1) + ", '" +
                                                    one_line(path_.filename().string(), 60) + "'"});
    choose_other_axes();
    select_region();
    if (with_samples) read_samples();
    return std::move(file_);
  }

 private:
  void find_axes() {
    const std::size_t count = array_.size.size();
    if (!image_.axes.empty() && image_.axes.size() != count)
      throw bad_file(path_, "has " + std::to_string(count) + " axes, but its image " +
                                std::to_string(image_.axes.size()));
    if (image_.axes.empty()) name_axes_of_array();
    file_.source.has_spacing = image_.has_scale;
    selection_.first.assign(count, 0);
    std::array<std::size_t*, 3> found{&selection_.x_axis, &selection_.y_axis, &selection_.z_axis};
    std::string text;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = std::ranges::find(image_.axes, std::string(1, "xyz"[k]), &OmeAxis::name);
      if (axis == image_.axes.end())
        throw unsupported(path_, std::string("has no axis '") + "xyz"[k] +
                                     "', expected a volume with the axes z, y and x");
      *found[k] = static_cast<std::size_t>(axis - image_.axes.begin());
    }
    for (const OmeAxis& axis : image_.axes)
      text += (text.empty() ? "" : ", ") + one_line(axis.name, 20);
    file_.source.decisions.push_back({"axes", text});
  }

  // Of an array that belongs to no image: its own names, if x, y and z are among them, otherwise
  // z, y, x for the three axes, or for those with several entries.
  void name_axes_of_array() {
    const std::size_t count = array_.size.size();
    image_.axes.resize(count);
    const std::vector<std::string>& names = array_.axis_names;
    const bool is_named = std::ranges::all_of(std::array{"x", "y", "z"}, [&](const char* name) {
      return std::ranges::find(names, name) != names.end();
    });
    std::size_t found = 0;
    for (std::size_t a = 0; a < count; ++a) {
      if (is_named) {
        image_.axes[a].name = names[a];
      } else if (count == 3 || array_.size[a] > 1) {
        image_.axes[a].name = found < 3 ? std::string(1, "zyx"[found]) : "";
        ++found;
      }
    }
    if (!is_named && found != 3)
      throw unsupported(path_, "has " + std::to_string(found) + " axes without names" +
                                   (count > 3 ? " and with several entries" : "") +
                                   ", expected 3, or axes with the names z, y and x");
  }

  bool is_spatial(std::size_t axis) const {
    return axis == selection_.x_axis || axis == selection_.y_axis || axis == selection_.z_axis;
  }

  void choose_other_axes() {
    for (std::size_t a = 0; a < array_.size.size(); ++a) {
      if (is_spatial(a)) continue;
      const OmeAxis& axis = image_.axes[a];
      const std::uint64_t count = array_.size[a];
      if (count == 0)
        throw bad_file(path_, "has no entries along '" + one_line(axis.name, 20) + "'");
      if (axis.name == "t" || axis.type == "time") {
        selection_.first[a] =
            take_choice(path_, file_.source, checked_choice(path_, "time", count), options_.time);
      } else if (axis.name == "c" || axis.type == "channel") {
        selection_.first[a] = take_choice(path_, file_.source, channels(count), options_.channel);
      } else if (count > 1) {
        throw unsupported(path_, "has an axis '" + one_line(axis.name, 20) + "' with " +
                                     std::to_string(count) +
                                     " entries, expected time, channels and space only");
      }
    }
  }

  FileChoice channels(std::uint64_t count) const {
    FileChoice out = checked_choice(path_, "channel", count);
    for (std::size_t c = 0; c < std::min(out.entries.size(), image_.channel_names.size()); ++c) {
      if (!image_.channel_names[c].empty()) out.entries[c] = image_.channel_names[c];
    }
    return out;
  }

  Grid whole_grid(const Size3& size) const {
    const std::array axes{selection_.x_axis, selection_.y_axis, selection_.z_axis};
    const LengthUnit unit = image_.axes[axes[0]].unit;
    std::array<double, 3> scale{}, translation{};
    for (std::size_t k = 0; k < 3; ++k) {
      const OmeAxis& axis = image_.axes[axes[k]];
      if ((axis.unit == LengthUnit::unknown) != (unit == LengthUnit::unknown))
        throw unsupported(path_, "states the unit of some of the axes x, y and z only");
      const double by = axis.unit == unit ? 1 : metres(axis.unit) / metres(unit);
      scale[k] = by * axis.scale;
      translation[k] = by * axis.translation;
    }
    Grid grid = grid_of_file(path_, size, {scale[0], scale[1], scale[2]},
                             {translation[0], translation[1], translation[2]},
                             {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
    grid.unit = unit;
    return grid;
  }

  void select_region() {
    const Size3 size{array_.size[selection_.x_axis], array_.size[selection_.y_axis],
                     array_.size[selection_.z_axis]};
    checked_sample_bytes(path_, size, bytes_per_sample(array_.type));
    const SelectedRegion region = selected_region(path_, size, options_, file_.source);
    VolumeView& view = file_.volume.view;
    view.grid = grid_of_region(whole_grid(size), region, file_.source);
    view.type = array_.type;
    selection_.size = view.grid.size;
    selection_.first[selection_.x_axis] = region.first[0];
    selection_.first[selection_.y_axis] = region.first[1];
    selection_.first[selection_.z_axis] = region.first[2];
  }

  void read_samples() {
    VolumeView& view = file_.volume.view;
    std::uint64_t chunk_bytes = array_.value_bytes;
    for (const std::uint64_t n : array_.sharding ? array_.sharding->chunk.size : array_.chunk.size)
      chunk_bytes *= n;
    require_within_memory_limit(path_, chunk_bytes, options_);
    const std::uint64_t bytes =
        checked_sample_bytes(path_, view.grid.size, bytes_per_sample(array_.type));
    const std::shared_ptr<std::byte[]> samples = allocate_samples(path_, bytes, options_);
    const ZarrChunkCount chunks = read_zarr_samples(array_, selection_, samples.get());
    if (chunks.stored == 0)
      throw bad_file(path_, "has none of its chunks there; expected at least one of " +
                                std::to_string(chunks.all));
    if (chunks.stored < chunks.all)
      file_.source.decisions.push_back({"chunks", std::to_string(chunks.all - chunks.stored) +
                                                      " of " + std::to_string(chunks.all) +
                                                      " are not stored and have the fill value"});
    view.samples = samples.get();
    file_.volume.owner = samples;
  }

  const ReadOptions& options_;
  OmeImageLevel image_;
  fs::path path_;
  ZarrArray array_;
  ZarrSelection selection_;
  VolumeFile file_;
};

}  // namespace

VolumeFile read_zarr(const fs::path& path, const ReadOptions& options, bool with_samples) {
  return ZarrReader(path, options).read(with_samples);
}

}  // namespace isoatlas::detail::io
