// SPDX-License-Identifier: Apache-2.0
// A random small volume and its options, in a form that RapidCheck can shrink and that can be
// reproduced by random_samples(family, size, seed).
#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>

#include "support/reference_topology.h"
#include "support/volumes.h"

namespace isoatlas::detail::test {

struct RandomCase {
  int family = 0;
  std::size_t nx = 2, ny = 2, nz = 2;
  std::uint64_t seed = 0;
  int twice_isovalue = 0;
  bool below = false;
  Vec3 spacing{1, 1, 1};

  /// The pose of the volume in the world: identity, rotated, mirrored, far from the origin, or so
  /// far that a voxel has 2^17 numbers along an axis.
  int pose() const { return static_cast<int>(seed / 7 % 6); }
  Volume volume(SampleType type) const {
    Volume out = to_volume(samples(), type, spacing);
    if (pose() == 0) return out;
    Random random(seed);
    const double a = 6.28 * random.unit(), b = 6.28 * random.unit();
    const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
    out.view.grid.direction = {{{ca, sa, 0}, {-sa * cb, ca * cb, sb}, {sa * sb, -ca * sb, cb}}};
    if (pose() == 2) out.view.grid.direction[2] = {-sa * sb, ca * sb, -cb};
    const double away = out.view.grid.smallest_spacing() * (pose() < 3   ? 10
                                                            : pose() < 5 ? 3000
                                                                         : 6e9);
    out.view.grid.origin = {away * (random.unit() - 0.5), -away, away * random.unit()};
    return out;
  }
  /// The largest rounding of world coordinates in this pose.
  double rounding() const {
    const Grid grid = volume(SampleType::int32).view.grid;
    return 0x1p-52 *
           std::max({std::fabs(grid.origin.x), std::fabs(grid.origin.y), std::fabs(grid.origin.z),
                     100 * grid.spacing.x, 100 * grid.spacing.y, 100 * grid.spacing.z});
  }

  Samples samples() const {
    return random_samples(static_cast<Family>(family), {nx, ny, nz}, seed);
  }
  double isovalue() const { return 0.5 * twice_isovalue; }
  Inside inside() const { return below ? Inside::below : Inside::above; }

  friend std::ostream& operator<<(std::ostream& out, const RandomCase& c) {
    return out << name(static_cast<Family>(c.family)) << " (family " << c.family << ", size "
               << c.nx << " x " << c.ny << " x " << c.nz << ", seed " << c.seed << "), isovalue "
               << c.isovalue() << (c.below ? ", below" : ", above") << ", spacing " << c.spacing.x
               << " " << c.spacing.y << " " << c.spacing.z << ", pose " << c.pose();
  }
};

inline void showValue(const RandomCase& c, std::ostream& out) { out << c; }

// RapidCheck's default is 100 cases with another seed each time; a test that passes or fails by
// chance proves nothing about a change. RC_PARAMS in the environment overrides this, to search for
// bugs in new volumes.
inline bool run_cases(int count) {
  const std::string parameters = "max_success=" + std::to_string(count) + " max_size=100 seed=2001";
  return setenv("RC_PARAMS", parameters.c_str(), 0) == 0;
}

}  // namespace isoatlas::detail::test

namespace rc {

template <>
struct Arbitrary<isoatlas::detail::test::RandomCase> {
  static Gen<isoatlas::detail::test::RandomCase> arbitrary() {
    using isoatlas::detail::test::RandomCase;
    // Sizes do not depend on RapidCheck's "size" parameter: volumes are small or large at any time.
    const auto length = gen::resize(100, gen::inRange<std::size_t>(2, 15));
    const auto whole = [](int low, int high) { return gen::resize(100, gen::inRange(low, high)); };
    return gen::build<RandomCase>(
        gen::set(&RandomCase::family, whole(0, isoatlas::detail::test::kFamilies)),
        gen::set(&RandomCase::nx, length), gen::set(&RandomCase::ny, length),
        gen::set(&RandomCase::nz, length),
        gen::set(&RandomCase::seed, gen::resize(100, gen::inRange<std::uint64_t>(0, 1000000))),
        gen::set(&RandomCase::twice_isovalue,
                 gen::weightedOneOf<int>({{3, gen::just(0)}, {1, whole(-3, 4)}})),
        gen::set(&RandomCase::below, gen::arbitrary<bool>()),
        gen::set(&RandomCase::spacing,
                 gen::element(isoatlas::Vec3{1, 1, 1}, isoatlas::Vec3{1, 1, 1},
                              isoatlas::Vec3{1, 2, 0.5}, isoatlas::Vec3{0.3, 0.3, 3},
                              isoatlas::Vec3{5, 1, 1})));
  }
};

}  // namespace rc
