// SPDX-License-Identifier: Apache-2.0
// Surfaces that are difficult for the grid: at the volume boundary, one sample wide, a tenth of a
// voxel apart, in long grid cells.
#include <array>
#include <cmath>
#include <vector>

#include "adversarial/sound_levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr std::size_t kSize = 7;

// The 8 corners, 12 edge midpoints, 6 face centres and the centre of the volume.
std::vector<Size> places(std::size_t n) {
  std::vector<Size> out;
  for (const std::size_t z : {std::size_t{0}, n / 2, n - 1}) {
    for (const std::size_t y : {std::size_t{0}, n / 2, n - 1}) {
      for (const std::size_t x : {std::size_t{0}, n / 2, n - 1}) out.push_back({x, y, z});
    }
  }
  return out;
}

int axes_at_the_boundary(const Size& p) {
  int count = 0;
  for (const std::size_t x : p) count += x == 0 || x == kSize - 1;
  return count;
}

void expect_sound_with_negated(const Samples& s, const std::string& what,
                               Vec3 spacing = {1, 1, 1}) {
  expect_sound(s, what, 0, Inside::above, spacing);
  expect_sound(negated(s), what + ", negated", 0, Inside::above, spacing);
}

TEST(Adversarial, OneSampleAtEveryFaceEdgeAndCorner) {
  for (const Size& p : places(kSize)) {
    Samples s = constant({kSize, kSize, kSize}, -7);
    s.at(p[0], p[1], p[2]) = 5;
    const std::string what =
        "sample " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
    expect_sound_with_negated(s, what);
    // Isovalues that equal a sample: the surface passes through samples at the boundary.
    expect_sound(s, what + ", tied", 5);
    expect_sound(s, what + ", tied below", -7, Inside::below);
    if (HasFailure()) return;
  }
}

TEST(Adversarial, BallsAboutEveryFaceEdgeAndCorner) {
  for (const Size& p : places(kSize)) {
    const Vec3 c{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    // With radius 3, the ball about the middle is tangent to all faces.
    for (const double radius : {2.0, 2.9, 3.0, 3.2, 4.0}) {
      const std::string what = "ball of radius " + std::to_string(radius) + " with " +
                               std::to_string(axes_at_the_boundary(p)) + " axes cut";
      expect_sound_with_negated(sampled({kSize, kSize, kSize}, sphere(c, radius)), what);
      if (HasFailure()) return;
    }
  }
}

TEST(Adversarial, AllFacesEdgesOrCornersAtOnce) {
  // Bit n of `inside`: samples with n axes at the boundary are inside.
  for (int inside = 1; inside < 16; ++inside) {
    for (const std::int64_t low : {-1, -3, -100}) {
      Samples s = constant({kSize, kSize, kSize}, low);
      for (std::size_t z = 0; z < kSize; ++z) {
        for (std::size_t y = 0; y < kSize; ++y) {
          for (std::size_t x = 0; x < kSize; ++x) {
            if (inside >> axes_at_the_boundary({x, y, z}) & 1) s.at(x, y, z) = 2;
          }
        }
      }
      expect_sound_with_negated(s, "inside " + std::to_string(inside) + " " + std::to_string(low));
      if (HasFailure()) return;
    }
  }
}

// Lines of single samples: straight, with corners, along diagonals of faces and of cells.
TEST(Adversarial, StripsOneVoxelWide) {
  std::vector<std::pair<std::string, std::vector<Size>>> strips;
  for (std::size_t at : {std::size_t{0}, kSize / 2, kSize - 1}) {
    std::vector<Size> straight, flat, steep, corners, zigzag;
    for (std::size_t i = 0; i < kSize; ++i) {
      straight.push_back({i, at, kSize / 2});
      flat.push_back({i, i, at});
      steep.push_back({i, i, kSize - 1 - i});
      corners.push_back({i, i, at});
      corners.push_back({std::min(i + 1, kSize - 1), i, at});
      zigzag.push_back({i, at, i % 2});
    }
    strips.insert(strips.end(), {{"straight", straight},
                                 {"across faces", flat},
                                 {"across cells", steep},
                                 {"stairs", corners},
                                 {"zigzag", zigzag}});
  }
  for (const auto& [what, strip] : strips) {
    for (const auto& [high, low] :
         {std::pair<int, int>{1, -1}, {9, -2}, {2, -9}, {1, -1000}, {1000, -1}}) {
      Samples s = constant({kSize, kSize, kSize}, low);
      for (const Size& p : strip) s.at(p[0], p[1], p[2]) = high;
      expect_sound_with_negated(s, what + " " + std::to_string(high) + " " + std::to_string(low));
      if (HasFailure()) return;
    }
  }
}

TEST(Adversarial, VolumesOneCellThin) {
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    Size size{2, 2, 2};
    size[seed % 3] = 9;
    if (seed % 2 != 0) size[(seed + 1) % 3] = 8;
    expect_sound_with_negated(random_samples(static_cast<Family>(seed % kFamilies), size, seed),
                              "seed " + std::to_string(seed));
    if (HasFailure()) return;
  }
}

