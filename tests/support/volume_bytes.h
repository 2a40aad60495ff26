// SPDX-License-Identifier: Apache-2.0
// Volume files assembled byte by byte, and the expected results of reading them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "isoatlas/volume_file.h"
#include "support/packed_bytes.h"

namespace isoatlas::detail::test {

template <class Value>
Value reversed(Value value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Value)>>(value);
  std::ranges::reverse(bytes);
  return std::bit_cast<Value>(bytes);
}

template <class Value>
std::string bytes_of(const std::vector<Value>& values, bool big_endian = false) {
  std::string bytes;
  for (Value value : values) {
    if (big_endian) value = reversed(value);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

/// first, first + 1, ...
template <class Value>
std::vector<Value> ramp(std::size_t count, int first = 0) {
  std::vector<Value> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<Value>(first + static_cast<int>(i)));
  return values;
}

template <class Value>
void put(std::string& bytes, std::size_t offset, Value value, bool big_endian) {
  if (big_endian) value = reversed(value);
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

inline std::string decision(const VolumeFile& file, const std::string& key) {
  for (const ReadDecision& decision : file.source.decisions) {
    if (decision.key == key) return decision.value;
  }
  return "";
}

inline void expect_one_warning(const VolumeFile& file, const std::string& text) {
  ASSERT_EQ(file.source.warnings.size(), 1u);
  EXPECT_NE(file.source.warnings[0].find(text), std::string::npos) << file.source.warnings[0];
}

inline void expect_near(const Vec3& value, const Vec3& expected, double tolerance = 1e-7) {
  EXPECT_NEAR(value.x, expected.x, tolerance);
  EXPECT_NEAR(value.y, expected.y, tolerance);
  EXPECT_NEAR(value.z, expected.z, tolerance);
}

}  // namespace isoatlas::detail::test
