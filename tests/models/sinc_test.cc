// SPDX-License-Identifier: Apache-2.0
#include "models/sinc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::sinc_test {
namespace {

// The full Taylor series in extended precision, as the reference on both sides of the switch.
long double series(long double x, bool derivative) {
  long double sum = 0.0L, factorial = 1.0L, power = 1.0L;  // (2n+1)!, x^(2n)
  for (int n = 0; n < 40; ++n) {
    if (n > 0) {
      factorial *= static_cast<long double>(2 * n) * (2 * n + 1);
      power *= x * x;
    }
    const long double sign = n % 2 == 0 ? 1.0L : -1.0L;
    if (!derivative) {
      sum += sign * power / factorial;
    } else if (n > 0) {
      sum += sign * 2 * n * (power / x) / factorial;
    }
  }
  return sum;
}

TEST(Sinc, AgreesWithItsTaylorSeriesOnBothSidesOfTheSwitch) {
  for (double exponent = -300.0; exponent <= 0.5; exponent += 0.001) {
    if (exponent < -12.0) exponent += 0.5;
    const double magnitude = std::pow(10.0, exponent);
    for (double x : {magnitude, -magnitude}) {
      const double value = static_cast<double>(series(x, false));
      const double derivative = static_cast<double>(series(x, true));
      ASSERT_NEAR(sinc(x), value, 4e-16) << x;
      // The direct formula loses about eps/x^2, at most 4 eps/0.5 of a derivative of x/3.
      ASSERT_NEAR(sinc_derivative(x), derivative, 3e-15 * std::abs(x)) << x;
    }
  }
}

TEST(Sinc, IsExactAtZeroAndFiniteForDenormals) {
  EXPECT_EQ(sinc(0.0), 1.0);
  EXPECT_EQ(sinc(-0.0), 1.0);
  EXPECT_EQ(sinc_derivative(0.0), 0.0);
  const double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(sinc(tiny), 1.0);
  EXPECT_LE(std::abs(sinc_derivative(tiny)), tiny);
}

TEST(Sinc, HasNoStepWhereSeriesAndFormulaMeet) {
  const double below = std::nextafter(kSincSeriesRadius, 0.0);
  EXPECT_NEAR(sinc(below), sinc(kSincSeriesRadius), 4e-16);
  EXPECT_NEAR(sinc_derivative(below), sinc_derivative(kSincSeriesRadius), 2e-15);
}

}  // namespace
}  // namespace prospect::sinc_test
