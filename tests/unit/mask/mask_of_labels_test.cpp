// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "isoatlas/mask_field.h"

namespace isoatlas {
namespace {

template <class T>
std::vector<int> mask_of(const std::vector<T>& samples, std::vector<std::int64_t> wanted) {
  const Volume mask =
      mask_of_labels(VolumeView::of(samples, Size3(samples.size() / 4, 2, 2)), wanted);
  const auto* first = static_cast<const std::uint8_t*>(mask.view.samples);
  return {first, first + samples.size()};
}

template <class T>
std::string error_of(const std::vector<T>& samples, std::vector<std::int64_t> wanted) {
  try {
    mask_of(samples, wanted);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MaskOfLabels, IsTheUnionOfTheLabels) {
  const std::vector<std::uint8_t> labels{0, 1, 2, 3, 3, 2, 1, 0};
  EXPECT_EQ(mask_of(labels, {2}), (std::vector<int>{0, 0, 1, 0, 0, 1, 0, 0}));
  EXPECT_EQ(mask_of(labels, {0, 3}), (std::vector<int>{1, 0, 0, 1, 1, 0, 0, 1}));
}

TEST(MaskOfLabels, LabelsAreComparedInTheTypeOfTheFile) {
  const std::int64_t large = (std::int64_t{1} << 40) + 1;
  const std::vector<std::int64_t> labels{large, large - 1, 1, -5, 0, 0, 0, 0};
  EXPECT_EQ(mask_of(labels, {large}), (std::vector<int>{1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(mask_of(labels, {-5}), (std::vector<int>{0, 0, 0, 1, 0, 0, 0, 0}));
  const std::vector<std::uint8_t> bytes{255, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(error_of(bytes, {-1}), "no sample has the label -1; the labels are 0, 255");
}

TEST(MaskOfLabels, WholeFloatsAreLabels) {
  const std::vector<float> labels{0, 4, 0, 4, 0, 0, 0, 7};
  EXPECT_EQ(mask_of(labels, {4}), (std::vector<int>{0, 1, 0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(error_of(labels, {5}), "no sample has the label 5; the labels are 0, 4, 7");
  const std::vector<float> values{0, 4, 0, 4, 0, 0.5f, 0, 7};
  EXPECT_EQ(error_of(values, {4}),
            "sample (1, 0, 1) is 0.500000, expected whole numbers: only a label map has labels; "
            "use an isovalue");
}

TEST(MaskOfLabels, TheFirstLabelsAreListed) {
  std::vector<std::uint16_t> labels(16);
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = static_cast<std::uint16_t>(3 * i);
  EXPECT_EQ(error_of(labels, {1}),
            "no sample has the label 1; the labels are 0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 33, "
            "...");
}

}  // namespace
}  // namespace isoatlas
