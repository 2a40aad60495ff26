// SPDX-License-Identifier: Apache-2.0
#include "mask/repair_faces.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCornersPerChunk = 1 << 14;
// Factor over equality, so that rounding cannot turn the decision.
constexpr double kOver = 1.0001;

// A grid face whose diagonal pairs are on different sides.
struct AmbiguousFace {
  std::array<std::uint32_t, 2> joined, separated;
};

std::vector<AmbiguousFace> find_ambiguous_faces(const Band& band, bool joins_inside,
                                                const RunControl& control) {
  return collect_chunks<AmbiguousFace>(
      band.size(), kCornersPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
        control.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
          for (std::size_t a = 0; a < 2; ++a) {
            for (std::size_t b = a + 1; b < 3; ++b) {
              const std::uint32_t u = band.neighbour[i][2 * a + 1],
                                  v = band.neighbour[i][2 * b + 1];
              if (u == Band::kOutside || v == Band::kOutside) continue;
              const std::uint32_t w = band.neighbour[u][2 * b + 1];
              if (w == Band::kOutside) continue;
              const bool side = band.is_inside[i] != 0;
              if ((band.is_inside[w] != 0) != side || (band.is_inside[u] != 0) == side ||
                  (band.is_inside[v] != 0) == side)
                continue;
              AmbiguousFace face{{static_cast<std::uint32_t>(i), w}, {u, v}};
              if (side != joins_inside) std::swap(face.joined, face.separated);
              found.push_back(face);
            }
          }
        }
      });
}

}  // namespace

void repair_faces(const Band& band, MaskConnectivity connectivity, std::vector<float>& field,
                  const RunControl& control) {
  if (connectivity == MaskConnectivity::field) return;
  const std::vector<AmbiguousFace> faces =
      find_ambiguous_faces(band, connectivity == MaskConnectivity::inside_18, control);
  const auto product = [&](const std::array<std::uint32_t, 2>& pair) {
    return static_cast<double>(field[pair[0]]) * static_cast<double>(field[pair[1]]);
  };
  for (bool any = true; any;) {
    any = false;
    control.check_cancelled();
    for (const AmbiguousFace& face : faces) {
      const double ratio = product(face.separated) / product(face.joined);
      if (ratio < 1) continue;
      const double factor = kOver * std::sqrt(ratio);
      for (const std::uint32_t i : face.joined)
        field[i] = static_cast<float>(factor * static_cast<double>(field[i]));
      any = true;
    }
  }
}

}  // namespace isoatlas::detail
