// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_estimation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "engine/support/cholesky.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::pose_estimation_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class PoseEstimation : public testing::Test {
 protected:
  std::mt19937_64 rng_{5};
  StereoCamera camera_;
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  double normal(double s) { return s > 0 ? std::normal_distribution<double>(0.0, s)(rng_) : 0.0; }

  Isometry3d motion(double translation, double rotation) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(-1, 1) * (i < 3 ? translation : rotation);
    return exp_se3(xi);
  }

  struct Scene {
    std::vector<PointObservation> observations;
    Isometry3d truth;
  };
  /// n points triangulated from noisy stereo measurements at the identity, seen from T with noise.
  Scene scene(int n, const Isometry3d& T, double outliers, const PoseEstimatorOptions& options) {
    Scene s;
    s.truth = T;
    while (static_cast<int>(s.observations.size()) < n) {
      const double u = uniform(20, 620), v = uniform(20, 460), z = uniform(1.0, 8.0);
      const double d = camera_.left.fx * camera_.baseline / z;
      const Vector3d true_point = camera_.triangulate(u, v, d);
      const Vector3d Y = T * true_point;
      if (Y.z() < 0.3 || !camera_.left.in_image(camera_.left.project(Y))) continue;
      const double measured = d + normal(camera_.sigma_d);
      PointObservation o;
      o.measured << u, v, measured;
      o.sigma << 1e-9, 1e-9, camera_.sigma_d;
      o.left = camera_.left.project(Y) +
               Eigen::Vector2d(normal(options.sigma_left), normal(options.sigma_left));
      o.right = camera_.left.project(Y - Vector3d(camera_.baseline, 0, 0)).x() +
                normal(options.sigma_right);
      if (uniform(0, 1) < outliers) o.left += Eigen::Vector2d(uniform(-60, 60), uniform(-60, 60));
      if (uniform(0, 1) < 0.2) o.right = std::nan("");
      s.observations.push_back(o);
    }
    return s;
  }
};

TEST_F(PoseEstimation, TheCovarianceIsHonest) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  // Normalised error squared of the pose over 300 trials: chi^2_6 / 6, mean 1 +- 0.033.
  PoseEstimatorOptions options;
  options.sigma_left = options.sigma_right = 0.25;
  double sum = 0.0, chi2 = 0.0;
  int n = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Scene s = scene(120, motion(0.3, 0.08), 0.0, options);
    const PoseEstimate e =
        refine_pose(camera_, s.observations, {}, Isometry3d::Identity(), options);
    ASSERT_TRUE(e.solved);
    const Vector6d error = log_se3(e.T_CW * s.truth.inverse());
    sum += error.dot(e.covariance.ldlt().solve(error)) / 6.0;
    chi2 += e.chi2_per_dof;
    ++n;
    EXPECT_LT((e.T_CW.inverse().translation() - s.truth.inverse().translation()).norm(), 0.02);
    EXPECT_GT(e.sigma_position(), 1e-4);
    EXPECT_LT(e.sigma_position(), 0.02);
  }
  EXPECT_GT(sum / n, 0.8);
  EXPECT_LT(sum / n, 1.3);
  EXPECT_NEAR(chi2 / n, 1.0, 0.1);
}

TEST_F(PoseEstimation, RansacSortsOutHalfOfTheObservations) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  PoseEstimatorOptions options;
  options.sigma_left = options.sigma_right = 0.25;
  for (int trial = 0; trial < 50; ++trial) {
    const Scene s = scene(150, motion(0.4, 0.1), 0.5, options);
    const PoseEstimate coarse =
        ransac_pose(camera_, s.observations, Isometry3d::Identity(), 7, options);
    ASSERT_TRUE(coarse.solved) << trial;
    const PoseEstimate fine =
        refine_pose(camera_, s.observations, coarse.inlier, coarse.T_CW, options);
    ASSERT_TRUE(fine.solved);
    const Vector6d error = log_se3(fine.T_CW * s.truth.inverse());
    EXPECT_LT(error.head<3>().norm(), 0.03) << trial;
    EXPECT_LT(error.tail<3>().norm(), 0.005) << trial;
    // Same seed, same bits.
    const PoseEstimate again =
        ransac_pose(camera_, s.observations, Isometry3d::Identity(), 7, options);
    EXPECT_EQ(again.T_CW.matrix(), coarse.T_CW.matrix());
    EXPECT_EQ(again.inlier, coarse.inlier);
  }
}

