// SPDX-License-Identifier: Apache-2.0
// The pieces that several JSON documents share. docs/reference/report.md documents their keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/report.h"
#include "report/report.h"

namespace isoatlas::detail::report {

using Json = nlohmann::ordered_json;  // keys stay in the order in which they are written

Json to_value(Vec3 v);
Json to_value(const std::optional<double>& length);  ///< null if there is none
Json to_value(const CertificateReport& certificate);
Json to_value(const MeshQuality& quality);
Json to_value(const Measurement& measurement);
Json to_value(const LevelGoal& goal);

/// Components, Euler characteristic, genus, boundary loops and kinds, into an object that says
/// more.
void add_topology(Json& object, const TopologySummary& topology);

/// What is known of a level, but for the time it took and the file it went to: the same input gives
/// the same value.
Json to_value(const LevelReport& level, std::size_t number);

/// For people too: one line per key, lists of numbers on that line, of small objects with one
/// object per line; a newline at the end.
std::string to_text(const Json& json);

}  // namespace isoatlas::detail::report
