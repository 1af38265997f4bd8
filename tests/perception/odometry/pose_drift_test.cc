// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_drift.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "engine/support/cholesky.h"
#include "perception/odometry/se3.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::pose_drift_test {
namespace {

using Eigen::Isometry3d;
using Matrix6d = PoseDrift::Matrix6d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Matrix6d some_information(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (double& a : A.reshaped()) a = normal(generator);
  return A * A.transpose() + Matrix6d::Identity();
}

Isometry3d some_motion(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (double& x : xi) x = 0.3 * normal(generator);
  return exp_se3(xi);
}

/// Of a pose that owes nothing to landmarks; b: to the disparities' zero.
PoseDrift::Measurement measured(std::vector<PoseDrift::Reference> references, const Vector6d& b,
                                const Matrix6d& noise) {
  PoseDrift::Measurement m;
  m.references = std::move(references);
  m.by_calibration.col(kDisparityError) = b;
  m.noise = noise;
  return m;
}

CalibrationMatrix disparity_error(double variance) {
  CalibrationMatrix c = CalibrationMatrix::Zero();
  c(kDisparityError, kDisparityError) = variance;
  return c;
}

TEST(PoseDrift, AnAnchorThatIsSeenForLongDoesNotAddUp) {
  const Matrix6d noise = 0.01 * Matrix6d::Identity();
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  for (std::uint64_t k = 2; k < 20; ++k) {
    const Matrix6d C = drift.measure(
        measured({{1, Isometry3d::Identity(), Matrix6d::Identity()}}, Vector6d::Zero(), noise));
    EXPECT_LT((C - noise).norm(), 1e-12);
    drift.add(k);
  }
}

TEST(PoseDrift, WhatTwoPosesShareIsNoErrorOfTheMotionBetweenThem) {
  std::mt19937 generator(4);
  const Matrix6d start = some_information(generator).inverse();
  const Matrix6d noise = 0.01 * some_information(generator).inverse();
  PoseDrift drift;
  drift.begin(1, start);
  const Isometry3d T_21 = some_motion(generator), T_32 = some_motion(generator);
  drift.measure(measured({{1, T_21, Matrix6d::Identity()}}, Vector6d::Zero(), noise));
  EXPECT_LT((drift.since(1, T_21) - noise).norm(), 1e-9);
  drift.add(2);
  // From landmarks of the second alone: its own noise is shared, too.
  drift.measure(measured({{2, T_32, Matrix6d::Identity()}}, Vector6d::Zero(), noise));
  EXPECT_LT((drift.since(2, T_32) - noise).norm(), 1e-9);
  // From those of the first alone: both have noise of their own.
  drift.measure(measured({{1, T_32 * T_21, Matrix6d::Identity()}}, Vector6d::Zero(), noise));
  const Matrix6d Ad = adjoint(T_32);
  EXPECT_LT((drift.since(2, T_32) - noise - Ad * noise * Ad.transpose()).norm(), 1e-9);
  EXPECT_LT((drift.since(7, T_32) - drift.measure(measured({{1, T_32 * T_21, Matrix6d::Identity()}},
                                                           Vector6d::Zero(), noise)))
                .norm(),
            1e-12);
}

TEST(PoseDrift, FromAnchorToAnchorItDoes) {
  const Matrix6d noise = 0.01 * Matrix6d::Identity();
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  Matrix6d C;
  for (std::uint64_t k = 2; k <= 11; ++k) {
    C = drift.measure(
        measured({{k - 1, Isometry3d::Identity(), Matrix6d::Identity()}}, Vector6d::Zero(), noise));
    drift.add(k);
    drift.keep({k}, {});
    EXPECT_EQ(drift.anchors(), 1u);
  }
  EXPECT_LT((C - 10.0 * noise).norm(), 1e-12);
}

TEST(PoseDrift, AnErrorOfAllDisparitiesGrowsWithTheNumberOfSteps) {
  // Each step is measured too long by the same unknown share: its variance grows as the square.
  PoseDrift drift(disparity_error(0.04));
  drift.begin(1, Matrix6d::Zero());
  Vector6d b = Vector6d::Zero();
  b[2] = 1.0;
  for (std::uint64_t k = 2; k <= 6; ++k) {
    const Matrix6d C = drift.measure(
        measured({{k - 1, Isometry3d::Identity(), Matrix6d::Identity()}}, b, Matrix6d::Zero()));
    drift.add(k);
    const double steps = static_cast<double>(k - 1);
    EXPECT_NEAR(C(2, 2), 0.04 * steps * steps, 1e-12);
  }
  // Once it is known, further steps add nothing.
  PoseDrift::Evidence known;
  known.value = 0.1;
  known.by_calibration[kDisparityError] = 1.0;
  EXPECT_NEAR(drift.estimate(known, 0.0, 0.04), 0.1, 1e-12);
  EXPECT_NEAR(drift.calibration_variance(kDisparityError), 0.0, 1e-12);
  const Matrix6d C = drift.measure(
      measured({{6, Isometry3d::Identity(), Matrix6d::Identity()}}, b, Matrix6d::Zero()));
  EXPECT_NEAR(C(2, 2), 0.04 * 25.0, 1e-12);
}

struct Step {
  std::vector<PoseDrift::Reference> references;
  std::vector<PoseDrift::Share> shares;
  Vector6d b;
  Matrix6d noise;
  PoseDrift::Evidence evidence;  // after it
};

/// A tangle of poses 2 to 8, each measured against several earlier ones.
std::vector<Step> tangle(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  std::vector<Step> steps;
  for (std::uint64_t k = 2; k < 9; ++k) {
    Step s;
    for (std::uint64_t a = k > 4 ? k - 3 : 1; a < k; ++a) {
      s.references.push_back({a, some_motion(generator), some_information(generator)});
    }
    for (double& x : s.b) x = normal(generator);
    // Each landmark is seen by three poses, always otherwise.
    for (std::uint64_t l = k; l < k + 3; ++l) {
      PoseDrift::Share share{l, PoseDrift::Share().gain};
      for (double& x : share.gain.reshaped()) x = 0.15 * normal(generator);
      s.shares.push_back(share);
    }
    s.noise = 0.01 * some_information(generator).inverse();
    s.evidence.by_calibration[kDisparityError] = 1.0;
    for (const auto& r : s.references) {
      s.evidence.anchors.emplace_back(r.anchor, Eigen::Matrix<double, 1, 6>::Zero());
      for (double& x : s.evidence.anchors.back().second) x = 0.3 * normal(generator);
    }
    for (const auto& share : s.shares) {
      s.evidence.errors.emplace_back(share.error, Eigen::RowVector3d::Zero());
      for (double& x : s.evidence.errors.back().second) x = 0.05 * normal(generator);
    }
    s.evidence.noise = 0.01;
    steps.push_back(s);
  }
  return steps;
}

/// Holds the covariances of the tangle's last pose, of the motion to it and of the disparities'
/// zero against errors that are drawn by the model; where `estimated` the zero is corrected by what
/// each pose says about it.
void agrees_with_drawn_errors(bool estimated) {
  std::mt19937 generator(6);
  std::normal_distribution<double> normal;
  const std::vector<Step> steps = tangle(generator);
  constexpr double kVariance = 0.02;
  const Isometry3d T_last = some_motion(generator);
  PoseDrift drift(disparity_error(kVariance));
  drift.begin(1, Matrix6d::Zero());
  Matrix6d C, motion;
  std::vector<double> factors;  // K
  for (std::size_t i = 0; i < steps.size(); ++i) {
    PoseDrift::Measurement m = measured(steps[i].references, steps[i].b, steps[i].noise);
    m.shares = steps[i].shares;
    C = drift.measure(m);
    if (i + 1 == steps.size()) motion = drift.since(steps.size() - 1, T_last);
    PoseDrift::Evidence evidence = steps[i].evidence;
    evidence.value = 1.0;
    if (estimated && i + 1 < steps.size()) factors.push_back(drift.estimate(evidence, 0.0, 1.0));
    drift.add(i + 2);
  }
  Matrix6d sample = Matrix6d::Zero(), sample_motion = sample;
  double sample_zero = 0.0;
  constexpr int kDraws = 40000;
  for (int draw = 0; draw < kDraws; ++draw) {
    double e_d = std::sqrt(kVariance) * normal(generator);
    std::map<std::uint64_t, Vector6d> e = {{1, Vector6d::Zero()}};
    std::map<std::uint64_t, Eigen::Vector3d> x;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      Matrix6d H = Matrix6d::Zero();
      Vector6d g = -steps[i].b * e_d;
      for (const auto& r : steps[i].references) {
        H += r.information;
        g += r.information * adjoint(r.T_CA) * e[r.anchor];
      }
      for (const PoseDrift::Share& share : steps[i].shares) {
        const auto [at, is_new] = x.try_emplace(share.error, Eigen::Vector3d::Zero());
        for (int k = 0; is_new && k < 3; ++k) at->second[k] = normal(generator);
        g += share.gain * at->second;
      }
      Vector6d z;
      for (double& value : z) value = normal(generator);
      e[i + 2] = H.ldlt().solve(g) + Matrix6d(steps[i].noise.llt().matrixL()) * z;
      if (i >= factors.size()) continue;
      double s = e_d + std::sqrt(steps[i].evidence.noise) * normal(generator);
      for (const auto& [anchor, gain] : steps[i].evidence.anchors) s += gain.dot(e[anchor]);
      for (const auto& [error, gain] : steps[i].evidence.errors) s += gain.dot(x[error]);
      e_d -= factors[i] * s;
    }
    const Vector6d& last = e[steps.size() + 1];
    const Vector6d moved = last - adjoint(T_last) * e[steps.size() - 1];
    sample += last * last.transpose() / kDraws;
    sample_motion += moved * moved.transpose() / kDraws;
    sample_zero += e_d * e_d / kDraws;
  }
  EXPECT_LT((sample - C).norm(), 0.03 * C.norm());
  EXPECT_LT((sample_motion - motion).norm(), 0.03 * motion.norm());
  const double variance = drift.calibration_variance(kDisparityError);
  EXPECT_NEAR(sample_zero, variance, 0.03 * variance);
  EXPECT_LT(variance, estimated ? 0.5 * kVariance : 1.001 * kVariance);
}

