// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/ground_plane.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/images/image_file.h"
#include "tests/perception/depth_scene.h"

namespace prospect::ground_plane_test {
namespace {

using test::DepthScene;

constexpr double kDegree = M_PI / 180.0;
const PinholeCamera kCamera{420.0, 420.0, 318.0, 243.0, 640.0, 480.0};

GroundPlane find(const DepthScene& scene, const Eigen::Isometry3d& T_WC, const GroundPrior& prior,
                 double noise = 0.002, std::uint64_t seed = 1) {
  return find_ground(kCamera, scene.render(kCamera, T_WC, noise, seed), prior);
}

double tilt_error(const GroundPlane& ground, const Eigen::Isometry3d& T_WC) {
  const Eigen::Vector3d up = T_WC.linear().row(2).transpose();
  return std::acos(std::min(1.0, ground.normal.dot(up)));
}

TEST(GroundPlane, OfAKnownPose) {
  const DepthScene scene;
  std::uint64_t seed = 1;
  for (const double height : {0.3, 0.62, 1.4}) {
    for (const double pitch : {12.0, 30.0}) {
      for (const double roll : {-8.0, 0.0, 5.0}) {
        SCOPED_TRACE(std::to_string(height) + " " + std::to_string(pitch));
        const Eigen::Isometry3d T =
            DepthScene::looking(-1.5, 0.1, height, 0.2, pitch * kDegree, roll * kDegree);
        // The prior is off by 5 cm and 4 degrees.
        const GroundPrior prior = ground_prior(height + 0.05, (pitch + 4.0) * kDegree,
                                               roll * kDegree, 0.1, 10.0 * kDegree);
        const GroundPlane ground = find(scene, T, prior, 0.002, ++seed);
        ASSERT_TRUE(ground.found) << ground.reason;
        EXPECT_LT(std::abs(ground.height - height), 0.004);
        EXPECT_LT(tilt_error(ground, T), 0.2 * kDegree);
        EXPECT_NEAR(ground.pitch(), pitch * kDegree, 0.2 * kDegree);
        EXPECT_NEAR(ground.roll(), roll * kDegree, 0.2 * kDegree);
        EXPECT_LT(std::abs(ground.height - height), 4.0 * ground.sigma_height());
        EXPECT_LT(tilt_error(ground, T), 4.0 * ground.sigma_tilt());
      }
    }
  }
}

TEST(GroundPlane, PriorsAgree) {
  const Eigen::Isometry3d T = DepthScene::looking(1, 2, 0.7, 0.9, 0.3, -0.2);
  const GroundPrior of_pose = ground_prior(T, 0.1, 0.2);
  const GroundPrior of_angles = ground_prior(0.7, 0.3, -0.2, 0.1, 0.2);
  EXPECT_TRUE(of_pose.up.isApprox(of_angles.up, 1e-12));
  EXPECT_NEAR(of_pose.height, of_angles.height, 1e-12);
  GroundPlane plane;
  plane.normal = of_pose.up;
  EXPECT_NEAR(plane.pitch(), 0.3, 1e-12);
  EXPECT_NEAR(plane.roll(), -0.2, 1e-12);
}

// The wall fills most of the image: the largest plane is not the ground.
TEST(GroundPlane, IsNotTheLargestPlane) {
  DepthScene scene;
  scene.room.high.x() = 1.3;
  const Eigen::Isometry3d T = DepthScene::looking(0.0, 0.0, 0.5, 0.0, 3.0 * kDegree);
  int wall = 0, floor = 0;
  for (int v = 0; v < 480; v += 4) {
    for (int u = 0; u < 640; u += 4) {
      const Eigen::Vector3d p = T * (scene.depth(kCamera, T, u, v) * pixel_ray(kCamera, u, v));
      wall += p.x() > 1.299;
      floor += p.z() < 0.001;
    }
  }
  ASSERT_GT(wall, 2 * floor);
  ASSERT_GT(floor, 500);
  const GroundPlane ground = find(scene, T, ground_prior(0.5, 0.0, 0.0, 0.1, 10.0 * kDegree));
  ASSERT_TRUE(ground.found) << ground.reason;
  EXPECT_NEAR(ground.height, 0.5, 0.01);
  EXPECT_LT(tilt_error(ground, T), 1.0 * kDegree);
  EXPECT_LT(std::abs(ground.height - 0.5), 3.0 * ground.sigma_height());
  EXPECT_LT(tilt_error(ground, T), 3.0 * ground.sigma_tilt());
}

// A table that the prior admits and that shows more points than the floor.
TEST(GroundPlane, IsNotATableAboveTheFloor) {
  DepthScene scene;
  scene.boxes.push_back({{-0.5, -2.0, 0.7}, {1.8, 0.35, 0.72}});
  const Eigen::Isometry3d T = DepthScene::looking(-0.9, 0.0, 1.3, 0.0, 25.0 * kDegree);
  int table = 0, floor = 0;
  for (int v = 0; v < 480; v += 4) {
    for (int u = 0; u < 640; u += 4) {
      const double z = (T * (scene.depth(kCamera, T, u, v) * pixel_ray(kCamera, u, v))).z();
      table += std::abs(z - 0.72) < 0.001;
      floor += z < 0.001;
    }
  }
  ASSERT_GT(table, floor);
  ASSERT_GT(floor, 500);
  const GroundPrior wide = ground_prior(1.0, 20.0 * kDegree, 0.0, 0.8, 35.0 * kDegree);
  const GroundPlane ground = find(scene, T, wide);
  ASSERT_TRUE(ground.found) << ground.reason;
  EXPECT_NEAR(ground.height, 1.3, 0.02);
}

TEST(GroundPlane, NotInViewIsNotFound) {
  DepthScene scene;
  scene.room.high.x() = 1.5;
  const GroundPrior prior = ground_prior(1.2, 0.0, 0.0, 0.2, 15.0 * kDegree);
  // Level and 1.2 m high, 0.8 m in front of a wall: the floor begins 2 m away.
  const GroundPlane wall = find(scene, DepthScene::looking(0.7, 0.0, 1.2, 0.0), prior);
  EXPECT_FALSE(wall.found);
  EXPECT_FALSE(wall.reason.empty());
  // Looking up.
  const GroundPlane up =
      find(scene, DepthScene::looking(-1.0, 0.0, 1.2, 0.0, -40.0 * kDegree), prior);
  EXPECT_FALSE(up.found);
  // A corner, from close by, with a wide prior: planes could cut through it in many ways.
  const GroundPrior wide = ground_prior(1.1, 20.0 * kDegree, 0.0, 0.9, 35.0 * kDegree);
  const GroundPlane corner = find(scene, DepthScene::looking(0.8, 1.9, 1.4, 0.8), wide);
  EXPECT_FALSE(corner.found) << corner.height;
}

TEST(GroundPlane, OutsideThePriorIsNotFound) {
  const DepthScene scene;
  const Eigen::Isometry3d T = DepthScene::looking(-1.5, 0.0, 0.62, 0.0, 20.0 * kDegree);
  EXPECT_TRUE(find(scene, T, ground_prior(0.65, 0.35, 0.0, 0.1, 0.1)).found);
  EXPECT_FALSE(find(scene, T, ground_prior(0.85, 0.35, 0.0, 0.1, 0.1)).found);
  EXPECT_FALSE(find(scene, T, ground_prior(0.62, 0.10, 0.0, 0.1, 0.1)).found);
  EXPECT_FALSE(find(scene, T, ground_prior(0.62, 0.35, 0.3, 0.1, 0.1)).found);
}

// Clutter over half of the floor, a third of the pixels gone, and reflections below the floor.
TEST(GroundPlane, WithClutterAndHoles) {
  DepthScene scene;
  scene.boxes = {{{0.0, -0.8, 0.0}, {0.4, -0.3, 0.4}},
                 {{0.6, 0.2, 0.0}, {1.0, 0.9, 0.3}},
                 {{1.5, -0.4, 0.0}, {2.0, 0.3, 1.2}}};
  const Eigen::Isometry3d T = DepthScene::looking(-1.2, 0.0, 0.6, 0.0, 18.0 * kDegree);
  DepthImage image = scene.render(kCamera, T, 0.003, 5);
  std::mt19937 generator(3);
  for (float& z : image.depth) {
    const unsigned chance = generator() % 100;
    if (chance < 30) z = DepthImage::kInvalid;
    if (chance >= 96) z *= 1.4F;
  }
  const GroundPlane ground =
      find_ground(kCamera, image, ground_prior(0.6, 18.0 * kDegree, 0.0, 0.1, 10.0 * kDegree));
  ASSERT_TRUE(ground.found) << ground.reason;
  EXPECT_NEAR(ground.height, 0.6, 0.005);
  EXPECT_LT(tilt_error(ground, T), 0.3 * kDegree);
}

/// (theta_1, theta_2, h) of the true plane less that of the measured one.
Eigen::Vector3d error_of(const GroundPlane& ground, const Eigen::Isometry3d& T_WC) {
  const Eigen::Vector3d up = T_WC.linear().row(2).transpose();
  const Eigen::Vector3d t1 =
      (Eigen::Vector3d::UnitX() - ground.normal.x() * ground.normal).normalized();
  return {up.dot(t1), up.dot(ground.normal.cross(t1)), T_WC.translation().z() - ground.height};
}

// Errors of single pixels, and errors that neighbouring pixels share (patches of 16 px), as a real
// sensor's: the claim holds for both.
TEST(GroundPlane, SigmasMatchTheErrors) {
  const DepthScene scene;
  const PinholeCamera camera{210.0, 210.0, 159.0, 121.0, 320.0, 240.0};
  const Eigen::Isometry3d T = DepthScene::looking(-1.5, 0.1, 0.62, 0.0, 20.0 * kDegree);
  const DepthImage ideal = scene.render(camera, T);
  for (const int patch : {1, 16}) {
    double height = 0.0, tilt = 0.0;
    constexpr int kTrials = 60;
    for (int trial = 0; trial < kTrials; ++trial) {
      DepthImage image = ideal;
      std::mt19937_64 generator(trial);
      std::normal_distribution<double> normal;
      const int columns = 320 / patch + 1;
      std::vector<double> noise(columns * (240 / patch + 1));
      for (double& e : noise) e = normal(generator);
      for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 320; ++u) {
          const double z = image.at(u, v);
          image.at(u, v) =
              static_cast<float>(z + 0.004 * z * z * noise[v / patch * columns + u / patch]);
        }
      }
      const GroundPlane ground =
          find_ground(camera, image, ground_prior(0.62, 0.35, 0.0, 0.1, 0.17));
      ASSERT_TRUE(ground.found) << ground.reason;
      const Eigen::Vector3d e = error_of(ground, T);
      const Eigen::Matrix2d C = ground.covariance.topLeftCorner<2, 2>();
      height += e.z() * e.z() / ground.covariance(2, 2) / kTrials;
      tilt += 0.5 * e.head<2>().dot(C.inverse() * e.head<2>()) / kTrials;
    }
    std::printf("patches of %d px: NEES of the height %.2f, of the tilt %.2f\n", patch, height,
                tilt);
    EXPECT_GT(height, 0.5);
    EXPECT_LT(height, 2.0);
    EXPECT_GT(tilt, 0.5);
    EXPECT_LT(tilt, 2.0);
  }
}

