// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/loop_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prospect::loop_evidence_test {
namespace {

using Matrix6d = LoopTest::Matrix6d;
using Vector6d = LoopTest::Vector6d;

Matrix6d diagonal(double planar, double outside) {
  Vector6d d;
  d << planar, planar, outside, outside, outside, planar;
  return d.asDiagonal();
}

TEST(LoopEvidence, FitsOfSurePredictionsSayMuchAndMisfitsSpeakAgainst) {
  const Matrix6d W = diagonal(100.0, 0.0);
  const auto score = [&](double r, double variance) {
    return LoopTest(r * Vector6d::Unit(0), diagonal(variance, 1.0), W).evidence(1.0, 3.0).score;
  };
  EXPECT_NEAR(score(0.0, 0.01), 1.5 * std::log(1e4), 0.01);
  EXPECT_GT(score(0.0, 0.01), score(0.0, 1.0));
  EXPECT_GT(score(0.2, 0.01), 4.0);         // two deviations off
  EXPECT_LT(score(10.0, 0.01), 0.0);        // a hundred
  EXPECT_NEAR(score(0.0, 1e6), 0.0, 0.01);  // nothing is known: nothing is said
}

TEST(LoopEvidence, DirectionsInWhichNothingDiffersCountForNothing) {
  const Matrix6d W = diagonal(100.0, 0.0);
  const Vector6d r = 0.1 * Vector6d::Ones();
  Vector6d tilted = r;
  tilted[3] += 5.0;
  const LoopEvidence flat = LoopTest(r, diagonal(0.01, 0.01), W).evidence(1.0, 3.0);
  const LoopEvidence other = LoopTest(tilted, diagonal(0.01, 7.0), W).evidence(1.0, 3.0);
  EXPECT_NEAR(flat.score, other.score, 1e-9);
}

TEST(LoopEvidence, ChanceIsTheShareOfWrongLoopsThatFit) {
  // Wrong loops drawn as the model says; those within the ellipsoid of one that is two off.
  const Matrix6d P = diagonal(1.0, 1.0), W = diagonal(25.0, 0.0);
  const LoopEvidence one = LoopTest(2.0 * Vector6d::Unit(1), P, W).evidence(1.0, 3.0);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  int fit = 0;
  constexpr int kDrawn = 20000;
  for (int i = 0; i < kDrawn; ++i) {
    Vector6d r = Vector6d::Zero();
    for (const int k : {0, 1, 5}) r[k] = std::sqrt(26.0) * normal(generator);
    fit += LoopTest(r, P, W).evidence(1.0, 3.0).chi2 <= one.chi2;
  }
  EXPECT_NEAR(std::exp(one.chance), static_cast<double>(fit) / kDrawn, 0.25 * std::exp(one.chance));
}

TEST(LoopEvidence, AScaleIsOneOfAllDeviations) {
  const Matrix6d P = diagonal(0.01, 0.01), W = diagonal(100.0, 0.0);
  const Vector6d r = 0.1 * Vector6d::Ones();
  EXPECT_NEAR(LoopTest(r, P, W).evidence(0.25, 3.0).score,
              LoopTest(r, P / 16.0, W).evidence(1.0, 3.0).score, 1e-9);
}

TEST(LoopEvidence, TheShareOfRightLoopsIsLearned) {
  const std::vector<double> scores = {9.0, 8.0, 7.0, -5.0, -9.0, -20.0, -30.0, -40.0, -50.0};
  EXPECT_NEAR(share_of_right(scores, 0), 4.0 / 11.0, 0.01);
  EXPECT_NEAR(share_of_right(scores, 9), 13.0 / 20.0, 0.01);
  EXPECT_NEAR(share_of_right({0.0, 0.0}, 0), 0.5, 0.01);
}

}  // namespace
}  // namespace prospect::loop_evidence_test
