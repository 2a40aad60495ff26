// SPDX-License-Identifier: Apache-2.0
// Random goals for the levels of a random case: any quantities in any order, with bounds from
// impossible to trivial.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "property/random_case.h"

namespace isoatlas::detail::test {

inline double random_bound(Quantity quantity, double voxel, Random& random) {
  const double u = random.unit();
  switch (unit(quantity)) {
    case Unit::length:
      return voxel * 0.03 * std::pow(100.0, u);  // 0.03 to 3 voxels
    case Unit::ratio:
      return quantity == Quantity::min_aspect ? 0.05 + 0.7 * u : 1 + 0.01 * std::pow(100.0, u);
    case Unit::degrees:
      return 3 * std::pow(40.0, u);
    case Unit::count:
      return static_cast<double>(random.between(1, 250));
    case Unit::number:
      break;
  }
  return 1;
}

inline LevelGoal random_goal(double voxel, Random& random) {
  LevelGoal out;
  const auto wanted = random.between(0, 4);
  for (int k = 0; k < wanted; ++k) {
    const auto quantity = static_cast<Quantity>(random.between(0, kQuantityCount - 1));
    if (std::any_of(out.begin(), out.end(),
                    [&](const Constraint& c) { return c.quantity == quantity; }))
      continue;
    out.push_back({quantity, random_bound(quantity, voxel, random)});
  }
  return out;
}

/// Refining costs most, so it gets small volumes, which are sufficient to find its bugs.
inline RandomCase smaller(RandomCase c) {
  c.nx = 2 + (c.nx - 2) / 2;
  c.ny = 2 + (c.ny - 2) / 2;
  c.nz = 2 + (c.nz - 2) / 2;
  return c;
}

inline ExtractOptions with_random_goals(const RandomCase& c) {
  Random random(c.seed * 977 + 5);
  const double voxel = std::min({c.spacing.x, c.spacing.y, c.spacing.z});
  ExtractOptions out = coarse_options();
  out.surface.isovalue = c.isovalue();
  out.surface.inside = c.inside();
  out.placement = random.bits() % 2 ? Placement::surface : Placement::balanced;
  if (c.seed % 3 == 0) out.surface.topology = Topology::faces;
  if (random.bits() % 3 == 0)
    out.covering.max_radius = 1000;  // large disks, so coarser complexes even for small volumes
  if (random.bits() % 2) out.coarse = random_goal(voxel, random);
  const auto levels = random.between(1, 3);
  for (int k = 0; k < levels; ++k) out.refine.push_back(random_goal(voxel, random));
  return out;
}

inline std::string text(const LevelGoal& goal) {
  std::string out;
  for (const Constraint& c : goal)
    out += std::string(name(c.quantity)) + ":" + std::to_string(c.bound) + " ";
  return out.empty() ? "nothing " : out;
}

}  // namespace isoatlas::detail::test
