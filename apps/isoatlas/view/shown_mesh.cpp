// SPDX-License-Identifier: Apache-2.0
#include "view/shown_mesh.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/vector_math.h"
#include "geometry/bounds.h"
#include "report/report.h"

namespace isoatlas::detail::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kListedComponents = 50;

Json point_value(Vec3 p) { return {p.x, p.y, p.z}; }

Json dropped_value(const std::vector<RankedComponent>& dropped) {
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(dropped.size(), kListedComponents); ++i)
    out.push_back({{"size", dropped[i].size}, {"position", point_value(dropped[i].position)}});
  return out;
}

template <class Number>
void append(std::string& out, Number number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

std::string mesh_bytes(const Extraction& extraction, const ShownMesh& shown) {
  const TriangleMesh mesh = extraction.mesh();
  const Bounds box = bounds_of(mesh.positions);
  const Vec3 centre = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
  const ExtractReport& report = extraction.report;
  const LevelReport& level = extraction.finest();
  std::string json =
      Json{{"vertices", mesh.positions.size()},
           {"triangles", mesh.triangles.size()},
           {"centre", point_value(centre)},
           {"half", point_value(half)},
           {"unit", symbol(shown.unit)},
           {"seconds", shown.seconds},
           {"reduction", shown.reduction},
           {"isovalue", shown.isovalue},
           {"facts", Json::parse(level_json(level, extraction.report.levels.size() - 1))},
           {"kept", report.dropped.empty() ? level.topology.components : report.kept.size()},
           {"dropped", report.dropped.size()},
           {"dropped_components", dropped_value(report.dropped)}}
          .dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out;
  out.reserve(4 + json.size() + 12 * (mesh.positions.size() + mesh.triangles.size()));
  append(out, static_cast<std::uint32_t>(json.size()));
  out += json;
  for (const Vec3& position : mesh.positions) {
    const Vec3 p = position - centre;
    for (const double coordinate : {p.x, p.y, p.z}) append(out, static_cast<float>(coordinate));
  }
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) append(out, v);
  return out;
}

}  // namespace isoatlas::detail::tool
