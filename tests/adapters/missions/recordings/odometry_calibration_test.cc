// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/missions/recordings/calibration_report.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/rendered_room.h"

namespace prospect::odometry_calibration_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::RenderedRoom;

StereoCamera camera() {
  StereoCamera c;
  c.left = {275.0, 275.0, 200.0, 150.0, 400.0, 300.0};
  c.baseline = 0.12;
  return c;
}

Isometry3d pose(int k) {
  return RenderedRoom::looking(-1.5 + 0.04 * k, -0.5 + 0.01 * k, 1.05, -0.2 + 0.015 * k);
}

constexpr int kFrames = 26;

const std::vector<RenderedRoom::Pair>& pairs() {
  static const std::vector<RenderedRoom::Pair> pairs = [] {
    std::vector<RenderedRoom::Pair> made;
    for (int k = 0; k < kFrames; ++k)
      made.push_back(RenderedRoom().render(camera(), pose(k), 2.0, k));
    return made;
  }();
  return pairs;
}

/// One pass; `truth` gives the pose that is taken for true, `blank` a frame that shows nothing.
OdometryCalibrationResult calibrate(const std::function<std::optional<Isometry3d>(int)>& truth,
                                    int frames = kFrames, int blank = -1) {
  StereoOdometry odometry(camera(), {}, pose(0));
  OdometryCalibration calibration(camera(), {}, {{5, 10}, 1, 0.9});
  const Image grey(400, 300, 100);
  for (int k = 0; k < frames; ++k) {
    const auto& pair = pairs()[static_cast<std::size_t>(k)];
    const OdometryFrame frame =
        odometry.process(0.1 * k, k == blank ? grey.view() : pair.left.view(),
                         k == blank ? grey.view() : pair.right.view());
    calibration.add(odometry, frame, truth(k));
  }
  return calibration.result();
}

std::optional<Isometry3d> the_truth(int k) { return pose(k); }

TEST(ForecastVisibility, IsThePlannersOwnOnThePlane) {
  // A camera that moves on the plane, as the planner knows it: by pose and mount.
  const VisibilityParameters parameters = odometry_visibility(camera(), {});
  CameraMount mount;
  mount.T_BC = CameraMount::forward_facing({0.0, 0.0, 1.05});
  std::vector<Landmark> landmarks;
  for (int i = 0; i < 60; ++i) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(i);
    l.position = Vector3d(2.0 + 0.02 * i, -3.0 + 0.1 * i, 0.5 + 0.02 * i);
    l.creation_direction = (pose(0).translation() - l.position).normalized();
    l.creation_range = (pose(0).translation() - l.position).norm();
    l.covariance = Vector3d(0.02, 0.01, 0.005).asDiagonal();
    l.survival = 0.7;
    landmarks.push_back(l);
  }
  std::vector<Isometry3d> path;
  for (int k = 0; k < 8; ++k) path.push_back(pose(k));
  const VisibilityForecast forecast = forecast_visibility(landmarks, camera(), path, parameters);
  // Sigma_rel from the frame of the first camera back into W.
  const Eigen::AngleAxisd turn(-0.2, Vector3d::UnitZ());
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  R.topLeftCorner<3, 3>() = turn.toRotationMatrix();
  StereoCamera left = camera();
  left.baseline = 0.0;
  const VisibilityPrediction prediction(landmarks, left, mount, nullptr, parameters);
  const Vector3d end = pose(7).translation() - Vector3d(0.0, 0.0, 1.05);
  const Eigen::VectorXd expected =
      prediction.probabilities({end, -0.2 + 0.015 * 7}, R * forecast.covariance * R.transpose());
  EXPECT_LT((forecast.probability - expected).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT(expected.maxCoeff(), 0.69);
  EXPECT_LT(expected.minCoeff(), 0.01);
  EXPECT_GT(forecast.covariance(0, 0), 0.0);
}

TEST(ForecastVisibility, FollowsAllSixDegreesOfFreedom) {
  Landmark ahead;
  ahead.position = pose(0) * Vector3d(0.0, 0.0, 2.0);
  ahead.creation_direction = (pose(0).translation() - ahead.position).normalized();
  ahead.creation_range = 2.0;
  ahead.survival = 1.0;
  const auto after = [&](double pitch, double roll) {
    Isometry3d end = pose(0);
    end.rotate(Eigen::AngleAxisd(pitch, Vector3d::UnitX()));
    end.rotate(Eigen::AngleAxisd(roll, Vector3d::UnitZ()));
    return forecast_visibility({ahead}, camera(), {pose(0), end}, odometry_visibility(camera(), {}))
        .probability[0];
  };
  EXPECT_GT(after(0.0, 0.0), 0.95);
  EXPECT_LT(after(0.7, 0.0), 0.05);  // half the vertical field of view is 0.5 rad
  EXPECT_GT(after(0.0, 0.7), 0.95);
  EXPECT_THROW(forecast_visibility({ahead}, camera(), {pose(0)}, odometry_visibility(camera(), {})),
               std::invalid_argument);
}

