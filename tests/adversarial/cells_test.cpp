// SPDX-License-Identifier: Apache-2.0
// Sign patterns in one or eight grid cells, with random or equal magnitudes; and noise, which has
// all patterns.
#include <array>

#include "adversarial/sound_levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// Largest magnitudes of samples: all samples tie, many do, some do, or hardly any.
constexpr std::array<std::int64_t, 4> kLargest{1, 2, 9, 100000};

std::int64_t magnitude(Random& random, std::int64_t largest) {
  return random.between(random.bits() % 16 == 0 ? 0 : 1, largest);
}

TEST(Adversarial, EverySignPatternOfOneCell) {
  Random random(11);
  const int rounds = many() ? 4 : 1;
  for (int pattern = 1; pattern < 255; ++pattern) {
    for (const std::int64_t largest : kLargest) {
      for (int round = 0; round < rounds; ++round) {
        Samples s = constant({2, 2, 2}, 0);
        for (int c = 0; c < 8; ++c)
          s.values[c] = (pattern >> c & 1 ? 1 : -1) * magnitude(random, largest);
        expect_sound(s, "pattern " + std::to_string(pattern) + " of " + std::to_string(largest), 0,
                     random.bits() % 2 ? Inside::above : Inside::below);
        if (HasFailure()) return;
      }
    }
  }
}

// The grid cell is in the middle of a volume, so that its surface continues on all sides.
TEST(Adversarial, EverySignPatternOfOneCellAmongOthers) {
  Random random(12);
  const int rounds = many() ? 3 : 1;
  for (int pattern = 1; pattern < 255; ++pattern) {
    for (int round = 0; round < rounds; ++round) {
      const std::int64_t largest = kLargest[random.bits() % kLargest.size()],
                         around = random.bits() % 2 ? 1 : -1;
      Samples s = constant({4, 4, 4}, 0);
      for (std::int64_t& v : s.values) v = around * random.between(1, largest);
      for (std::size_t c = 0; c < 8; ++c)
        s.at(1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2)) =
            (pattern >> c & 1 ? 1 : -1) * magnitude(random, largest);
      expect_sound(s, "pattern " + std::to_string(pattern) + " of " + std::to_string(largest) +
                          " in " + std::to_string(around));
      if (HasFailure()) return;
    }
  }
}

// A selection of the 2^27 patterns, without and with a layer of equal samples around them.
TEST(Adversarial, SignPatternsOfThreeByThreeByThree) {
  Random random(13);
  const int count = is_night() ? 4'000 : many() ? 1'000 : 500;
  for (int k = 0; k < count; ++k) {
    const auto pattern = static_cast<std::uint32_t>(random.bits() & ((1u << 27) - 1) &
                                                    (k % 3 == 0 ? random.bits() : ~0ull));
    const std::int64_t largest = kLargest[random.bits() % kLargest.size()];
    const std::int64_t around = random.between(-1, 1);
    const std::size_t first = around == 0 ? 0 : 1, n = 3 + 2 * first;
    Samples s = constant({n, n, n}, around * largest);
    for (std::size_t c = 0; c < 27; ++c)
      s.at(first + c % 3, first + c / 3 % 3, first + c / 9) =
          (pattern >> c & 1 ? 1 : -1) * magnitude(random, largest);
    expect_sound(s, "pattern " + std::to_string(pattern) + " of " + std::to_string(largest) +
                        " in " + std::to_string(around) + ", number " + std::to_string(k));
    if (HasFailure()) return;
  }
}

TEST(Adversarial, WhiteNoise) {
  for (const Family family :
       {Family::white_noise, Family::few_values, Family::signs_only, Family::checkerboard}) {
    expect_sound(random_samples(family, {10, 9, 8}, 21), name(family));
    if (HasFailure()) return;
  }
}

TEST(Adversarial, WhiteNoise64) {
  if (!is_night()) GTEST_SKIP() << "takes minutes; ISOATLAS_ADVERSARIAL=night";
  const Volume volume = to_volume(random_samples(Family::white_noise, {64, 64, 64}, 22));
  const Extraction e = expect_sound(volume, default_levels(volume, 0), "white noise");
  EXPECT_GT(e.report.reference.genus, 10'000);
  EXPECT_GT(e.report.tunnels, 1000u);
}

}  // namespace
}  // namespace isoatlas::detail
