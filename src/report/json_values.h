// SPDX-License-Identifier: Apache-2.0
// JSON values that several documents share. docs/reference/report.md documents their keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "isoatlas/component_extents.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/report.h"
#include "report/report.h"

namespace isoatlas::detail::report {

using Json = nlohmann::ordered_json;  // keys keep the order in which they are inserted

Json to_value(Vec3 v);
Json to_value(const std::optional<double>& length);  ///< null if absent
Json to_value(const CertificateReport& certificate);
Json to_value(const MeshQuality& quality);
/// @param is_oriented_manifold  otherwise genus and boundary loops of the components are null
Json to_value(const MeshExtent& extent, bool is_oriented_manifold = true);
Json to_value(const Measurement& measurement);
Json to_value(const LevelGoal& goal);

/// Adds components, Euler characteristic, genus, boundary loops and kinds to `object`.
void add_topology(Json& object, const TopologySummary& topology);

/// The report of a level without its time and its file: the same input gives the same value.
Json to_value(const LevelReport& level, std::size_t number);

/// The JSON text in a readable layout: one key per line, with lists of numbers on the same line and
/// lists of small objects with one object per line. Ends with a newline.
std::string to_text(const Json& json);

}  // namespace isoatlas::detail::report