TEST(OdometryCalibration, PredictsWhatIsTrackedInARenderedRoom) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const OdometryCalibrationResult r = calibrate(the_truth);
  std::fputs(calibration_text(r).c_str(), stdout);
  ASSERT_EQ(r.online.size(), 2u);
  EXPECT_GT(r.predictions, 2000);
  for (const VisibilityAgreement& a : r.online) {
    EXPECT_EQ(a.count.count, kFrames - a.horizon);
    EXPECT_LT(std::abs(a.count.bias), 0.1 * a.count.counted);
    EXPECT_LT(a.reliability.error, 0.06);
    EXPECT_LT(a.reliability.brier, 0.1);
  }
  EXPECT_EQ(r.consistency.pose.count, kFrames - 1);
  EXPECT_EQ(r.motion[0].count, kFrames - 5);
  ASSERT_EQ(r.consistency.motions.size(), 3u);
  for (const ConsistencyResult::Motion& m : r.consistency.motions) {
    EXPECT_EQ(m.consistency.count, kFrames - m.frames);
    EXPECT_EQ(m.consistency.degrees, 6);
  }
}

TEST(OdometryCalibration, ATruthThatIsNotTheMotionIsSeenInBothCovariances) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  // The true camera goes 30 % farther.
  const OdometryCalibrationResult good = calibrate(the_truth);
  const OdometryCalibrationResult bad = calibrate([](int k) -> std::optional<Isometry3d> {
    Isometry3d T = pose(k);
    T.translation() = pose(0).translation() + 1.3 * (T.translation() - pose(0).translation());
    return T;
  });
  EXPECT_GT(bad.consistency.pose.mean, 10.0 * good.consistency.pose.mean);
  EXPECT_GT(bad.motion[1].mean, 5.0 * good.motion[1].mean);
  EXPECT_LT(bad.motion[1].within_95, good.motion[1].within_95);
}

TEST(OdometryCalibration, SameFramesSameBits) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  EXPECT_EQ(calibration_json(calibrate(the_truth)).dump(),
            calibration_json(calibrate(the_truth)).dump());
}

TEST(OdometryCalibration, WithoutTruthTheOdometrysOwnMotionCounts) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const OdometryCalibrationResult r = calibrate([](int) { return std::nullopt; });
  const OdometryCalibrationResult with = calibrate(the_truth);
  EXPECT_EQ(r.consistency.pose.count, 0);
  EXPECT_EQ(r.motion[0].count, 0);
  EXPECT_EQ(r.consistency.motions[0].consistency.count, 0);
  EXPECT_TRUE(calibration_json(r)["consistency"]["pose"]["mean"].is_null());
  EXPECT_TRUE(calibration_json(r)["consistency"]["motions"][2]["mean"].is_null());
  EXPECT_NEAR(r.online[0].count.predicted, with.online[0].count.predicted, 1.0);
  EXPECT_EQ(r.online[0].count.counted, with.online[0].count.counted);
}

TEST(OdometryCalibration, WhereItIsLostNothingIsTracked) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const OdometryCalibrationResult r = calibrate(the_truth, 12, 11);
  const OdometryCalibrationResult before = calibrate(the_truth, 11);
  // Of the seven frames with an outcome five later, the last had none.
  EXPECT_EQ(r.online[0].count.count, 7);
  EXPECT_NEAR(7 * r.online[0].count.counted, 6 * before.online[0].count.counted, 1e-6);
}

TEST(OdometryCalibration, TooFewFramesGiveNothingAndSaySo) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  for (const int frames : {0, 1, 5}) {
    const OdometryCalibrationResult r = calibrate(the_truth, frames);
    EXPECT_EQ(r.predictions, 0);
    EXPECT_THAT(calibration_text(r), ::testing::HasSubstr("too few frames"));
    EXPECT_TRUE(calibration_json(r).at("horizons").at(0).at("learned").at("correlation").is_null());
  }
  EXPECT_GT(calibrate(the_truth, 6).predictions, 0);
}

TEST(OdometryCalibration, RecordingsAreApart) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  OdometryCalibration calibration(camera(), {}, {{5}, 1, 0.9});
  for (int recording = 0; recording < 2; ++recording) {
    StereoOdometry odometry(camera(), {}, pose(0));
    calibration.begin_recording();
    for (int k = 0; k < 8; ++k) {
      const auto& pair = pairs()[static_cast<std::size_t>(k)];
      calibration.add(odometry, odometry.process(0.1 * k, pair.left.view(), pair.right.view()),
                      pose(k));
    }
  }
  const OdometryCalibrationResult r = calibration.result();
  EXPECT_EQ(r.online[0].count.count, 6);
  EXPECT_EQ(r.consistency.pose.count, 14);
}

TEST(OdometryCalibration, RefusesHorizonsOfNothing) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  EXPECT_THROW(OdometryCalibration(camera(), {}, {{0}, 1, 0.9}), std::invalid_argument);
  EXPECT_THROW(OdometryCalibration(camera(), {}, {{5}, 0, 0.9}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::odometry_calibration_test
