// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/vector_math.h"
#include "field/dense_volume.h"
#include "files/file_error.h"
#include "isoatlas/volume_file.h"
#include "volume_files/image_stack.h"
#include "volume_files/read_without_samples.h"
#include "volume_files/readers.h"
#include "volume_files/region.h"
#include "volume_files/standard_input.h"
#include "volume_files/volume_format.h"
#include "volume_files/zarr_array.h"

namespace isoatlas {
using namespace detail;

namespace fs = std::filesystem;

namespace {

void require_valid(const ReadOptions& options, const fs::path& path) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::bad_argument, io::one_line(path.string() + ": " + what));
  };
  if (options.spacing) {
    for (const double step : {options.spacing->x, options.spacing->y, options.spacing->z}) {
      if (!std::isfinite(step) || step <= 0) {
        refuse("a spacing of " + std::to_string(step) + " was given, expected positive lengths");
      }
    }
    if (options.raw && options.raw->spacing != std::array<double, 3>{1, 1, 1}) {
      refuse(
          "two spacings were given, the raw layout's and one in place of the file's; expected one");
    }
  }
}

// Refuses an option that no reader has used, because the file has no such list.
void require_used(const ReadOptions& options, const VolumeFile& file, const fs::path& path) {
  const auto check = [&](const std::string& name, bool is_given) {
    const bool is_used = std::ranges::any_of(
        file.source.choices, [&](const FileChoice& choice) { return choice.name == name; });
    if (is_given && !is_used) {
      const std::string list = name == "series" ? name
                               : name == "time" ? "time points"
                                                : name + "s";
      throw Error(ErrorCode::bad_argument,
                  io::one_line(path.string() + ": " + name + " was given, but this " +
                               file.source.format + " file has no " + list + " to choose from"));
    }
  };
  check("channel",
        !options.channel.empty() && options.channel != "0");  // entry 0 exists without a list
  check("time", options.time.value_or(0) > 0);
  check("layer", !options.layer.empty() && options.layer != "0");
  check("array", !options.array.empty());
  check("series", !options.series.empty() && options.series != "0");
}

void apply_spacing(const ReadOptions& options, VolumeFile& file) {
  VolumeSource& source = file.source;
  if (options.spacing) {
    Grid& grid = file.volume.view.grid;
    const Vec3 before = grid.spacing;
    const LengthUnit stated_unit = grid.unit;
    grid.spacing = *options.spacing;
    if (options.spacing_unit != LengthUnit::unknown) {
      const double scale =
          grid.unit == LengthUnit::unknown ? 1 : metres(grid.unit) / metres(options.spacing_unit);
      grid.origin = {grid.origin.x * scale, grid.origin.y * scale, grid.origin.z * scale};
      grid.unit = options.spacing_unit;
    }
    const double scale =
        options.spacing_unit == LengthUnit::unknown || stated_unit == LengthUnit::unknown
            ? 1
            : metres(stated_unit) / metres(options.spacing_unit);
    const Vec3 steps = source.origin_in_samples;
    grid.origin = grid.origin +
                  (steps.x * (grid.spacing.x - scale * before.x)) * grid.direction[0] +
                  (steps.y * (grid.spacing.y - scale * before.y)) * grid.direction[1] +
                  (steps.z * (grid.spacing.z - scale * before.z)) * grid.direction[2];
    source.decisions.push_back({"spacing", "given, in place of the file's"});
  } else if (!source.has_spacing) {
    source.warnings.push_back("states no voxel size; 1 x 1 x 1 is assumed");
  }
}

// After a reader that reads the whole volume.
void keep_region(const ReadOptions& options, VolumeFile& file, const fs::path& path) {
  if (!options.region) return;
  const io::SelectedRegion region =
      io::selected_region(path, file.volume.view.grid.size, options, file.source);
  const Grid grid = io::grid_of_region(file.volume.view.grid, region, file.source);
  file.volume =
      detail::dense_volume(file.volume.view.box(region.first, region.last), file.volume.owner);
  file.volume.view.grid = grid;
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

VolumeFile read_path(const fs::path& path, const ReadOptions& options) {
  if (options.raw) {
    return io::read_raw(path, options);
  }
  if (is_folder(path)) {
    return io::is_image_stack(path) ? io::read_image_stack(path, options)
                                    : io::read_dicom(path, options);
  }
  io::readable_file_size(path);  // reports a missing, empty or unreadable file first
  return io::format_of(path).read(path, options);
}

VolumeFile read_checked(const fs::path& path, const ReadOptions& options, bool with_samples) {
  return io::translate_exceptions(path, [&] {
    require_valid(options, path);
    const bool reads_region = io::reads_boxes(path, options);
    VolumeFile file = !reads_region     ? read_path(path, options)
                      : is_folder(path) ? io::read_zarr(path, options, with_samples)
                                        : io::read_hdf5(path, options, with_samples);
    require_used(options, file, path);
    if (!reads_region) keep_region(options, file, path);
    apply_spacing(options, file);
    return file;
  });
}

// Standard input is read from a temporary file, whose name means nothing to the user: messages name
// standard input.
[[noreturn]] void rethrow_named(const Error& error, const fs::path& path) {
  std::string message = error.what();
  if (message.find(path.parent_path().string() + "/", message.find(path.string()) + 1) !=
      std::string::npos) {
    throw io::bad_file(io::kStandardInputName,
                       "is a header that names other files, expected the header by its file name");
  }
  if (const std::size_t at = message.find(path.string()); at != std::string::npos) {
    message.replace(at, path.string().size(), io::kStandardInputName);
  }
  if (const auto* needed = dynamic_cast<const ChoiceNeeded*>(&error)) {
    throw ChoiceNeeded(message, needed->choice(), needed->source());
  }
  throw Error(error.code(), message);
}

}  // namespace

VolumeFile read_volume_file(const fs::path& path, const ReadOptions& options) {
  if (path == "-") {
    const io::StandardInput input;
    try {
      return read_volume_file(input.path(), options);
    } catch (const Error& error) {
      rethrow_named(error, input.path());
    }
  }
  return read_checked(path, options, true);
}

bool io::reads_boxes(const fs::path& path, const ReadOptions& options) {
  return !options.raw && (is_folder(path) ? is_zarr(path) : is_hdf5(path));
}

VolumeFile io::read_without_samples(const fs::path& path, const ReadOptions& options) {
  return read_checked(path, options, false);
}

Volume read_volume(const fs::path& path, const ReadOptions& options) {
  return read_volume_file(path, options).volume;
}

}  // namespace isoatlas
