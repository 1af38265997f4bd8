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
  drift.update_calibration(kDisparityError, 0.04, 0.0);
  const Matrix6d C = drift.measure(
      measured({{6, Isometry3d::Identity(), Matrix6d::Identity()}}, b, Matrix6d::Zero()));
  EXPECT_NEAR(C(2, 2), 0.04 * 25.0, 1e-12);
}

TEST(PoseDrift, AgreesWithSimulatedErrors) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  // A tangle of poses, each measured against several earlier ones, drawn many times by the model.
  struct Step {
    std::vector<PoseDrift::Reference> references;
    std::vector<PoseDrift::Sight> sights;
    Vector6d b;
    Matrix6d noise;
  };
  std::mt19937 generator(6);
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
      PoseDrift::Sight sight{l, {}, {0.04, 0.02, 0.01}};
      for (double& x : sight.gain.reshaped()) x = normal(generator);
      s.sights.push_back(sight);
    }
    s.noise = 0.01 * some_information(generator).inverse();
    steps.push_back(s);
  }
  PoseDrift drift(disparity_error(0.02));
  drift.begin(1, Matrix6d::Zero());
  Matrix6d C, motion;
  const Isometry3d T_last = some_motion(generator);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    PoseDrift::Measurement m = measured(steps[i].references, steps[i].b, steps[i].noise);
    m.sights = steps[i].sights;
    C = drift.measure(m);
    if (i + 1 == steps.size()) motion = drift.since(steps.size() - 1, T_last);
    drift.add(i + 2);
  }
  Matrix6d sample = Matrix6d::Zero(), sample_motion = sample;
  constexpr int kDraws = 40000;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double e_d = std::sqrt(0.02) * normal(generator);
    std::map<std::uint64_t, Vector6d> e = {{1, Vector6d::Zero()}};
    std::map<std::uint64_t, Eigen::Vector3d> m;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      Matrix6d H = Matrix6d::Zero();
      Vector6d g = -steps[i].b * e_d;
      for (const auto& r : steps[i].references) {
        H += r.information;
        g += r.information * adjoint(r.T_CA) * e[r.anchor];
      }
      for (const PoseDrift::Sight& sight : steps[i].sights) {
        const auto [at, is_new] = m.try_emplace(sight.landmark, Eigen::Vector3d::Zero());
        for (int k = 0; is_new && k < 3; ++k) {
          at->second[k] = std::sqrt(sight.variance[k]) * normal(generator);
        }
        g += sight.gain * at->second;
      }
      Vector6d z;
      for (double& x : z) x = normal(generator);
      e[i + 2] = H.ldlt().solve(g) + Matrix6d(steps[i].noise.llt().matrixL()) * z;
    }
    const Vector6d& last = e[steps.size() + 1];
    const Vector6d moved = last - adjoint(T_last) * e[steps.size() - 1];
    sample += last * last.transpose() / kDraws;
    sample_motion += moved * moved.transpose() / kDraws;
  }
  EXPECT_LT((sample - C).norm(), 0.03 * C.norm());
  EXPECT_LT((sample_motion - motion).norm(), 0.03 * motion.norm());
}

TEST(PoseDrift, WhatAnAnchorMeasuredWrongIsTheSameInEveryFrame) {
  // Two poses that see one landmark alike: both are wrong by it, and the motion between is not. A
  // pose that sees another landmark is wrong by that.
  PoseDrift::Sight sight{5, PoseDrift::Sight().gain, {0.04, 0.04, 0.04}};
  sight.gain.topRows<3>().setIdentity();
  PoseDrift::Measurement m = measured({{1, Isometry3d::Identity(), Matrix6d::Identity()}},
                                      Vector6d::Zero(), Matrix6d::Zero());
  m.sights = {sight};
  PoseDrift drift;
  drift.begin(1, Matrix6d::Zero());
  EXPECT_NEAR(drift.measure(m)(0, 0), 0.04, 1e-12);
  drift.add(2);
  EXPECT_NEAR(drift.measure(m)(0, 0), 0.04, 1e-12);
  EXPECT_LT(drift.since(2, Isometry3d::Identity()).norm(), 1e-12);
  m.sights[0].landmark = 4;
  drift.measure(m);
  EXPECT_NEAR(drift.since(2, Isometry3d::Identity())(0, 0), 0.08, 1e-12);
  // A landmark that was forgotten is a new one.
  drift.keep({1, 2}, {});
  m.sights[0].landmark = 5;
  drift.measure(m);
  EXPECT_NEAR(drift.since(2, Isometry3d::Identity())(0, 0), 0.08, 1e-12);
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
