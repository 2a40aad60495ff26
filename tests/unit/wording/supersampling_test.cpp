// SPDX-License-Identifier: Apache-2.0
#include "wording/supersampling.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

VolumeView view_of(const std::vector<float>& samples, const std::array<std::size_t, 3>& size) {
  VolumeView volume;
  volume.grid.size = size;
  volume.type = SampleType::float32;
  volume.samples = samples.data();
  return volume;
}

std::vector<float> noise(const std::array<std::size_t, 3>& size, double share_inside) {
  std::mt19937 random(7);
  std::bernoulli_distribution inside(share_inside);
  std::vector<float> samples(size[0] * size[1] * size[2]);
  for (float& sample : samples) sample = inside(random) ? 1.0F : -1.0F;
  return samples;
}

std::size_t crossed_cells(const std::vector<float>& samples,
                          const std::array<std::size_t, 3>& size) {
  std::size_t count = 0;
  for (std::size_t z = 0; z + 1 < size[2]; ++z)
    for (std::size_t y = 0; y + 1 < size[1]; ++y)
      for (std::size_t x = 0; x + 1 < size[0]; ++x) {
        int inside = 0;
        for (std::size_t corner = 0; corner < 8; ++corner) {
          const std::size_t i = x + (corner & 1), j = y + (corner >> 1 & 1), k = z + (corner >> 2);
          inside += samples[i + size[0] * (j + size[1] * k)] >= 0 ? 1 : 0;
        }
        count += inside > 0 && inside < 8 ? 1 : 0;
      }
  return count;
}

std::string refusal(const VolumeView& volume, std::uint32_t factor, std::uint64_t limit) {
  ExtractOptions options;
  options.supersample = factor;
  try {
    require_memory_for_supersampling(volume, options, limit);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
    return error.what();
  }
  return "";
}

TEST(Supersampling, EstimateCountsEveryCrossedGridCell) {
  for (const std::size_t nx : {2, 3, 61, 62, 63, 64, 65, 66, 126, 127, 128, 129, 200}) {
    for (const double share : {0.0, 0.002, 0.5, 0.998, 1.0}) {
      const std::array<std::size_t, 3> size{nx, 4, 3};
      const std::vector<float> samples = noise(size, share);
      const std::size_t upsampled = (2 * nx - 1) * 7 * 5, cells = 4 * crossed_cells(samples, size);
      ExtractOptions options;
      options.refine.clear();
      options.supersample = 2;
      EXPECT_EQ(estimated_memory(view_of(samples, size), options),
                4 * samples.size() + 250 * cells + upsampled / 8)
          << nx << " " << share;
      options.refine.resize(1);
      EXPECT_EQ(estimated_memory(view_of(samples, size), options),
                4 * samples.size() + 700 * cells + upsampled / 8)
          << nx << " " << share;
    }
  }
}

TEST(Supersampling, RefusalNamesTheLargestFactorThatFitsIntoMemory) {
  const std::array<std::size_t, 3> size{20, 20, 20};
  const std::vector<float> samples = noise(size, 0.5);
  const VolumeView volume = view_of(samples, size);
  ExtractOptions options;
  options.supersample = 9;
  const std::uint64_t limit = estimated_memory(volume, options);
  for (const std::uint32_t factor : {2U, 8U, 9U})
    EXPECT_EQ(refusal(volume, factor, limit), "") << factor;
  for (const std::uint32_t factor : {10U, 11U, 40U}) {
    const std::string text = refusal(volume, factor, limit);
    EXPECT_NE(text.find("supersampling " + std::to_string(factor) + " times needs about"),
              std::string::npos)
        << text;
    EXPECT_TRUE(text.ends_with("expected 9 times at most")) << text;
  }
  EXPECT_TRUE(refusal(volume, 2, 1000).ends_with("expected no supersampling (1)"));
  EXPECT_EQ(refusal(volume, 1, 1), "") << "nothing is supersampled";
}

TEST(Supersampling, RefusalNamesTheLargestFactorWithinTheSampleLimit) {
  const std::array<std::size_t, 3> size{20, 20, 20};
  const std::vector<float> samples(8000, 1.0F);
  const VolumeView volume = view_of(samples, size);
  constexpr std::uint64_t kMuch = std::uint64_t{1} << 60;
  // (19 * 215 + 1)^3 < 2^36 < (19 * 216 + 1)^3
  EXPECT_EQ(refusal(volume, 215, kMuch), "");
  for (const std::uint32_t factor : {216U, 1000U, 4294967295U})
    EXPECT_TRUE(refusal(volume, factor, kMuch).ends_with("2^36: expected 215 times at most"))
        << refusal(volume, factor, kMuch);
}

}  // namespace
}  // namespace isoatlas::detail
