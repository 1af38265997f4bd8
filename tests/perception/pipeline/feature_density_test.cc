// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/feature_density.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace prospect::feature_density_test {
namespace {

TEST(FeatureDensity, IsTheQuantileOfWhatNewSurfaceBore) {
  FeatureDensity density({.quantile = 0.25, .area = 1.0, .window = 5, .initial = 7.0});
  EXPECT_EQ(density.value(), 7.0);
  double surface = 0.0;
  for (const int landmarks : {40, 10, 30}) density.add(landmarks, surface += 1.0);
  EXPECT_EQ(density.value(), 7.0) << "three samples are not enough";
  density.add(20, surface += 1.0);
  EXPECT_EQ(density.value(), 10.0);  // rank floor(0.25 x 3) = 0 of 10, 20, 30, 40
  // Too little surface makes no sample; what was found there counts for the next.
  density.add(6, surface += 0.5);
  EXPECT_EQ(density.value(), 10.0);
  density.add(6, surface += 1.0);    // 12 / 1.5 = 8
  EXPECT_EQ(density.value(), 10.0);  // rank 1 of 8, 10, 20, 30, 40
  density.add(0, surface += 1.0);    // 40 is forgotten: rank 1 of 0, 8, 10, 20, 30
  EXPECT_EQ(density.value(), 8.0);
}

TEST(FeatureDensity, RefusesOptionsOutOfRange) {
  EXPECT_THROW(FeatureDensity({.quantile = -0.1}), std::invalid_argument);
  EXPECT_THROW(FeatureDensity({.area = 0.0}), std::invalid_argument);
  EXPECT_THROW(FeatureDensity({.window = 3}), std::invalid_argument);
  EXPECT_THROW(FeatureDensity({.initial = -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::feature_density_test
