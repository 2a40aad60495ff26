// SPDX-License-Identifier: Apache-2.0
// Inside or outside, for every sample type, against comparisons in long double (which holds every
// value of every type).
#include "field/classify.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "field/sample_type.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::own;
using test::Random;

static_assert(std::numeric_limits<long double>::digits >= 64);

bool bit(const SignBits& signs, std::size_t position, std::size_t y, std::size_t z) {
  return (signs.row(y, z)[position / 64] >> (position % 64)) & 1;
}

// The documented rule. NaN is classified by the policy, infinities by their sign.
template <class T>
bool expected_inside(T v, const InsideRule& rule) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(v))
      return (rule.non_finite == NonFinite::above) == (rule.inside == Inside::above);
  }
  const auto x = static_cast<long double>(v), q = static_cast<long double>(rule.isovalue);
  return rule.inside == Inside::above ? x >= q : x <= q;
}

template <class T>
void expect_classified(SampleType type, const std::vector<T>& values, const InsideRule& rule) {
  Grid grid;
  grid.size = {values.size(), 1, 1};
  const Volume volume = own(grid, type, values);
  const SignBits signs = classify(volume, rule, {});
  bool any_inside = false, any_outside = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool want = expected_inside(values[i], rule);
    (want ? any_inside : any_outside) = true;
    ASSERT_EQ(bit(signs, i + 1, 0, 0), want)
        << name(type) << " " << static_cast<long double>(values[i]) << " at isovalue "
        << rule.isovalue << (rule.inside == Inside::above ? " above" : " below");
  }
  EXPECT_EQ(signs.any_inside, any_inside) << name(type) << " " << rule.isovalue;
  EXPECT_EQ(signs.any_outside, any_outside) << name(type) << " " << rule.isovalue;
}

std::vector<double> hard_isovalues() {
  std::vector<double> out{0.0,
                          -0.0,
                          0.5,
                          -0.5,
                          0.1,
                          -0.1,
                          1.0,
                          -1.0,
                          1e300,
                          -1e300,
                          5e-324,
                          -5e-324,
                          std::numeric_limits<double>::max(),
                          std::numeric_limits<double>::lowest(),
                          std::numeric_limits<float>::max(),
                          -std::numeric_limits<float>::max(),
                          std::numeric_limits<float>::min(),
                          std::numeric_limits<float>::denorm_min(),
                          1e39,
                          -1e39};
  for (const double edge : {0x1p7, 0x1p8, 0x1p15, 0x1p16, 0x1p31, 0x1p32, 0x1p63, 0x1p64}) {
    for (const double v :
         {edge, -edge, edge - 1, -edge - 1, edge - 0.5, -edge - 0.5, edge - 1.5, -edge + 0.5})
      out.push_back(v);
  }
  const std::vector<double> base = out;
  for (const double v : base) {
    if (std::abs(v) < 1e300) {
      out.push_back(std::nextafter(v, INFINITY));
      out.push_back(std::nextafter(v, -INFINITY));
    }
  }
  return out;
}

template <class T>
std::vector<T> hard_values(const std::vector<double>& isovalues) {
  using Limits = std::numeric_limits<T>;
  std::vector<T> out{Limits::lowest(), Limits::max(), T{0}, T{1}};
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    if constexpr (std::is_floating_point_v<T>) {
      out.push_back(static_cast<T>((random.unit() - 0.5) *
                                   std::pow(10.0, static_cast<double>(random.between(-40, 38)))));
    } else {
      out.push_back(static_cast<T>(random.bits()));
    }
  }
  for (const double v : isovalues) {  // the values around every isovalue
    if constexpr (std::is_floating_point_v<T>) {
      if (std::abs(v) > static_cast<double>(Limits::max())) continue;
      const T t = static_cast<T>(v);
      for (const T near :
           {t, std::nextafter(t, Limits::infinity()), std::nextafter(t, -Limits::infinity())}) {
        if (std::isfinite(near)) out.push_back(near);
      }
    } else {
      for (int d = -2; d <= 2; ++d) {
        const long double near = std::floor(static_cast<long double>(v)) + d;
        if (near >= static_cast<long double>(Limits::min()) &&
            near <= static_cast<long double>(Limits::max()))
          out.push_back(static_cast<T>(near));
      }
    }
  }
  return out;
}

TEST(Classify, EverySampleTypeAtEveryHardIsovalue) {
  const std::vector<double> isovalues = hard_isovalues();
  for (const SampleType type : test::kAllTypes) {
    visit_sample_type(type, [&]<class T>(const T*) {
      const std::vector<T> values = hard_values<T>(isovalues);
      for (const double isovalue : isovalues) {
        for (const Inside inside : {Inside::above, Inside::below})
          expect_classified(type, values, {isovalue, inside, NonFinite::refuse});
      }
    });
  }
}