TEST(GroundPlane, OfGarbageIsNotFound) {
  const GroundPrior prior = ground_prior(0.6, 0.3, 0.0, 0.1, 0.17);
  const float inf = std::numeric_limits<float>::infinity();
  for (const float z : {DepthImage::kInvalid, 0.0F, -1.0F, inf, -inf, 1e30F, 1.0F}) {
    EXPECT_FALSE(find_ground(kCamera, DepthImage(640, 480, z), prior).found) << z;
  }
  EXPECT_FALSE(find_ground(kCamera, DepthImage(), prior).found);
  EXPECT_EQ(find_ground(kCamera, DepthImage(320, 240, 1.0F), prior).reason,
            "the image has the wrong size");
  DepthImage torn(640, 480, 1.0F);
  torn.depth.resize(7);
  EXPECT_FALSE(find_ground(kCamera, torn, prior).found);
  DepthImage noise(640, 480);
  std::mt19937 generator(1);
  for (float& z : noise.depth) z = 0.3F + 5.0F * static_cast<float>(generator() % 10000) / 10000.0F;
  EXPECT_FALSE(find_ground(kCamera, noise, prior).found);
}

TEST(GroundPlane, SameInputSameBits) {
  const DepthScene scene;
  const Eigen::Isometry3d T = DepthScene::looking(-1.5, 0.1, 0.62, 0.0, 0.35);
  const GroundPrior prior = ground_prior(0.62, 0.3, 0.0, 0.1, 0.17);
  const GroundPlane a = find(scene, T, prior), b = find(scene, T, prior);
  EXPECT_EQ(std::memcmp(a.normal.data(), b.normal.data(), sizeof(double) * 3), 0);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.covariance, b.covariance);
}