TEST(PoseDrift, AgreesWithSimulatedErrors) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  agrees_with_drawn_errors(false);
}

TEST(PoseDrift, AgreesWithSimulatedErrorsWhereTheZeroIsEstimated) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  agrees_with_drawn_errors(true);
}

TEST(PoseDrift, EvidenceThatWasCountedBeforeIsNoNews) {
  // What a landmark says about the zero is wrong by its own error, however often it says it.
  PoseDrift drift(disparity_error(0.04));
  drift.begin(1, Matrix6d::Zero());
  PoseDrift::Evidence evidence;
  evidence.by_calibration[kDisparityError] = 1.0;
  evidence.errors = {{7, Eigen::RowVector3d(0.2, 0.0, 0.0)}};
  for (int k = 0; k < 5; ++k) {
    drift.estimate(evidence, 0.0, 0.04);
    EXPECT_NEAR(drift.calibration_variance(kDisparityError), 0.02, 1e-12);
  }
  // Another one does say something.
  evidence.errors[0].first = 8;
  drift.estimate(evidence, 0.0, 0.04);
  EXPECT_NEAR(drift.calibration_variance(kDisparityError), 0.04 / 3.0, 1e-12);
  // What wanders is known no worse than at first.
  drift.estimate(evidence, 1.0, 0.04);
  EXPECT_LT(drift.calibration_variance(kDisparityError), 0.04);
}

