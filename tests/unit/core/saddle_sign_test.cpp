// SPDX-License-Identifier: Apache-2.0
// saddle_sign against exact integers: every double is a whole multiple of 2^-1140.
#include "core/saddle_sign.h"

#include <gtest/gtest.h>

#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using boost::multiprecision::cpp_int;
using test::Random;

cpp_int exact(long double v) {
  int exponent = 0;
  const long double m = std::frexp(std::fabs(v), &exponent);
  cpp_int out = static_cast<std::uint64_t>(std::ldexp(m, 64));
  const int binary_exponent = exponent - 64 + 1140;
  if (binary_exponent >= 0) {
    out <<= binary_exponent;
  } else {
    EXPECT_EQ((out >> -binary_exponent) << -binary_exponent, out)
        << "the test's own scale is too coarse";
    out >>= -binary_exponent;
  }
  return v < 0 ? -out : out;
}

int exact_sign(long double a, long double b, long double c, long double d, long double q) {
  const cpp_int e = exact(q);
  const cpp_int det = (exact(a) - e) * (exact(b) - e) - (exact(c) - e) * (exact(d) - e);
  return det.sign();
}

void expect_exact(long double a, long double b, long double c, long double d, long double q) {
  const auto sample = [](long double x) {
    const auto high = static_cast<double>(x);
    return ExactSample(high, static_cast<double>(x - high));
  };
  ASSERT_EQ(saddle_sign(sample(a), sample(b), sample(c), sample(d), sample(q)),
            exact_sign(a, b, c, d, q))
      << std::hexfloat << a << ", " << b << ", " << c << ", " << d << ", " << q;
}

double any_finite_double(Random& random) {
  for (;;) {
    const double v = std::bit_cast<double>(random.bits());
    if (std::isfinite(v)) return v;
  }
}

TEST(SaddleSign, AnyDoubles) {
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    expect_exact(any_finite_double(random), any_finite_double(random), any_finite_double(random),
                 any_finite_double(random), any_finite_double(random));
  }
}

TEST(SaddleSign, DoublesOfOneMagnitude) {
  Random random(2);
  for (const double scale : {1.0, 1e-300, 0x1p-1074, 1e300, 1e-20}) {
    for (int i = 0; i < 3000; ++i) {
      const auto v = [&] {
        return scale * (scale == 0x1p-1074 ? static_cast<double>(random.between(-50, 50))
                                           : random.unit() - 0.5);
      };
      expect_exact(v(), v(), v(), v(), v());
    }
  }
}

// (a - q)(b - q) and (c - q)(d - q) are the same product grouped in two ways, then one sample moves
// by one unit in the last place: only exact arithmetic can decide this.
TEST(SaddleSign, ExactTiesAndTheirNeighbours) {
  Random random(3);
  int ties = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto factor = [&] {
      return static_cast<double>(random.between(1, 40000)) * (random.bits() & 1 ? 1 : -1);
    };
    const double p = factor(), r = factor(), s = factor(), t = factor();
    const double q = static_cast<double>(random.between(-1000000, 1000000));
    const double scale = std::ldexp(1.0, static_cast<int>(random.between(-1000, 900)));
    double v[4] = {(q + p * r) * scale, (q + s * t) * scale, (q + p * s) * scale,
                   (q + r * t) * scale};
    const double level = q * scale;
    expect_exact(v[0], v[1], v[2], v[3], level);
    ASSERT_EQ(saddle_sign(v[0], v[1], v[2], v[3], level), 0);
    ++ties;
    double& moved = v[random.bits() % 4];
    moved = std::nextafter(moved, random.bits() & 1 ? INFINITY : -INFINITY);
    expect_exact(v[0], v[1], v[2], v[3], level);
  }
  EXPECT_EQ(ties, 20000);
}

