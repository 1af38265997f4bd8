// SPDX-License-Identifier: Apache-2.0
#include "engine/support/normal_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace prospect::normal_distribution_test {
namespace {

long double exact_cdf(long double x) { return 0.5L * std::erfc(-x / std::sqrt(2.0L)); }

long double exact_density(long double x) {
  return std::exp(-0.5L * x * x) / std::sqrt(2.0L * 3.14159265358979323846264338327950288L);
}

template <typename T>
struct Errors {
  double exponential = 0, density = 0, cdf_absolute = 0, cdf_tail = 0;
};

template <typename T>
Errors<T> sweep(T exponent_range, T normal_range) {
  std::mt19937_64 rng(11);
  Errors<T> e;
  const auto relative = [](T value, long double exact) {
    return static_cast<double>(std::abs((value - exact) / exact));
  };
  for (int n = 0; n < 400000; ++n) {
    // Half of the arguments near zero, where most of use is.
    const T scale = n % 2 ? T(1) : T(0.1);
    const T x = scale * std::uniform_real_distribution<T>(-exponent_range, exponent_range)(rng);
    e.exponential =
        std::max(e.exponential, relative(exponential(x), std::exp(static_cast<long double>(x))));
    const T y = scale * std::uniform_real_distribution<T>(-normal_range, normal_range)(rng);
    T cdf, density;
    normal(y, cdf, density);
    EXPECT_EQ(cdf, normal_cdf(y));
    EXPECT_EQ(density, normal_density(y));
    e.density = std::max(e.density, relative(density, exact_density(y)));
    e.cdf_absolute = std::max(e.cdf_absolute, static_cast<double>(std::abs(cdf - exact_cdf(y))));
    if (y < 0) e.cdf_tail = std::max(e.cdf_tail, relative(cdf, exact_cdf(y)));
  }
  return e;
}

TEST(NormalDistribution, DoubleErrorsAreAsDocumented) {
  const Errors<double> e = sweep<double>(700.0, 12.0);
  std::printf("double: exp %.2e density %.2e cdf %.2e tail %.2e\n", e.exponential, e.density,
              e.cdf_absolute, e.cdf_tail);
  EXPECT_LT(e.exponential, 6e-16);
  EXPECT_LT(e.density, 1e-14);
  EXPECT_LT(e.cdf_absolute, 4e-16);
  EXPECT_LT(e.cdf_tail, 2e-7);
}

TEST(NormalDistribution, FloatErrorsAreAsDocumented) {
  const Errors<float> e = sweep<float>(85.0f, 5.0f);
  std::printf("float: exp %.2e density %.2e cdf %.2e tail %.2e\n", e.exponential, e.density,
              e.cdf_absolute, e.cdf_tail);
  EXPECT_LT(e.exponential, 2e-7);
  EXPECT_LT(e.density, 2e-6);
  EXPECT_LT(e.cdf_absolute, 2e-7);
  EXPECT_LT(e.cdf_tail, 2e-6);
}

TEST(NormalDistribution, TailIsRelativelyAccurate) {
  for (double x = 0.0; x >= -37.0; x -= 0.037) {
    EXPECT_NEAR(normal_cdf(x) / static_cast<double>(exact_cdf(x)), 1.0, x > -3.0 ? 3e-14 : 4e-6)
        << x;
  }
  for (float x = 0.0f; x >= -12.0f; x -= 0.037f) {
    EXPECT_NEAR(static_cast<double>(normal_cdf(x) / exact_cdf(x)), 1.0, 1e-5) << x;
  }
}

TEST(NormalDistribution, ClampsInsteadOfOverflowing) {
  const double huge = std::numeric_limits<double>::max();
  for (const double x : {800.0, 1e6, huge}) {
    EXPECT_TRUE(std::isfinite(exponential(x)));
    EXPECT_GT(exponential(x), 1e300);
    EXPECT_LT(exponential(-x), 1e-300);
    EXPECT_GE(exponential(-x), 0.0);
    EXPECT_EQ(normal_cdf(x), 1.0);
    EXPECT_GE(normal_cdf(-x), 0.0);
    EXPECT_LT(normal_cdf(-x), 1e-300);
    EXPECT_LT(normal_density(x), 1e-300);
  }
  EXPECT_EQ(normal_cdf(0.0), 0.5);
  EXPECT_EQ(normal_cdf(-0.0), 0.5);
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(0.0f), 1.0f);
}

TEST(NormalDistribution, DensityIsTheDerivativeOfTheCdf) {
  for (double x = -8.0; x <= 8.0; x += 0.1) {
    const double h = 1e-3;
    const double numeric = (8.0 * (normal_cdf(x + h) - normal_cdf(x - h)) -
                            (normal_cdf(x + 2 * h) - normal_cdf(x - 2 * h))) /
                           (12.0 * h);
    EXPECT_NEAR(numeric, normal_density(x), 5e-12) << x;
  }
}

}  // namespace
}  // namespace prospect::normal_distribution_test
