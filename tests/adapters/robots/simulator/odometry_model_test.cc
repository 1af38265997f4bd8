// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/odometry_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "engine/support/eigenvalues.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::odometry_model_test {
namespace {

const StereoCamera kStereo;
const CameraMount kMount;

/// Keyframes err, the calibration does not.
OdometryOptions calibrated() {
  OdometryOptions options;
  options.scale_error = options.direction_error = options.turn_error = 0.0;
  return options;
}

double position_sigma(const Eigen::Matrix3d& Q) { return std::sqrt(Q(0, 0) + Q(1, 1)); }

std::vector<Eigen::Vector3d> repeated(const std::vector<Eigen::Vector3d>& points, int times) {
  std::vector<Eigen::Vector3d> all;
  for (int n = 0; n < times; ++n) all.insert(all.end(), points.begin(), points.end());
  return all;
}

TEST(OdometryModel, CalibratedAtTwoHundredSpreadPoints) {
  const OdometryModel model({}, kStereo, kMount, {}, 1);
  const Eigen::Matrix3d Q = model.keyframe_covariance(OdometryModel::reference_points(kStereo));
  EXPECT_NEAR(position_sigma(Q), OdometryOptions().position_sigma, 1e-12);
  EXPECT_NEAR(std::sqrt(Q(2, 2)), OdometryOptions().heading_sigma, 1e-12);
}

TEST(OdometryModel, CovarianceFallsAsOneOverTheNumberOfPoints) {
  const OdometryModel model({}, kStereo, kMount, {}, 1);
  const auto points = OdometryModel::reference_points(kStereo, 50);
  const Eigen::Matrix3d Q = model.keyframe_covariance(points);
  for (const int times : {2, 4, 10}) {
    const Eigen::Matrix3d many = model.keyframe_covariance(repeated(points, times));
    EXPECT_LT((many * times - Q).norm(), 1e-9 * Q.norm());
  }
  // Prefixes of the low-discrepancy set are alike, though not the same.
  EXPECT_NEAR(position_sigma(Q) / position_sigma(model.keyframe_covariance(
                                      OdometryModel::reference_points(kStereo, 200))),
              2.0, 0.15);
}

TEST(OdometryModel, FarOrClusteredPointsAreWorseAtEqualCount) {
  const OdometryModel model({}, kStereo, kMount, {}, 1);
  const auto near = OdometryModel::reference_points(kStereo, 200);
  auto far = near, clustered = near;
  for (auto& p : far) p *= 3.0;  // 3 to 15 m
  for (auto& p : clustered) {
    p.x() *= 0.15;
    p.y() *= 0.15;
  }
  const double base = position_sigma(model.keyframe_covariance(near));
  EXPECT_GT(position_sigma(model.keyframe_covariance(far)), 2.0 * base);
  EXPECT_GT(position_sigma(model.keyframe_covariance(clustered)), 1.2 * base);
}

TEST(OdometryModel, DegenerateSetsStayBounded) {
  const OdometryModel model({}, kStereo, kMount, {}, 1);
  const Eigen::Vector3d p(0.1, 0.0, 2.0);
  for (const auto& points :
       {std::vector<Eigen::Vector3d>{}, std::vector<Eigen::Vector3d>{p},
        std::vector<Eigen::Vector3d>(12, p),
        std::vector<Eigen::Vector3d>{Eigen::Vector3d::Zero(), {0.0, 0.0, -1.0}},
        std::vector<Eigen::Vector3d>(30, Eigen::Vector3d(0.0, 0.0, 1e7)),
        std::vector<Eigen::Vector3d>{{std::nan(""), 0.0, 1.0}}}) {
    const Eigen::Matrix3d Q = model.keyframe_covariance(points);
    ASSERT_TRUE(Q.allFinite());
    const Eigen::Vector3d e = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Q).eigenvalues();
    EXPECT_GT(e[0], 0.0);
    EXPECT_LE(std::sqrt(e[2]), 0.05 * (1.0 + 1e-9));
  }
}

