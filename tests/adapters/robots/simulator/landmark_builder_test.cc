// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/landmark_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "adapters/robots/simulator/depth_camera.h"

namespace prospect::landmark_builder_test {
namespace {

const FeatureCameraOptions kCamera;
const CameraMount kMount;
const VoxelGrid kEmpty({0.1, 0, 0, 1, 1}, -0.3, 2.5);

FeatureObservation observe(std::uint32_t id, const Eigen::Vector3d& Y) {
  FeatureObservation o;
  o.feature = id;
  o.true_point = Y;
  const Eigen::Vector2d p = kCamera.stereo.left.project(Y);
  o.u = p.x();
  o.v = p.y();
  o.disparity = kCamera.stereo.left.fx * kCamera.stereo.baseline / Y.z();
  return o;
}

// A point of W seen from a pose, without noise.
FeatureObservation observe_from(std::uint32_t id, const Eigen::Vector3d& l, const Pose& pose) {
  return observe(id, camera_pose(pose, kMount).inverse() * l);
}

TEST(LandmarkBuilder, TriangulatesInTheEstimatedFrame) {
  LandmarkBuilder builder({}, kCamera, kMount);
  const Pose truth{{1.0, 2.0, 0.0}, 0.3};
  const Pose estimate{{1.1, 1.9, 0.0}, 0.35};  // the map bends with it
  const Eigen::Vector3d Y(0.3, -0.2, 2.0);
  const Eigen::Isometry3d T_est = camera_pose(estimate, kMount);
  builder.update({observe(7, Y)}, estimate, kEmpty, 0.0);
  const auto map = builder.map();
  ASSERT_EQ(map->landmarks.size(), 1U);
  const Landmark& l = map->landmarks[0];
  EXPECT_EQ(l.id, 7U);
  EXPECT_LT((l.position - T_est * Y).norm(), 1e-9);
  EXPECT_GT((l.position - camera_pose(truth, kMount) * Y).norm(), 0.05);
  EXPECT_NEAR(l.creation_range, Y.norm(), 1e-9);
  EXPECT_LT((l.position + l.creation_range * l.creation_direction - T_est.translation()).norm(),
            1e-9);
  // Sigma: along the ray sigma_z = z^2 sigma_d / (f b), in C.
  const Eigen::Matrix3d Sigma_C = T_est.linear().transpose() * l.covariance * T_est.linear();
  const double sigma_z =
      4.0 * kCamera.stereo.sigma_d / (kCamera.stereo.left.fx * kCamera.stereo.baseline);
  EXPECT_NEAR(std::sqrt(Sigma_C(2, 2)), sigma_z, 1e-9);
  EXPECT_LT((Sigma_C - Sigma_C.transpose()).norm(), 1e-15);
}

TEST(LandmarkBuilder, BetterMeasurementsReplaceAndNewViewsCreateAnew) {
  LandmarkBuilder builder({}, kCamera, kMount);
  const Eigen::Vector3d l(4.0, 0.0, 0.5);
  const Pose far{{0.0, 0.0, 0.0}, 0.0}, nearer{{1.0, 0.0, 0.0}, 0.0}, close{{2.5, 0.0, 0.0}, 0.0};
  builder.update({observe_from(1, l, far)}, far, kEmpty, 0.0);
  const Landmark first = builder.map()->landmarks[0];
  builder.update({observe_from(1, l, nearer)}, nearer, kEmpty, 0.0);
  const Landmark second = builder.map()->landmarks[0];
  EXPECT_LT(second.covariance.trace(), 0.5 * first.covariance.trace());
  EXPECT_EQ(second.creation_range, first.creation_range);  // within the bounds of the same view
  builder.update({observe_from(1, l, close)}, close, kEmpty, 0.0);
  EXPECT_NEAR(builder.map()->landmarks[0].creation_range, 1.5, 0.01);  // 4 m to 1.5 m: anew
  EXPECT_EQ(builder.map()->landmarks.size(), 1U);
}

TEST(LandmarkBuilder, SurvivalIsTheShareOfExpectedViewsTracked) {
  LandmarkBuilderOptions options;
  options.cull_survival = 0.0;
  LandmarkBuilder builder(options, kCamera, kMount);
  const Pose pose;
  const Eigen::Vector3d seen(2.0, 0.3, 0.5), lost(2.0, -0.3, 0.5), behind(-2.0, 0.0, 0.5);
  builder.update({observe_from(1, seen, pose), observe_from(2, lost, pose)}, pose, kEmpty, 0.0);
  Pose back = pose;
  back.yaw = 3.14159;
  builder.update({observe_from(3, behind, back)}, back, kEmpty, 0.0);
  for (int n = 0; n < 20; ++n) builder.update({observe_from(1, seen, pose)}, pose, kEmpty, 0.0);
  const auto map = builder.map();
  ASSERT_EQ(map->landmarks.size(), 3U);
  const double a = options.survival_prior_tracked, b = options.survival_prior_missed;
  EXPECT_NEAR(map->landmarks[0].survival, (a + 21.0) / (a + b + 21.0), 1e-12);
  EXPECT_NEAR(map->landmarks[1].survival, (a + 1.0) / (a + b + 21.0), 1e-12);
  EXPECT_NEAR(map->landmarks[2].survival, (a + 1.0) / (a + b + 1.0), 1e-12);  // never expected

  // A wall of the map in between: not expected, not counted.
  VoxelGrid walled({0.1, 0, -20, 40, 40}, -0.3, 2.5);
  for (int j = -20; j < 20; ++j) {
    for (int k = 0; k < 20; ++k) walled.set(10, j, k, CellState::kOccupied);
  }
  builder.update({}, pose, walled, 0.0);
  EXPECT_EQ(builder.map()->landmarks[1].survival, map->landmarks[1].survival);
}

TEST(LandmarkBuilder, CullsWhatIsNotTrackedAndKeepsTheLimit) {
  LandmarkBuilderOptions options;
  options.max_landmarks = 50;
  LandmarkBuilder builder(options, kCamera, kMount);
  const Pose pose;
  builder.update({observe_from(1, {2.0, 0.0, 0.5}, pose)}, pose, kEmpty, 0.0);
  for (int n = 0; n < 40; ++n) builder.update({}, pose, kEmpty, 0.0);
  EXPECT_TRUE(builder.map()->landmarks.empty());
  for (std::uint32_t n = 0; n < 200; ++n) {
    builder.update({observe_from(100 + n, {2.0, -0.5 + 0.005 * n, 0.5}, pose)}, pose, kEmpty, 0.0);
    const auto map = builder.map();
    EXPECT_LE(map->landmarks.size(), 50U);
    EXPECT_EQ(map->landmarks.back().id, 100 + n);  // what is seen now is kept
  }
}

TEST(LandmarkBuilder, DensityIsAQuantileOverNewSurface) {
  LandmarkBuilderOptions options;
  options.density.quantile = 0.25;
  LandmarkBuilder builder(options, kCamera, kMount);
  EXPECT_EQ(builder.map()->feature_density, options.density.initial);
  const Pose pose;
  std::uint32_t id = 0;
  double area = 0.0;
  // Samples of 2, 4, ... 16 features per square metre, over 1.25 m^2 each.
  for (int n = 1; n <= 8; ++n) {
    std::vector<FeatureObservation> observations;
    const int count = static_cast<int>(std::lround(2.0 * n * 1.25));
    for (int m = 0; m < count; ++m) {
      observations.push_back(observe_from(id++, {2.0, 0.01 * m, 0.5}, pose));
    }
    area += 1.25;
    builder.update(observations, pose, kEmpty, area);
  }
  // Sorted: 2 or 3 / 1.25 first; rank floor(0.25 x 7) = 1, the second: 5 / 1.25.
  EXPECT_NEAR(builder.map()->feature_density, 4.0, 1e-12);
}

TEST(LandmarkBuilder, SnapshotsNeverChange) {
  LandmarkBuilder builder({}, kCamera, kMount);
  const Pose pose;
  builder.update({observe_from(1, {2.0, 0.0, 0.5}, pose)}, pose, kEmpty, 0.0);
  const auto held = builder.map();
  const double survival = held->landmarks[0].survival;
  builder.update({observe_from(2, {2.0, 0.2, 0.5}, pose)}, pose, kEmpty, 5.0);
  EXPECT_EQ(held->landmarks.size(), 1U);
  EXPECT_EQ(held->landmarks[0].survival, survival);
  EXPECT_EQ(builder.map()->landmarks.size(), 2U);
}

TEST(LandmarkBuilder, RejectsOptionsOutOfRange) {
  LandmarkBuilderOptions options;
  options.max_scale = 0.5;
  EXPECT_THROW(LandmarkBuilder(options, kCamera, kMount), std::invalid_argument);
  options = {};
  options.density.quantile = -0.1;
  EXPECT_THROW(LandmarkBuilder(options, kCamera, kMount), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::landmark_builder_test
