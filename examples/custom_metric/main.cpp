// SPDX-License-Identifier: Apache-2.0
// A custom error metric: in each Voronoi cell, the surface normals differ from the normal at the
// cell's vertex by at most 20 degrees.
#include <isoatlas/isoatlas.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

int main() {
  using namespace isoatlas;
  const auto bend = [](const CellGeometry& cell) {
    double largest = 0;
    for (const Vec3& n : cell.normals) {
      const double cosine = n.x * cell.normal.x + n.y * cell.normal.y + n.z * cell.normal.z;
      largest =
          std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
    }
    return largest;
  };
  const auto torus = [](Vec3 p) { return 0.3 - std::hypot(std::hypot(p.x, p.y) - 0.7, p.z); };
  const Volume volume = sample(torus, {-1.2, -1.2, -0.5}, {1.2, 1.2, 0.5}, 0.025);
  const Extraction result = extract(volume, 0, {bounded("bend", bend, 20)});

  const ConstraintResult& outcome = result.finest().constraints.at(0);
  std::cout << name(outcome.constraint) << (outcome.satisfied ? " at most " : " above ")
            << outcome.constraint.bound << ", genus " << result.finest().topology.genus << '\n';
}
