// SPDX-License-Identifier: Apache-2.0
// Smooth fields of masks: every sample keeps its side, and the topology is that of the mask.
#include "isoatlas/mask_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "isoatlas/extract.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

struct Mask {
  Size size{};
  std::vector<std::uint8_t> inside;
  Vec3 spacing{1, 1, 1};

  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
    return x + size[0] * (y + size[1] * z);
  }
  VolumeView view() const {
    VolumeView out = VolumeView::of(inside, Size3(size));
    out.grid.spacing = spacing;
    return out;
  }
};

Mask sampled_mask(Size size, Vec3 spacing, const Function& signed_distance) {
  Mask out{size, {}, spacing};
  for (std::size_t z = 0; z < size[2]; ++z) {
    for (std::size_t y = 0; y < size[1]; ++y) {
      for (std::size_t x = 0; x < size[0]; ++x)
        out.inside.push_back(signed_distance(static_cast<double>(x) * spacing.x,
                                             static_cast<double>(y) * spacing.y,
                                             static_cast<double>(z) * spacing.z) >= 0);
    }
  }
  return out;
}

// @param is_cut  whether samples on the volume boundary may be inside
Mask random_mask(std::uint64_t seed, bool is_cut) {
  Random random(seed);
  const auto side = [&] { return static_cast<std::size_t>(random.between(3, 8)); };
  Mask out{{side(), side(), side()}, {}, {1, 1, 1}};
  const double share = 0.1 + 0.8 * random.unit();
  for (std::size_t z = 0; z < out.size[2]; ++z) {
    for (std::size_t y = 0; y < out.size[1]; ++y) {
      for (std::size_t x = 0; x < out.size[0]; ++x) {
        const bool is_outermost = x == 0 || y == 0 || z == 0 || x + 1 == out.size[0] ||
                                  y + 1 == out.size[1] || z + 1 == out.size[2];
        out.inside.push_back(random.unit() < share && (is_cut || !is_outermost));
      }
    }
  }
  return out;
}

bool has_both_sides(const Mask& mask) {
  return std::ranges::count(mask.inside, 1) > 0 && std::ranges::count(mask.inside, 0) > 0;
}

// Number of components of the samples on one side. @param most  number of axes along which
// neighbours may differ: 1 for faces (6), 2 for faces and edges (18)
std::size_t count_components(const Mask& mask, std::uint8_t side, int most) {
  std::vector<std::size_t> root(mask.inside.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const std::function<std::size_t(std::size_t)> find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  const auto [nx, ny, nz] = mask.size;
  for (std::size_t z = 0; z < nz; ++z) {
    for (std::size_t y = 0; y < ny; ++y) {
      for (std::size_t x = 0; x < nx; ++x) {
        if (mask.inside[mask.index(x, y, z)] != side) continue;
        for (int k = 0; k < 27; ++k) {
          const int dx = k % 3 - 1, dy = k / 3 % 3 - 1, dz = k / 9 - 1;
          if (std::abs(dx) + std::abs(dy) + std::abs(dz) > most) continue;
          const std::size_t u = x + static_cast<std::size_t>(dx),
                            v = y + static_cast<std::size_t>(dy),
                            w = z + static_cast<std::size_t>(dz);
          if (u >= nx || v >= ny || w >= nz || mask.inside[mask.index(u, v, w)] != side) continue;
          root[find(mask.index(x, y, z))] = find(mask.index(u, v, w));
        }
      }
    }
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < root.size(); ++i) count += mask.inside[i] == side && find(i) == i;
  return count;
}

std::span<const float> values(const Volume& field) {
  return {static_cast<const float*>(field.view.samples), field.view.grid.sample_count()};
}

TopologySummary topology_at(const VolumeView& volume, double isovalue) {
  ExtractOptions options = coarse_options(isovalue);
  options.surface.topology = Topology::faces;
  return extract(volume, options).report.reference;
}

TEST(MaskField, EverySampleKeepsItsSideAndTheTopologyIsThatOfTheMask) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Mask mask = random_mask(seed, true);
    if (!has_both_sides(mask)) continue;
    const Volume field = mask_field(mask.view());
    for (std::size_t i = 0; i < mask.inside.size(); ++i)
      ASSERT_EQ(values(field)[i] > 0, mask.inside[i] != 0) << seed;
    ASSERT_EQ(topology_at(field, 0), topology_at(mask.view(), 0.5)) << seed;
  }
}

// Between two components of samples there is one of the surface.
TEST(MaskField, TheSurfaceHasOneComponentLessThanBothSidesTogether) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Mask mask = random_mask(seed, false);
    if (!has_both_sides(mask)) continue;
    const std::size_t inside_18 = count_components(mask, 1, 2) + count_components(mask, 0, 1) - 1,
                      inside_6 = count_components(mask, 1, 1) + count_components(mask, 0, 2) - 1;
    ASSERT_EQ(topology_at(mask_field(mask.view()), 0).components, inside_18) << seed;
    ASSERT_EQ(topology_at(mask_field(mask.view(), {MaskConnectivity::inside_6}), 0).components,
              inside_6)
        << seed;
  }
}

