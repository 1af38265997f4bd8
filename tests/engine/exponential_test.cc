#include "engine/exponential.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace prospect {
namespace {

TEST(Exponential, AgreesWithTheLibraryWithinTwoUnits) {
  std::mt19937_64 random(1);
  double worst = 0.0;
  for (const double range : {1e-9, 1e-3, 1.0, 30.0, 100.0, 700.0}) {
    std::uniform_real_distribution<double> x(-range, range);
    for (int n = 0; n < 100000; ++n) {
      const double a = x(random), e = std::exp(a);
      worst = std::max(worst, std::abs(exponential(a) - e) / e);
    }
  }
  EXPECT_LT(worst, 4.5e-16);
  EXPECT_EQ(exponential(0.0), 1.0);
}

TEST(Exponential, IsMonotoneAcrossTheSeamsOfItsReduction) {
  for (int n = -20; n < 20; ++n) {
    const double seam = (n + 0.5) * std::log(2.0);
    const double step = 1e-9;
    EXPECT_LT(exponential(seam - step), exponential(seam + step)) << n;
  }
}

}  // namespace
}  // namespace prospect
