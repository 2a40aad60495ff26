// SPDX-License-Identifier: Apache-2.0
// Reads back the facts about levels that are stored in files.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/report.h"

namespace isoatlas::detail {

/// The facts about a level that a file states. Values that it does not state are 0 or absent.
struct LevelFacts {
  std::size_t vertices = 0, triangles = 0;
  std::array<std::optional<MetricSummary>, kMetricCount> metrics;
  std::optional<double> distance_at_most;  ///< proved; world units
  std::optional<Measurement> measured;     ///< only maxima and numbers of samples
  TopologySummary topology;                ///< `kinds` is empty
  MeshQuality quality;                     ///< aspect ratios without histogram, smallest angle
  /// Whether the triangles are an oriented manifold; if not, `topology` is not meaningful. Absent
  /// if the triangles were not counted; then `topology` is that stated by the file.
  std::optional<bool> is_manifold;
};

/// Parses the text of level_json(). Missing keys leave zeros, missing metrics are absent. JSON has
/// no infinity: a metric with the value null is infinite.
/// @param path  the file of the text, for messages
/// @return absent if the text is not an object, such as "null"
/// @throws Error(bad_file) if the text is not JSON, or a value has the wrong type; a count must be
///         a non-negative integer
std::optional<LevelFacts> facts_of_level(const std::string& json, const std::string& path);

/// Parses the levels of a report or a manifest.
/// @throws Error(bad_file) as facts_of_level(), or if there are no levels
/// @throws Error(unsupported) if the JSON has another schema
std::vector<LevelFacts> facts_of_levels(const std::string& json, const std::string& path);

/// The JSON output of `isoatlas levels`, schema "isoatlas-levels-1".
/// @param nested  absent if unknown
std::string to_json(const std::string& path, const std::vector<LevelFacts>& levels,
                    std::optional<bool> nested);

}  // namespace isoatlas::detail