TEST_F(PoseEstimation, SaysSoWhenThePointsDoNotFixThePose) {
  PoseEstimatorOptions options;
  Scene few = scene(5, Isometry3d::Identity(), 0.0, options);
  EXPECT_FALSE(ransac_pose(camera_, few.observations, Isometry3d::Identity(), 1, options).solved);
  EXPECT_FALSE(refine_pose(camera_, few.observations, {}, Isometry3d::Identity(), options).solved);
  // Twenty times the same point.
  Scene one = scene(1, Isometry3d::Identity(), 0.0, options);
  one.observations[0].right = std::nan("");
  const std::vector<PointObservation> same(20, one.observations[0]);
  const PoseEstimate e = refine_pose(camera_, same, {}, Isometry3d::Identity(), options);
  EXPECT_FALSE(e.solved);
  // Nothing but noise.
  Scene noise = scene(100, Isometry3d::Identity(), 1.0, options);
  EXPECT_FALSE(ransac_pose(camera_, noise.observations, Isometry3d::Identity(), 1, options).solved);
}

// Stereo tracks of a car as text, with the camera poses that came with them: refinement alone,
// without images. Each pair of frames `apart` is solved from the motion before it.
TEST(RecordedTracks, RefinementAgreesWithTheGivenPoses) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const std::string folder = PROSPECT_SHARED_DATA "/vo_text/gtsam_kitti_large/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  StereoCamera camera;
  double skew = 0.0;
  std::ifstream(folder + "VO_calibration.txt") >> camera.left.fx >> camera.left.fy >> skew >>
      camera.left.cx >> camera.left.cy >> camera.baseline;
  camera.left.width = 1241;
  camera.left.height = 376;
  std::map<int, Isometry3d> T_WC;
  std::ifstream poses(folder + "VO_camera_poses_large.txt");
  for (int k; poses >> k;) {
    Eigen::Matrix4d T;
    for (int i = 0; i < 16; ++i) poses >> T(i / 4, i % 4);
    T_WC[k] = Isometry3d(T);
  }
  std::map<int, std::map<int, Vector3d>> seen;  // frame, landmark: (u_left, u_right, v)
  std::ifstream factors(folder + "VO_stereo_factors_large.txt");
  Vector3d m, point;
  for (int k, l; factors >> k >> l >> m[0] >> m[1] >> m[2] >> point[0] >> point[1] >> point[2];) {
    seen[k][l] = m;
  }
  ASSERT_EQ(T_WC.size(), 26u);
  ASSERT_EQ(seen.size(), 26u);
  PoseEstimatorOptions options;
  options.sigma_left = options.sigma_right = 0.5;  // tracks of another program, from corners alone
  for (const int apart : {1, 3}) {
    std::vector<double> translation, rotation;
    int used = 0, all = 0;
    Isometry3d prior = Isometry3d::Identity();
    for (int k = 1; k + apart <= 26; ++k) {
      std::vector<PointObservation> observations;
      for (const auto& [l, a] : seen[k]) {
        const auto b = seen[k + apart].find(l);
        if (b == seen[k + apart].end() || a[0] - a[1] < 1.0) continue;
        PointObservation o;
        o.measured << a[0], a[2], a[0] - a[1];
        o.sigma << 0.5, 0.5, 0.7;
        o.left << b->second[0], b->second[2];
        o.right = b->second[1];
        observations.push_back(o);
      }
      const PoseEstimate first = ransac_pose(camera, observations, prior, 1, options);
      ASSERT_TRUE(first.solved) << k;
      const PoseEstimate e = refine_pose(camera, observations, first.inlier, first.T_CW, options);
      ASSERT_TRUE(e.solved) << k;
      prior = e.T_CW;
      const Isometry3d truth = T_WC[k + apart].inverse() * T_WC[k];
      const Vector6d error = log_se3(e.T_CW * truth.inverse());
      translation.push_back(error.head<3>().norm() / truth.translation().norm());
      rotation.push_back(error.tail<3>().norm() * 180.0 / M_PI);
      used += e.inliers;
      all += static_cast<int>(observations.size());
    }
    std::sort(translation.begin(), translation.end());
    std::sort(rotation.begin(), rotation.end());
    const std::size_t half = translation.size() / 2;
    std::printf(
        "frames %d apart, %zu pairs, %d of %d points agree: off by %.2f %% and %.3f deg in the "
        "median, %.2f %% and %.3f deg at most\n",
        apart, translation.size(), used, all, 100 * translation[half], rotation[half],
        100 * translation.back(), rotation.back());
    EXPECT_LT(translation[half], 0.01);
    EXPECT_LT(rotation[half], 0.05);
    EXPECT_LT(translation.back(), 0.015);
    EXPECT_LT(rotation.back(), 0.1);
    EXPECT_GT(used, 0.9 * all);
  }
}

}  // namespace
}  // namespace prospect::pose_estimation_test