// A wheeled robot with a stereo depth camera, 0.62 m above a flat floor; its mount is not known, so
// the prior is as wide as a user's who knows nothing.
TEST(GroundPlane, OfARecording) {
  const std::string folder = std::string(PROSPECT_SHARED_DATA) + "/rgbd/aims_realsense_a/depth";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const PinholeCamera camera{384.0, 384.0, 320.0, 240.0, 640.0, 480.0};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  ASSERT_EQ(files.size(), 33U);
  std::vector<Eigen::Vector3d> normals;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::string& file : files) {
    const cv::Mat raw = test::read_image(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(raw.type(), CV_16U);
    const DepthImage image =
        depth_image(raw.ptr<std::uint16_t>(), raw.cols, raw.rows, raw.cols, 0.001);
    const GroundPlane ground =
        find_ground(camera, image, ground_prior(1.1, 20.0 * kDegree, 0.0, 0.9, 35.0 * kDegree));
    EXPECT_TRUE(ground.found) << file << " " << ground.reason;
    EXPECT_NEAR(ground.height, 0.624, 0.01) << file;
    normals.push_back(ground.normal);
    mean += ground.normal;
  }
  mean.normalize();
  double square = 0.0;
  for (const Eigen::Vector3d& n : normals) square += std::pow(std::acos(n.dot(mean)), 2);
  const double spread = std::sqrt(square / static_cast<double>(normals.size())) / kDegree;
  std::printf("spread of the tilt %.2f deg\n", spread);
  EXPECT_LT(spread, 1.5);
}

}  // namespace
}  // namespace prospect::ground_plane_test