TEST(PoseDrift, WhatLastsIsTheSameInEveryFrame) {
  // Two poses that see one landmark alike: both are wrong by it, and the motion between is not. A
  // pose that sees another landmark is wrong by that.
  PoseDrift::Share share{5, PoseDrift::Share().gain};
  share.gain.topRows<3>().setIdentity();
  share.gain *= 0.2;
  PoseDrift::Measurement m = measured({{1, Isometry3d::Identity(), Matrix6d::Identity()}},
                                      Vector6d::Zero(), Matrix6d::Zero());
  m.shares = {share};
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  EXPECT_NEAR(drift.measure(m)(0, 0), 0.04, 1e-12);
  drift.add(2);
  EXPECT_NEAR(drift.measure(m)(0, 0), 0.04, 1e-12);
  EXPECT_LT(drift.since(2, Isometry3d::Identity()).norm(), 1e-12);
  m.shares[0].error = 4;
  drift.measure(m);
  EXPECT_NEAR(drift.since(2, Isometry3d::Identity())(0, 0), 0.08, 1e-12);
  // One that was forgotten is a new one, also where its place was used again.
  drift.keep({1, 2}, {});
  m.shares[0].error = 5;
  drift.measure(m);
  EXPECT_NEAR(drift.since(2, Isometry3d::Identity())(0, 0), 0.08, 1e-12);
  // So with anchors.
  drift.keep({1}, {5});
  EXPECT_EQ(drift.anchors(), 1u);
  drift.add(3);
  drift.measure(m);
  EXPECT_LT(drift.since(3, Isometry3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(drift.since(2, Isometry3d::Identity())(0, 0), 0.04, 1e-12);
}

TEST(PoseDrift, WhatFadesIsPartlyNew) {
  // Three poses that owe the same to an error that keeps 0.6 from one to the next.
  constexpr double kKept = 0.6, kVariance = 0.04;
  PoseDrift::Share share{5, PoseDrift::Share().gain};
  share.gain.topRows<3>().diagonal().setConstant(std::sqrt(kVariance));
  PoseDrift::Measurement m = measured({{1, Isometry3d::Identity(), Matrix6d::Identity()}},
                                      Vector6d::Zero(), Matrix6d::Zero());
  m.shares = {share};
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  const auto motion_variance = [](double correlation) {
    return 2.0 * kVariance * (1.0 - correlation);
  };
  for (std::uint64_t k = 2; k < 5; ++k) {
    EXPECT_NEAR(drift.measure(m)(0, 0), kVariance, 1e-12);
    for (std::uint64_t before = 2; before < k; ++before) {
      EXPECT_NEAR(drift.since(before, Isometry3d::Identity())(0, 0),
                  motion_variance(std::pow(kKept, static_cast<double>(k - before))), 1e-12);
    }
    drift.add(k);
    drift.fade({4, 5}, kKept);
  }
  // Poses that are measured one from the other add up what they share.
  m.references[0].anchor = 4;
  EXPECT_NEAR(drift.measure(m)(0, 0), 2.0 * kVariance * (1.0 + kKept), 1e-12);
}

TEST(PoseDrift, ANewMapOwesNothingToTheOldOne) {
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  drift.measure(measured({{1, Isometry3d::Identity(), Matrix6d::Identity()}}, Vector6d::Zero(),
                         Matrix6d::Identity()));
  drift.add(2);
  drift.begin(3, 4.0 * Matrix6d::Identity());
  EXPECT_EQ(drift.anchors(), 1u);
  const Matrix6d C = drift.measure(measured({{3, Isometry3d::Identity(), Matrix6d::Identity()}},
                                            Vector6d::Zero(), Matrix6d::Identity()));
  EXPECT_LT((C - 5.0 * Matrix6d::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace prospect::pose_drift_test
