// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/track.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <memory>

namespace prospect::track_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A landmark in the middle of the image, 2 m ahead of a camera at the origin.
Track ahead(const StereoCamera& camera) {
  Track track;
  track.anchor = std::make_shared<Anchor>();
  track.pixel = {static_cast<float>(camera.left.cx), static_cast<float>(camera.left.cy)};
  track.disparity = camera.left.fx * camera.baseline / 2.0;
  place_track(track, camera, 0.0);
  return track;
}

Isometry3d moved(double x, double y, double z) {  // T_CW of a camera there
  return Isometry3d(Eigen::Translation3d(-x, -y, -z));
}

TEST(Track, IsPlacedByItsDisparityAndTheOffset) {
  const StereoCamera camera;
  Track track = ahead(camera);
  EXPECT_LT((track.position - Vector3d(0.0, 0.0, 2.0)).norm(), 1e-6);
  track.disparity -= 3.0;
  place_track(track, camera, 3.0);
  EXPECT_LT((track.position - Vector3d(0.0, 0.0, 2.0)).norm(), 1e-6);
  EXPECT_GT(track.covariance(2, 2), track.covariance(0, 0));
}

TEST(Track, IsPredictedWhereItIsSeen) {
  const StereoCamera camera;
  const Track track = ahead(camera);
  const auto here = predict_track(track, moved(0.0, 0.0, 0.0), camera, 1.6);
  ASSERT_TRUE(here);
  EXPECT_LT((here->pixel - track.pixel).norm(), 1e-4f);
  EXPECT_LT((here->A - Eigen::Matrix2f::Identity()).norm(), 1e-5f);
  // Half a metre nearer: larger by 4 : 3, so offsets there are 3 : 4 of those at the anchor.
  const auto nearer = predict_track(track, moved(0.0, 0.0, 0.5), camera, 1.6);
  ASSERT_TRUE(nearer);
  EXPECT_LT((nearer->A - 0.75f * Eigen::Matrix2f::Identity()).norm(), 1e-5f);
  EXPECT_FALSE(predict_track(track, moved(0.0, 0.0, 1.0), camera, 1.6));   // too near
  EXPECT_FALSE(predict_track(track, moved(0.0, 0.0, 3.0), camera, 1.6));   // behind
  EXPECT_FALSE(predict_track(track, moved(30.0, 0.0, 0.0), camera, 1.6));  // aside
}

TEST(Track, IsWarpedAsThePlaneOfItsSlope) {
  // A plane n . X = h that the anchor's camera sees at a slant; its disparity is f b n . ray / h.
  const StereoCamera camera;
  const Vector3d n = Vector3d(0.3, 0.8, 0.4).normalized();
  const auto on_plane = [&](const Eigen::Vector2d& p) {
    const Vector3d ray((p.x() - camera.left.cx) / camera.left.fx,
                       (p.y() - camera.left.cy) / camera.left.fy, 1.0);
    return Vector3d(0.9 / n.dot(ray) * ray);
  };
  const Eigen::Vector2d pixel(350.0, 270.0);
  Track track;
  track.anchor = std::make_shared<Anchor>();
  track.pixel = pixel.cast<float>();
  track.disparity = camera.left.fx * camera.baseline / on_plane(pixel).z();
  track.slope = camera.baseline / 0.9 * n.head<2>();
  place_track(track, camera, 0.0);
  Isometry3d T = moved(0.1, -0.05, 0.2);
  T.rotate(Eigen::AngleAxisd(0.1, Vector3d(0.2, 1.0, 0.5).normalized()));
  const auto predicted = predict_track(track, T, camera, 1.6);
  ASSERT_TRUE(predicted);
  for (const bool right : {false, true}) {
    const auto shown = [&](const Eigen::Vector2d& p) {
      return camera.left.project(T * on_plane(p) - Vector3d(right * camera.baseline, 0.0, 0.0));
    };
    Eigen::Matrix2d B;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d step = 0.5 * Eigen::Vector2d::Unit(i);
      B.col(i) = shown(pixel + step) - shown(pixel - step);
    }
    const Eigen::Matrix2f& A = right ? predicted->A_right : predicted->A;
    EXPECT_LT((A.cast<double>() * B - Eigen::Matrix2d::Identity()).norm(), 1e-3) << right;
  }
}

TEST(Track, IsInFullViewAwayFromEdgesAndLimits) {
  const StereoCamera camera;
  const Track track = ahead(camera);
  EXPECT_TRUE(in_full_view(track, moved(0.0, 0.0, 0.0), camera, 1.6));
  // 2 / 1.3 = 1.54 is within the limit, but not well within.
  EXPECT_TRUE(predict_track(track, moved(0.0, 0.0, 0.7), camera, 1.6));
  EXPECT_FALSE(in_full_view(track, moved(0.0, 0.0, 0.7), camera, 1.6));
  // Five pixels from the left edge.
  const double aside = 2.0 * (camera.left.cx - 5.0) / camera.left.fx;
  EXPECT_TRUE(predict_track(track, moved(aside, 0.0, 0.0), camera, 1.6));
  EXPECT_FALSE(in_full_view(track, moved(aside, 0.0, 0.0), camera, 1.6));
}

TEST(Track, IsObservedWithTheOffsetCorrected) {
  const StereoCamera camera;
  std::vector<Track> tracks(3, ahead(camera));
  tracks[1].tracked = tracks[2].tracked = true;
  tracks[1].left = {10.0f, 20.0f};
  tracks[2].right = 7.0f;
  tracks[2].has_right = true;
  tracks[2].disparity_variance = 0.07;
  tracks[2].left_covariance << 0.4, 0.1, 0.1, 0.2;
  tracks[2].right_variance = 0.3;
  const auto observed = observe_tracks(tracks, {0.1, 0.2, 0.3}, 0.5);
  EXPECT_EQ(observed.index, (std::vector<int>{1, 2}));
  EXPECT_FALSE(observed.seen[0].sees_right());
  EXPECT_EQ(observed.seen[0].left, Eigen::Vector2d(10.0, 20.0));
  EXPECT_NEAR(observed.seen[0].measured.z(), tracks[1].disparity + 0.5, 1e-12);
  EXPECT_NEAR(observed.seen[1].right, 6.5, 1e-12);
  EXPECT_LT((observed.seen[1].sigma - Vector3d(0.1, 0.2, 0.4)).norm(), 1e-12);
  EXPECT_EQ(observed.seen[1].left_covariance, tracks[2].left_covariance);
  EXPECT_EQ(observed.seen[1].right_variance, 0.3);
}

}  // namespace
}  // namespace prospect::track_test
