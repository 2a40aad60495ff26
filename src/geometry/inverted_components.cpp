// SPDX-License-Identifier: Apache-2.0
#include "geometry/inverted_components.h"

#include "core/vector_math.h"

namespace isoatlas::detail {

std::vector<std::uint8_t> inverted_components(std::span<const Vec3> positions,
                                              std::span<const Triangle> triangles, Vec3 spacing,
                                              std::span<const std::uint32_t> component_of,
                                              std::size_t components, std::span<const Vec3> outward,
                                              double min_cosine) {
  std::vector<double> facing(components, 0);
  std::vector<Vec3> direction(outward.size());
  for (std::size_t v = 0; v < outward.size(); ++v) direction[v] = normalized(outward[v]);
  for (const Triangle& t : triangles) {
    const Vec3 a = positions[t[0]];
    const Vec3 area =
        cross(to_metric(positions[t[1]] - a, spacing), to_metric(positions[t[2]] - a, spacing));
    double& total = facing[component_of[t[0]]];
    if (min_cosine != 0) total -= 3 * min_cosine * length(area);
    for (const std::uint32_t v : t) total += dot(area, direction[v]);
  }
  std::vector<std::uint8_t> inverted(components);
  for (std::size_t c = 0; c < components; ++c) inverted[c] = facing[c] < 0;
  return inverted;
}

}  // namespace isoatlas::detail
