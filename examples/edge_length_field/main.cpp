// SPDX-License-Identifier: Apache-2.0
// A custom edge-length field: short edges where a simulation needs them, long edges elsewhere.
#include <isoatlas/isoatlas.h>

#include <cmath>
#include <iostream>

int main() {
  using namespace isoatlas;
  const auto ball = [](Vec3 p) { return 1 - std::hypot(p.x, p.y, p.z); };
  const Volume volume = sample(ball, {-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}, 0.03);
  // 0.1 at the north pole, longer away from it.
  const auto longest_edge = [](Vec3 p) { return 0.1 + 0.3 * std::hypot(p.x, p.y, p.z - 1); };
  const Extraction sized = extract(volume, 0, {sized_by(longest_edge)});
  const Extraction even = extract(volume, 0, {bounded(Quantity::max_edge, 0.1)});

  std::cout << "edges " << (sized.finest().all_satisfied() ? "as requested" : "too long") << ", "
            << even.finest().triangles / sized.finest().triangles
            << " times fewer triangles than with short edges everywhere\n";
}
