// SPDX-License-Identifier: Apache-2.0
// What a level says of itself in a file, read back.
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

struct LevelFacts {
  std::size_t vertices = 0, triangles = 0;
  std::array<std::optional<MetricSummary>, kMetricCount> metrics;
  std::optional<double> distance_at_most;  ///< proved
  std::optional<Measurement> measured;     ///< its maxima and how densely it was sampled
  TopologySummary topology;                ///< without kinds
  MeshQuality quality;                     ///< aspect ratio but for its histogram, least angle
  /// And oriented: else `topology` means nothing. None where it was not counted: then `topology` is
  /// what the file says.
  std::optional<bool> is_manifold;
};

/// From level_json(). None if `json` is "null"; keys that are not there leave zeros, metrics none.
/// JSON has no infinity: a metric that is null is infinite.
/// @throws Error(bad_file) if it is no JSON object, or a key is of the wrong type, a count negative
/// or no integer; `path` is for messages
std::optional<LevelFacts> facts_of_level(const std::string& json, const std::string& path);

/// The levels of a report or of a manifest. Throws Error(bad_file), Error(unsupported) if it is
/// JSON of another kind.
std::vector<LevelFacts> facts_of_levels(const std::string& json, const std::string& path);

/// What `isoatlas levels` found, schema "isoatlas-levels-1". `nested` none: it cannot be known.
std::string to_json(const std::string& path, const std::vector<LevelFacts>& levels,
                    std::optional<bool> nested);

}  // namespace isoatlas::detail
