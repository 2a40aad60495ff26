// SPDX-License-Identifier: Apache-2.0
// Sets options from texts. The names are those of the command line without the leading dashes; in
// the Python module they have underscores instead of dashes.
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

/// Number of samples of --measure, if --measure-samples is not given.
constexpr std::size_t kMeasureSamples = 200'000;

/// The settings of an extraction as typed. The volume is needed to convert lengths to world units.
struct ExtractSettings {
  ExtractOptions options;  ///< all settings except for those below
  std::optional<TypedLength> max_radius, event_persistence;
  std::optional<SpaceSize> min_component_size;
  TypedGoals goals;  ///< the constraints of all levels
  int threads = 0;
};

/// Sets one option.
/// @throws Error(bad_argument) if there is no such option, or `text` is not one of its values; the
///         message gives the expected values but not the name of the option
void set(ExtractSettings& settings, std::string_view name, std::string_view text);
void set(MeasureOptions& options, std::string_view name, std::string_view text);
/// Options: raw-size, raw-type, raw-spacing, raw-endian, raw-offset (each creates `raw` if it is
/// absent), channel, time, layer, array, series, spacing, roi, max-memory.
void set(ReadOptions& options, std::string_view name, std::string_view text);

/// The options with all lengths in world units. Throws Error(bad_argument) as world_length().
ExtractOptions in_world(const ExtractSettings& settings, const Grid& grid);

// Each throws Error(bad_argument).
TypedLength parse_length(std::string_view text);  ///< 0 or more
Vec3 parse_point(std::string_view text);          ///< three numbers
int parse_threads(std::string_view text);         ///< 0 or more
/// Three positive numbers, and the unit after the last number or `unknown`.
std::pair<std::array<double, 3>, LengthUnit> parse_spacing(std::string_view text);
std::uint64_t parse_bytes(std::string_view text);  ///< "8GiB", "500MB", "1000"; 1 or more

}  // namespace isoatlas::detail