double mean_error(const Mask& mask, const Function& signed_distance) {
  const Volume field = mask_field(mask.view());
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t z = 0; z < mask.size[2]; ++z) {
    for (std::size_t y = 0; y < mask.size[1]; ++y) {
      for (std::size_t x = 0; x + 1 < mask.size[0]; ++x) {
        const std::size_t i = mask.index(x, y, z);
        const double a = values(field)[i], b = values(field)[i + 1];
        if ((a >= 0) == (b >= 0)) continue;
        sum += std::abs(signed_distance((static_cast<double>(x) + a / (a - b)) * mask.spacing.x,
                                        static_cast<double>(y) * mask.spacing.y,
                                        static_cast<double>(z) * mask.spacing.z));
        ++count;
      }
    }
  }
  return sum / static_cast<double>(count);
}

Function sphere(Vec3 centre, double radius) {
  return [=](double x, double y, double z) {
    return radius - std::hypot(x - centre.x, y - centre.y, z - centre.z);
  };
}

TEST(MaskField, IsNearTheTrueSurface) {
  const Function large = sphere({15.3, 16.1, 15.8}, 12), small = sphere({7.2, 7.4, 7.9}, 4.3);
  EXPECT_LT(mean_error(sampled_mask({32, 32, 32}, {1, 1, 1}, large), large), 0.05);
  EXPECT_LT(mean_error(sampled_mask({16, 16, 16}, {1, 1, 1}, small), small), 0.08);
  // The mask itself: 0.16 in cubic voxels, 0.6 in slices that are 4 times as thick.
  const Function tall = sphere({20.3, 20.1, 22.2}, 16);
  EXPECT_LT(mean_error(sampled_mask({42, 42, 11}, {1, 1, 4}, tall), tall), 0.25);
}

TEST(MaskField, ThinRodsKeepTheirVolume) {
  // Inside samples count about as much as the volume.
  const Vec3 along{0.36, 0.48, 0.8};
  const auto rod = [&](double x, double y, double z) {
    const Vec3 d{x - 16.3, y - 15.8, z - 16.1};
    const double h = d.x * along.x + d.y * along.y + d.z * along.z;
    return 1.2 - std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z - h * h);
  };
  const Mask mask = sampled_mask({32, 32, 32}, {1, 1, 1}, rod);
  ExtractOptions options;
  options.surface.topology = Topology::faces;
  options.border = Border::closed;
  options.refine = {within(0.1)};
  const Extraction mesh = extract(mask_field(mask.view()), options);
  const auto voxels = static_cast<double>(std::ranges::count(mask.inside, 1));
  EXPECT_NEAR(mesh.report.levels.back().extent.volume.value_or(0), voxels, 0.12 * voxels);
  EXPECT_LT(mean_error(mask, rod), 0.14);  // the mask itself: 0.18
}

TEST(MaskField, SameBytesForAnyNumberOfThreads) {
  const Mask mask = sampled_mask({40, 36, 30}, {1, 1, 2}, sphere({20, 18, 29}, 15));
  const ThreadLimit one(1);
  const Volume alone = mask_field(mask.view());
  std::vector<float> expected(values(alone).begin(), values(alone).end());
  std::vector<float> found;
  {
    const ThreadLimit four(4);
    const Volume field = mask_field(mask.view());
    found.assign(values(field).begin(), values(field).end());
  }
  EXPECT_EQ(found, expected);
}

TEST(MaskField, SingleSamplesAndPlanes) {
  Mask mask{{3, 3, 3}, std::vector<std::uint8_t>(27, 0), {1, 1, 1}};
  mask.inside[13] = 1;
  EXPECT_EQ(topology_at(mask_field(mask.view()), 0).components, 1u);
  const Mask half =
      sampled_mask({40, 40, 40}, {1, 1, 1}, [](double x, double, double) { return x - 19.5; });
  const Volume field = mask_field(half.view());
  for (std::size_t i = 0; i + 1 < half.inside.size(); ++i) {
    if (half.inside[i] == half.inside[i + 1] || i % 40 == 39) continue;
    EXPECT_NEAR(values(field)[i], -values(field)[i + 1], 1e-3);  // the plane stays half-way
  }
}

TEST(MaskField, NanIsOutside) {
  std::vector<double> samples(27, 0);
  samples[13] = 2;
  samples[4] = std::numeric_limits<double>::quiet_NaN();
  const Volume field = mask_field(VolumeView::of(samples, Size3(3, 3, 3)));
  EXPECT_GT(values(field)[13], 0);
  EXPECT_LT(values(field)[4], 0);
}

std::string error_of(const VolumeView& mask) {
  try {
    mask_field(mask);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MaskField, MasksWithoutABoundaryAreRefused) {
  const std::vector<std::uint8_t> none(27, 0), all(27, 1);
  EXPECT_EQ(error_of(VolumeView::of(none, Size3(3, 3, 3))), "no sample of the mask is inside");
  EXPECT_EQ(error_of(VolumeView::of(all, Size3(3, 3, 3))), "all samples of the mask are inside");
  EXPECT_EQ(error_of(VolumeView::of(none, Size3(27, 1, 1))),
            "the mask has 1 samples along an axis; expected at least 2");
}

}  // namespace
}  // namespace isoatlas::detail