// x y against (x + 1)(y - 1), which is y - x - 1 less: products of 100 bits that differ in the last
// one or two.
TEST(SaddleSign, ProductsThatDifferInTheirLastBits) {
  Random random(7);
  int signs[3]{};
  for (int i = 0; i < 20000; ++i) {
    const double x =
        static_cast<double>(random.between(std::int64_t{1} << 50, std::int64_t{1} << 51));
    const double y = x + 1 + static_cast<double>(random.between(-2, 2));
    const double q =
        static_cast<double>(random.between(-(std::int64_t{1} << 50), std::int64_t{1} << 50));
    const double scale = std::ldexp(1.0, static_cast<int>(random.between(-1000, 900)));
    const double v[5] = {(q + x) * scale, (q + y) * scale, (q + x + 1) * scale, (q + y - 1) * scale,
                         q * scale};
    expect_exact(v[0], v[1], v[2], v[3], v[4]);
    expect_exact(v[2], v[3], v[1], v[0], v[4]);
    ++signs[1 + saddle_sign(v[0], v[1], v[2], v[3], v[4])];
  }
  EXPECT_GT(signs[0], 1000);
  EXPECT_GT(signs[1], 1000);
  EXPECT_GT(signs[2], 1000);
}

TEST(SaddleSign, IsovalueMovedByOneUnitInTheLastPlace) {
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const double q = random.unit();
    const double up = std::nextafter(q, 2.0), down = std::nextafter(q, -2.0);
    const double values[] = {q, up, down, std::nextafter(up, 2.0), std::nextafter(down, -2.0)};
    const auto v = [&] { return values[random.bits() % 5]; };
    expect_exact(v(), v(), v(), v(), q);
  }
}

TEST(SaddleSign, Integers64) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&]() -> long double {
      return random.bits() & 1 ? static_cast<long double>(random.bits())
                               : static_cast<long double>(static_cast<std::int64_t>(random.bits()));
    };
    expect_exact(any(), any(), any(), any(), static_cast<double>(any()));
  }
  // Neighbours at the ends of the ranges, which are equal as doubles.
  for (const long double base :
       {18446744073709551600.0L, 9223372036854775790.0L, -9223372036854775808.0L}) {
    const double q = static_cast<double>(base);
    for (int i = 0; i < 5000; ++i) {
      const auto near = [&] { return base + static_cast<long double>(random.between(0, 15)); };
      expect_exact(near(), near(), near(), near(), q);
    }
  }
}

TEST(ExactSample, HoldsEveryIntegerExactly) {
  Random random(8);
  const auto expect_whole = [](auto value) {
    const ExactSample sample = value;
    EXPECT_EQ(cpp_int(static_cast<std::int64_t>(sample.low)) + cpp_int(sample.high),
              cpp_int(value));
    EXPECT_EQ(static_cast<double>(static_cast<std::int64_t>(sample.low)), sample.low);
  };
  for (int i = 0; i < 10000; ++i) {
    expect_whole(random.bits() >> (i % 64));
    expect_whole(static_cast<std::int64_t>(random.bits()) >> (i % 64));
  }
  expect_whole(std::numeric_limits<std::uint64_t>::max());
  expect_whole(std::numeric_limits<std::int64_t>::max());
  expect_whole(std::numeric_limits<std::int64_t>::min());
  expect_whole(std::int8_t{-128});
}

TEST(SaddleSign, HugeBesideTiny) {
  const double huge = std::numeric_limits<double>::max(),
               tiny = std::numeric_limits<double>::denorm_min();
  const double values[] = {huge, -huge, tiny, -tiny, 0.0, 1.0, -1.0, std::nextafter(huge, 0.0)};
  for (const double a : values) {
    for (const double b : values) {
      for (const double c : values) {
        for (const double d : values) {
          for (const double q : values) expect_exact(a, b, c, d, q);
        }
      }
    }
  }
}

TEST(SaddleSign, SwappingTheDiagonalsFlipsTheSign) {
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const auto v = [&] { return static_cast<double>(random.between(-3, 3)); };
    const double a = v(), b = v(), c = v(), d = v(), q = v();
    ASSERT_EQ(saddle_sign(a, b, c, d, q), -saddle_sign(c, d, a, b, q));
    ASSERT_EQ(saddle_sign(a, b, c, d, q), saddle_sign(b, a, d, c, q));
    ASSERT_EQ(saddle_sign(a, b, c, d, q), saddle_sign(-a, -b, -c, -d, -q));
  }
}

}  // namespace
}  // namespace isoatlas::detail
