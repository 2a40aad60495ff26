// SPDX-License-Identifier: Apache-2.0
// Options whose values are words. A name is that of the command line without the dashes; the Python
// module has underscores in it instead.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "isoatlas/measure.h"
#include "isoatlas/options.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_file.h"
#include "wording/level_goals.h"
#include "wording/values.h"

namespace isoatlas::detail {

constexpr std::size_t kMeasureSamples =
    200'000;  ///< where somebody wants to measure, and does not say with how many

/// How an isosurface is to be meshed. Lengths are as they were said: the volume's voxel size makes
/// world lengths of them.
struct ExtractSettings {
  ExtractOptions options;  ///< all but what follows
  std::optional<TypedLength> max_radius, event_persistence;
  std::optional<SpaceSize> min_component_size;
  TypedGoals goals;  ///< the constraints of all levels
  int threads = 0;
};

/// Throws Error(bad_argument) if there is no such setting, or it cannot have this value; the
/// message says what was expected, but not of which setting.
void set(ExtractSettings& settings, std::string_view name, std::string_view text);
void set(MeasureOptions& options, std::string_view name, std::string_view text);
/// raw-size, raw-type, raw-spacing, raw-endian, raw-offset (which make a raw layout), channel,
/// time, layer, array, series, spacing, roi, max-memory.
void set(ReadOptions& options, std::string_view name, std::string_view text);

ExtractOptions in_world(const ExtractSettings& settings, const Grid& grid);

// Each throws Error(bad_argument).
TypedLength parse_length(std::string_view text);  ///< 0 or more
int parse_threads(std::string_view text);         ///< 0 or more
/// Three positive numbers, with a unit behind the last or `unknown`.
std::pair<std::array<double, 3>, LengthUnit> parse_spacing(std::string_view text);
std::uint64_t parse_bytes(std::string_view text);  ///< "8GiB", "500MB", "1000"; 1 or more

}  // namespace isoatlas::detail
