// SPDX-License-Identifier: Apache-2.0
// Numbers in text are exact: integers up to 64 bits, and decimal numbers rounded once.
#include "files/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace isoatlas::detail::test {
namespace {

template <class Integer>
std::optional<Integer> integer_in(std::string_view word) {
  Integer value = 0;
  return io::parse_integer_in_decimal(word, value) ? std::optional(value) : std::nullopt;
}

template <class Float>
std::optional<Float> float_in(std::string_view word) {
  Float value = 0;
  return io::parse_number(word, value) ? std::optional(value) : std::nullopt;
}

TEST(NumberText, IntegersInDecimalNotationAreExact) {
  EXPECT_EQ(integer_in<std::int64_t>("9007199254740993.0"), 9007199254740993);  // 2^53 + 1
  EXPECT_EQ(integer_in<std::uint64_t>("18446744073709551615.0"), 18446744073709551615U);
  EXPECT_EQ(integer_in<std::uint64_t>("1844674407370955161.5e1"), 18446744073709551615U);
  EXPECT_EQ(integer_in<std::int64_t>("-9.223372036854775808e18"),
            std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(integer_in<std::uint8_t>("+2.55e+2"), 255);
  EXPECT_EQ(integer_in<std::uint8_t>("-0"), 0);
  EXPECT_EQ(integer_in<std::int8_t>("12800e-2"), std::nullopt);
  EXPECT_EQ(integer_in<std::int8_t>("-12800e-2"), -128);
  EXPECT_EQ(integer_in<std::int32_t>("0e999999999999999999999"), 0);
}

TEST(NumberText, IntegersOutOfRangeAndFractionsAreRefused) {
  EXPECT_EQ(integer_in<std::uint64_t>("18446744073709551616.0"), std::nullopt);
  EXPECT_EQ(integer_in<std::int64_t>("9223372036854775808.0"), std::nullopt);
  EXPECT_EQ(integer_in<std::int64_t>("-9223372036854775809.0"), std::nullopt);
  EXPECT_EQ(integer_in<std::uint64_t>("1e308"), std::nullopt);
  EXPECT_EQ(integer_in<std::uint64_t>("1e999999999999999999999"), std::nullopt);
  EXPECT_EQ(integer_in<std::uint8_t>("-1.0"), std::nullopt);
  for (const char* word : {"1e-320", "2.5", "2.99999999999999999999999", "25e-1"}) {
    EXPECT_EQ(integer_in<std::int64_t>(word), std::nullopt) << word;
  }
}

TEST(NumberText, WordsThatAreNotDecimalNumbersAreRefused) {
  for (const char* word : {"", "+", "-", ".", "e5", "1e", "1e+", "+-5", "++5", "inf", "nan", "0x10",
                           "1 ", " 1", "1,5", "1.2.3"}) {
    EXPECT_EQ(integer_in<std::int64_t>(word), std::nullopt) << word;
  }
}

TEST(NumberText, FloatsAreRoundedOnce) {
  EXPECT_EQ(float_in<double>("1e308"), 1e308);
  EXPECT_EQ(float_in<double>("1e-320"), 1e-320);
  // Just above the middle of two floats: rounding to double first would give the middle, then 1.
  EXPECT_EQ(float_in<float>("1.000000059604644775390626"), std::nextafter(1.0F, 2.0F));
  EXPECT_EQ(float_in<double>("inf"), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(float_in<double>("nan").value_or(0)));
  EXPECT_EQ(float_in<double>("0x10"), std::nullopt);
}

TEST(NumberText, TooSmallFloatsAreZeroAndTooLargeOnesAreRefused) {
  EXPECT_EQ(float_in<double>("1e-400"), 0.0);
  EXPECT_EQ(float_in<float>("0.0000001e-50"), 0.0F);
  EXPECT_TRUE(std::signbit(float_in<double>("-1e-400").value_or(1)));
  EXPECT_EQ(float_in<double>("1e400"), std::nullopt);
  EXPECT_EQ(float_in<float>("-3.5e38"), std::nullopt);
}

}  // namespace
}  // namespace isoatlas::detail::test