// Drift of one keyframe over many seeds.
double sampled_drift(int count, double* heading) {
  const auto points = OdometryModel::reference_points(kStereo, count);
  double sum = 0.0, sum_heading = 0.0;
  constexpr int kSeeds = 3000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    OdometryModel model(calibrated(), kStereo, kMount, {},
                        static_cast<std::uint64_t>(seed) * 7919 + 1);
    Pose pose;
    pose.position.x() = 0.2;
    EXPECT_TRUE(model.image(pose, points));
    const Pose estimate = model.estimate(pose);
    sum += (estimate.position - pose.position).squaredNorm();
    sum_heading += std::pow(estimate.yaw - pose.yaw, 2);
  }
  *heading = std::sqrt(sum_heading / kSeeds);
  return std::sqrt(sum / kSeeds);
}

TEST(OdometryModel, SampledDriftFollowsOneOverTheRootOfTheCount) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  double h200 = 0.0, h50 = 0.0;
  const double d200 = sampled_drift(200, &h200);
  const double d50 = sampled_drift(50, &h50);
  const double position = calibrated().position_sigma, heading = calibrated().heading_sigma;
  EXPECT_NEAR(d200 / position, 1.0, 0.05);  // three deviations of the estimate over 3000 seeds
  EXPECT_NEAR(h200 / heading, 1.0, 0.05);
  EXPECT_NEAR(d50 / d200, 2.0, 0.2);
  EXPECT_NEAR(h50 / h200, 2.0, 0.25);
}

// Keyframes do not err here: what is left is the mission's own, and grows with the way.
TEST(OdometryModel, AWrongCalibrationStretchesBendsAndTurnsAllMotionsAlike) {
  OdometryOptions options;
  options.position_sigma = options.heading_sigma = 0.0;
  const auto points = OdometryModel::reference_points(kStereo);
  const auto off = [&](std::uint64_t seed, int keyframes, double turn) {
    OdometryModel model(options, kStereo, kMount, {}, seed);
    Pose pose;
    for (int n = 0; n < keyframes; ++n) {
      pose.position.x() += 0.2;
      pose.yaw += turn;
      model.image(pose, points);
    }
    const Pose estimate = model.estimate(pose);
    return Eigen::Vector3d(estimate.position.x() - pose.position.x(),
                           estimate.position.y() - pose.position.y(), estimate.yaw - pose.yaw);
  };
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kSeeds = 500;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    const Eigen::Vector3d near = off(s, 10, 0.0), far = off(s, 40, 0.0);
    EXPECT_LT((far - 4.0 * near).norm(), 1e-7);
    squares += (far / 8.0).cwiseAbs2() / kSeeds;
    squares[2] += std::pow(off(s, 10, 0.1)[2], 2) / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(squares[0]) / options.scale_error, 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(squares[1]) / options.direction_error, 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(squares[2]) / options.turn_error, 1.0, 0.1);
}

TEST(OdometryModel, NoDriftAtRestAndBetweenKeyframes) {
  OdometryModel model({}, kStereo, kMount, {}, 1);
  const auto points = OdometryModel::reference_points(kStereo);
  Pose pose;
  for (int n = 0; n < 20; ++n) EXPECT_FALSE(model.image(pose, points));
  pose.position.x() = 0.1;
  pose.yaw = 0.1;
  EXPECT_FALSE(model.image(pose, points));
  EXPECT_EQ(model.estimate(pose).position, pose.position);
  EXPECT_EQ(model.estimate(pose).yaw, pose.yaw);
  EXPECT_EQ(model.covariance(pose).norm(), 0.0);
  pose.yaw = 0.16;  // a turn alone is a keyframe as well
  EXPECT_TRUE(model.image(pose, points));
  EXPECT_NE(model.estimate(pose).yaw, pose.yaw);
  EXPECT_GT(model.covariance(pose).norm(), 0.0);
  // From there on the yaw's error moves the robot sideways, on the way to the next keyframe as
  // well.
  const Eigen::Matrix4d before = model.covariance(pose);
  pose.position.x() += 0.1;
  EXPECT_FALSE(model.image(pose, points));
  EXPECT_NEAR(model.covariance(pose)(1, 1),
              before(1, 1) + 2 * 0.1 * before(1, 3) + 0.01 * before(3, 3), 1e-3 * before(1, 1));
}