TEST(Classify, EveryValueOfEightBits) {
  std::vector<std::int8_t> small;
  std::vector<std::uint8_t> large;
  for (int v = -128; v < 128; ++v) {
    small.push_back(static_cast<std::int8_t>(v));
    large.push_back(static_cast<std::uint8_t>(v + 128));
  }
  for (double isovalue = -300; isovalue <= 300; isovalue += 0.25) {
    for (const Inside inside : {Inside::above, Inside::below}) {
      expect_classified(SampleType::int8, small, {isovalue, inside, NonFinite::refuse});
      expect_classified(SampleType::uint8, large, {isovalue, inside, NonFinite::refuse});
    }
  }
}

template <class T>
void non_finite_policies(SampleType type) {
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  const std::vector<T> values{1,
                              nan,
                              -1,
                              inf,
                              2,
                              -inf,
                              -nan,
                              0,
                              std::numeric_limits<T>::max(),
                              std::numeric_limits<T>::lowest()};
  for (const double isovalue :
       {0.0, 1.0, 1.5, -7.0, static_cast<double>(std::numeric_limits<T>::max())}) {
    for (const Inside inside : {Inside::above, Inside::below}) {
      for (const NonFinite policy : {NonFinite::above, NonFinite::below})
        expect_classified(type, values, {isovalue, inside, policy});
    }
  }
}
TEST(Classify, NonFinitePolicies) {
  non_finite_policies<float>(SampleType::float32);
  non_finite_policies<double>(SampleType::float64);
}

TEST(Classify, InfinityKeepsItsSideBeyondTheRangeOfFloat) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{1, inf, -inf, std::nanf("")};
  for (const double isovalue : {1e39, -1e39}) {
    for (const Inside inside : {Inside::above, Inside::below}) {
      for (const NonFinite policy : {NonFinite::above, NonFinite::below}) {
        expect_classified(SampleType::float32, values, {isovalue, inside, policy});
      }
    }
  }
}

TEST(Classify, RefusesNonFiniteSamplesAndReportsWhere) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    Grid grid;
    grid.size = {5, 4, 3};
    std::vector<float> values(60, 1.0f);
    values[2 + 5 * (3 + 4 * 1)] = bad;
    values[4 + 5 * (0 + 4 * 2)] = bad;
    const Volume volume = own(grid, SampleType::float32, values);
    try {
      classify(volume, {0, Inside::above, NonFinite::refuse}, {});
      FAIL() << "accepted " << bad;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::unsupported);
      const std::string message = e.what();
      EXPECT_NE(message.find("(2, 3, 1)"), std::string::npos) << message;
      EXPECT_NE(message.find(std::isnan(bad) ? "2 NaN" : "2 infinite"), std::string::npos)
          << message;
    }
  }
}

TEST(Classify, RowsOfAnyLengthArePaddedByOneClampedSample) {
  Random random(3);
  for (std::size_t nx = 1; nx < 200; nx += nx < 140 ? 1 : 13) {
    Grid grid;
    grid.size = {nx, 2, 3};
    std::vector<std::int16_t> values(nx * 6);
    for (auto& v : values) v = static_cast<std::int16_t>(random.between(-1, 1));
    const SignBits signs =
        classify(own(grid, SampleType::int16, values), {0, Inside::above, NonFinite::refuse}, {});
    for (std::size_t z = 0; z < 3; ++z) {
      for (std::size_t y = 0; y < 2; ++y) {
        const auto inside = [&](std::size_t x) { return values[x + nx * (y + 2 * z)] >= 0; };
        ASSERT_EQ(bit(signs, 0, y, z), inside(0));
        for (std::size_t x = 0; x < nx; ++x)
          ASSERT_EQ(bit(signs, x + 1, y, z), inside(x)) << nx << " " << x;
        ASSERT_EQ(bit(signs, nx + 1, y, z), inside(nx - 1)) << nx;
      }
    }
  }
}

TEST(Classify, FindsASingleSampleOnTheOtherSide) {
  for (const std::size_t nx : {62u, 63u, 64u, 65u, 126u, 127u}) {
    for (std::size_t at = 0; at < nx; ++at) {
      for (const std::int8_t sign : {1, -1}) {
        Grid grid;
        grid.size = {nx, 2, 2};
        std::vector<std::int8_t> values(4 * nx, static_cast<std::int8_t>(-sign));
        SignBits signs = classify(own(grid, SampleType::int8, values),
                                  {0.5, Inside::above, NonFinite::refuse}, {});
        ASSERT_NE(signs.any_inside, signs.any_outside);
        values[at + 3 * nx] = sign;
        signs = classify(own(grid, SampleType::int8, values),
                         {0.5, Inside::above, NonFinite::refuse}, {});
        ASSERT_TRUE(signs.any_inside && signs.any_outside) << nx << " " << at;
      }
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
