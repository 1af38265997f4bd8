// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/residual_noise.h"

#include <gtest/gtest.h>

namespace prospect::residual_noise_test {
namespace {

TEST(ResidualNoise, BeginsAtWhatIsAssumedAndGoesToWhatResidualsSay) {
  ResidualNoise noise;
  EXPECT_EQ(noise.variance(), 1.0);
  noise.add(0.3, 100);
  EXPECT_NEAR(noise.variance(), 0.65, 1e-12);
  for (int frame = 0; frame < 60; ++frame) noise.add(0.3, 300);
  EXPECT_NEAR(noise.variance(), 0.3, 0.02);
}

TEST(ResidualNoise, FewPointsSayLittle) {
  ResidualNoise noise;
  noise.add(0.0, 5);
  EXPECT_GT(noise.variance(), 0.9);
}

TEST(ResidualNoise, AFrameThatIsWorseThanTheOthersCountsAsItIs) {
  ResidualNoise noise;
  for (int frame = 0; frame < 60; ++frame) noise.add(0.3, 300);
  noise.add(3.0, 50);
  EXPECT_EQ(noise.variance(), 3.0);
  noise.add(0.3, 300);
  EXPECT_LT(noise.variance(), 0.5);
}

}  // namespace
}  // namespace prospect::residual_noise_test