TEST(OdometryModel, StateFollowsTheCount) {
  OdometryModel model({}, kStereo, kMount, {}, 1);
  Pose pose;
  const auto look = [&](int count) {
    pose.position.x() += 0.2;
    model.image(pose, OdometryModel::reference_points(kStereo, count));
    return model.localization();
  };
  EXPECT_EQ(look(40), Localization::kOk);
  EXPECT_EQ(look(39), Localization::kDegraded);
  EXPECT_EQ(look(12), Localization::kDegraded);
  EXPECT_EQ(model.losses(), 0);
  EXPECT_EQ(look(11), Localization::kLost);
  EXPECT_EQ(look(0), Localization::kLost);
  EXPECT_EQ(model.losses(), 1);
  EXPECT_EQ(look(200), Localization::kOk);
  EXPECT_EQ(look(3), Localization::kLost);
  EXPECT_EQ(model.losses(), 2);
}

// Along a curved path, with a lost stretch: the reported covariance is that of the sampled errors.
TEST(OdometryModel, CovarianceIsThatOfTheErrors) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  constexpr int kSeeds = 3000;
  const auto points = OdometryModel::reference_points(kStereo, 40);
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d mean_reported = Eigen::Matrix3d::Zero();
  for (int seed = 0; seed < kSeeds; ++seed) {
    OdometryModel model({}, kStereo, kMount, {}, static_cast<std::uint64_t>(seed) + 17);
    Pose pose;
    for (int n = 0; n < 40; ++n) {
      pose.yaw += 0.05;
      pose.position += 0.16 * Eigen::Vector3d(std::cos(pose.yaw), std::sin(pose.yaw), 0.0);
      const bool blank = n >= 15 && n < 22;
      model.image(pose, blank ? std::vector<Eigen::Vector3d>(4, points[0]) : points);
    }
    const Pose estimate = model.estimate(pose);
    const Eigen::Vector3d e(estimate.position.x() - pose.position.x(),
                            estimate.position.y() - pose.position.y(), estimate.yaw - pose.yaw);
    sampled += e * e.transpose() / kSeeds;
    const Eigen::Matrix4d P = model.covariance(pose);
    EXPECT_EQ(P.row(2).norm(), 0.0);
    Eigen::Matrix3d planar;
    planar << P(0, 0), P(0, 1), P(0, 3), P(1, 0), P(1, 1), P(1, 3), P(3, 0), P(3, 1), P(3, 3);
    mean_reported += planar / kSeeds;
  }
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(sampled(a, a) / mean_reported(a, a), 1.0, 0.1) << a;
    for (int b = 0; b < a; ++b) {
      const double scale = std::sqrt(mean_reported(a, a) * mean_reported(b, b));
      EXPECT_NEAR(sampled(a, b) / scale, mean_reported(a, b) / scale, 0.08);
    }
  }
}

TEST(OdometryModel, LossDriftsMoreThanFewFeatures) {
  const auto few = OdometryModel::reference_points(kStereo, 12);
  for (const bool turning : {false, true}) {
    double tracked = 0.0, reckoned = 0.0;
    for (int seed = 0; seed < 400; ++seed) {
      for (const bool lost : {false, true}) {
        OdometryModel model(calibrated(), kStereo, kMount, {}, static_cast<std::uint64_t>(seed));
        Pose pose;
        for (int n = 0; n < 20; ++n) {
          (turning ? pose.yaw : pose.position.x()) += 0.15;
          model.image(pose, lost ? std::vector<Eigen::Vector3d>{} : few);
        }
        const Pose estimate = model.estimate(pose);
        const double yaw = estimate.yaw - pose.yaw;
        // At a metre's lever, so that turning in place counts.
        (lost ? reckoned : tracked) +=
            (estimate.position - pose.position).squaredNorm() + yaw * yaw;
      }
    }
    EXPECT_GT(reckoned, 1.1 * tracked) << (turning ? "turning" : "driving");
  }
}

