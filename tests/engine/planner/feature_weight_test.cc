// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/feature_weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace prospect::feature_weight_test {
namespace {

double cost(const WeighedCandidate& c, double w) { return c.others + w * c.features; }

// Freiburg79: standing costs 0 and sees enough; driving gains 1.1, through a blank view.
TEST(FeatureWeight, ARobotThatHasAWayOnDoesNotStandBeforeABlankView) {
  const std::vector<WeighedCandidate> c{{0.0, 0.1}, {-1.1, 1.0}};
  const double w = feature_weight(c, 0.0, 2.0);
  EXPECT_LT(w, 2.0);
  EXPECT_GT(w, 0.5) << "bounded, not switched off";
  EXPECT_LT(cost(c[1], w), cost(c[0], w));
  EXPECT_NEAR(cost(c[1], w), cost(c[0], w) - 0.11, 1e-12) << "ahead by a tenth of the gain";
}

TEST(FeatureWeight, StaysWhereAWayIsGoodEnough) {
  // A way round gains less, but sees enough: the features choose it, with their full weight.
  const std::vector<WeighedCandidate> c{{0.0, 0.1}, {-1.1, 1.0}, {-0.7, 0.1}};
  EXPECT_EQ(feature_weight(c, 0.0, 2.0), 2.0);
  EXPECT_LT(cost(c[2], 2.0), std::min(cost(c[0], 2.0), cost(c[1], 2.0)));
}

TEST(FeatureWeight, IsTheGivenOneWhereNothingCanBeGained) {
  EXPECT_EQ(feature_weight({}, 0.0, 2.0), 2.0);
  EXPECT_EQ(feature_weight({{0.0, 0.3}, {0.5, 0.0}}, 0.0, 2.0), 2.0);
  EXPECT_EQ(feature_weight({{0.0, 0.3}, {-1.0, 0.9}}, 0.0, 0.0), 0.0);
}

TEST(FeatureWeight, IsTheLargestWithWhichGoingOnIsBetter) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> others(-1.5, 0.5), features(0.0, 1.0);
  int bounded = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<WeighedCandidate> c{{0.0, features(random)}};
    for (int k = 0; k < 12; ++k) c.push_back({others(random), features(random)});
    const double most = 4.0, w = feature_weight(c, 0.0, most);
    double least = 0.0;
    for (const auto& x : c) least = std::min(least, x.others);
    const double gain = -least;
    const auto ahead = [&](double weight) {
      double goes = 1e9, waits = 1e9;
      for (const auto& x : c) {
        double& best = -x.others >= 0.5 * gain ? goes : waits;
        best = std::min(best, cost(x, weight));
      }
      return waits - goes - 0.1 * gain;
    };
    EXPECT_GE(ahead(w), -1e-9);
    if (w == most) continue;
    ++bounded;
    EXPECT_LT(ahead(w + 1e-6), 0.0);
  }
  EXPECT_GT(bounded, 20);
}

TEST(FeatureWeight, OfScoredCandidatesCountsTheFeasibleOnesAgainstStopping) {
  const double most = 2.0;
  const auto scored = [&](bool stops, double others, double features, double violation) {
    Candidate c{"seed", {}, others + most * features, violation};
    c.features = features;
    c.stops = stops;
    return c;
  };
  const std::vector<Candidate> all{scored(true, 0.0, 0.1, 0.0), scored(false, -1.1, 1.0, 0.0),
                                   scored(false, -9.0, 0.0, 0.2)};
  EXPECT_NEAR(feature_weight(all, most), feature_weight({{0.0, 0.1}, {-1.1, 1.0}}, 0.0, most),
              1e-12);
  EXPECT_EQ(feature_weight({all[1], all[2]}, most), most) << "nothing to compare with";
}

}  // namespace
}  // namespace prospect::feature_weight_test