// A layer of samples that are barely inside, between samples far outside: two sheets that are a
// tenth of a voxel apart.
Samples sheets(Size size, const std::function<std::int64_t(std::size_t, std::size_t)>& height,
               std::size_t period = 1000) {
  Samples s = constant(size, -19);
  for (std::size_t z = 0; z < size[2]; ++z) {
    for (std::size_t y = 0; y < size[1]; ++y) {
      for (std::size_t x = 0; x < size[0]; ++x) {
        const std::int64_t above = static_cast<std::int64_t>(z) - height(x, y);
        if (above % static_cast<std::int64_t>(period) == 0) s.at(x, y, z) = 1;
      }
    }
  }
  return s;
}

TEST(Adversarial, SheetsATenthOfAVoxelApart) {
  const Size size{14, 13, 12};
  expect_sound_with_negated(sheets(size, [](std::size_t, std::size_t) { return 5; }), "flat");
  expect_sound_with_negated(sheets(size, [](std::size_t, std::size_t) { return 0; }),
                            "flat, at the boundary");
  expect_sound_with_negated(sheets(
                                size, [](std::size_t, std::size_t) { return 1; }, 2),
                            "many");
  expect_sound_with_negated(
      sheets(size, [](std::size_t x, std::size_t) { return static_cast<std::int64_t>(x); }),
      "at 45 degrees");
  expect_sound_with_negated(
      sheets(
          size, [](std::size_t x, std::size_t y) { return static_cast<std::int64_t>((x + y) / 3); },
          4),
      "stairs");
  const auto wave = [](std::size_t x, std::size_t y) {
    return std::llround(5.5 + 3 * std::sin(0.6 * static_cast<double>(x)) +
                        2 * std::cos(0.5 * static_cast<double>(y)));
  };
  expect_sound_with_negated(sheets(size, wave), "wave");
  // Curved sheets: few samples are within a twentieth of a voxel of the surface, so that it breaks
  // into pieces.
  expect_sound_with_negated(sampled({16, 16, 16}, nested_shells({7.4, 7.6, 7.55}, {5.0, 5.1})),
                            "shells");
  expect_sound_with_negated(sampled({16, 16, 16},
                                    [](double x, double y, double z) {
                                      return 0.05 - std::abs(0.36 * x + 0.48 * y + 0.8 * z - 12);
                                    }),
                            "slab");
}

TEST(Adversarial, CellsTwentyTimesAsLong) {
  for (int axis = many() ? 0 : 2; axis < 3; ++axis) {
    const Vec3 spacing = axis == 0 ? Vec3{20, 1, 1} : axis == 1 ? Vec3{1, 20, 1} : Vec3{1, 1, 20};
    const std::string what = ", long axis " + std::to_string(axis);
    for (int family = 0; family < kFamilies; ++family)
      expect_sound_with_negated(random_samples(static_cast<Family>(family), {5, 5, 4}, 31),
                                name(static_cast<Family>(family)) + what, spacing);
    expect_sound_with_negated(
        sheets({9, 8, 7},
               [](std::size_t x, std::size_t) { return static_cast<std::int64_t>(x / 2); }),
        "sheets" + what, spacing);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace isoatlas::detail