TEST(OdometryModel, FindingThePoseForgetsAllLossesSinceItWasKnown) {
  const StereoCamera stereo;
  for (const bool given_up : {false, true}) {
    OdometryModel model({}, stereo, {}, {}, 3);
    const auto many = OdometryModel::reference_points(stereo, 100);
    const auto few = OdometryModel::reference_points(stereo, 5);
    Pose pose;
    const auto drive = [&](const std::vector<Eigen::Vector3d>& points, int keyframes) {
      for (int n = 0; n < keyframes; ++n) {
        pose.position.x() += 0.15;
        model.image(pose, points);
      }
    };
    drive(many, 10);
    const Eigen::Matrix4d known = model.covariance(pose);
    const Eigen::Vector3d place_known = model.estimate(pose).position;
    drive(few, 10);
    drive(many, 1);  // sees enough for once, but nothing it knows
    const Eigen::Matrix4d between = model.covariance(pose);
    const Eigen::Vector3d place_between = model.estimate(pose).position;
    EXPECT_GT(between(0, 0), 1.5 * known(0, 0));
    if (given_up) model.accept_drift();
    drive(few, 10);
    drive(many, 1);
    EXPECT_EQ(model.losses(), 2);
    EXPECT_GT(model.covariance(pose)(0, 0), between(0, 0));
    Pose found = pose;
    found.position.y() = 0.01;
    found.yaw = -0.02;
    const Eigen::Matrix3d of_match = Eigen::Vector3d(4e-4, 1e-4, 1e-5).asDiagonal();
    model.relocalize(pose, found, of_match);
    // What a pose here owes to the one that was known, by the way between them as estimated, and
    // where there was something to find again what finding it was worth.
    const Eigen::Matrix4d& at = given_up ? between : known;
    Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
    const Eigen::Vector3d way = found.position - (given_up ? place_between : place_known);
    F(0, 3) = -way.y();
    F(1, 3) = way.x();
    const Eigen::Vector3i planar(0, 1, 3);
    Eigen::Matrix4d expected = F * at * F.transpose();
    expected(planar, planar) += of_match;
    EXPECT_NEAR((model.covariance(pose) - expected).norm(), 0.0, 1e-15);
    EXPECT_EQ(model.estimate(pose).position, found.position);
    EXPECT_EQ(model.estimate(pose).yaw, found.yaw);
    // Without a loss since, a second time changes the pose alone.
    drive(many, 10);
    const Eigen::Matrix4d later = model.covariance(pose);
    model.relocalize(pose, found, of_match);
    EXPECT_EQ(model.covariance(pose), later);
  }
}

TEST(OdometryModel, PerfectModeIsTheTruth) {
  OdometryOptions options;
  options.perfect = true;
  OdometryModel model(options, kStereo, kMount, {}, 1);
  Pose pose;
  for (int n = 0; n < 10; ++n) {
    pose.position.x() += 0.3;
    pose.yaw += 0.4;
    model.image(pose, {});
    EXPECT_EQ(model.estimate(pose).position, pose.position);
    EXPECT_EQ(model.estimate(pose).yaw, pose.yaw);
  }
  EXPECT_EQ(model.localization(), Localization::kOk);
  EXPECT_EQ(model.covariance(pose).norm(), 0.0);
  EXPECT_EQ(model.losses(), 0);
}

TEST(OdometryModel, RejectsOptionsOutOfRange) {
  OdometryOptions options;
  options.keyframe_distance = 0.0;
  EXPECT_THROW(OdometryModel(options, kStereo, kMount, {}, 1), std::invalid_argument);
  options = {};
  options.degraded_below = 5;
  EXPECT_THROW(OdometryModel(options, kStereo, kMount, {}, 1), std::invalid_argument);
  options = {};
  options.position_sigma = std::nan("");
  EXPECT_THROW(OdometryModel(options, kStereo, kMount, {}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::odometry_model_test
