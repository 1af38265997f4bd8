// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/relocalization.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "adapters/robots/simulator/depth_camera.h"
#include "engine/support/cholesky.h"

namespace prospect::relocalization_test {
namespace {

// What a stereo camera at a pose sees of landmarks that were created from that very pose.
struct Scene {
  StereoCamera stereo;
  CameraMount mount;
  Pose pose;
  std::vector<FeatureObservation> observations;
  std::map<std::uint32_t, Landmark> landmarks;

  Scene(int count, const Pose& at, std::mt19937_64& random, double farthest = 5.0) : pose(at) {
    std::uniform_real_distribution<double> u(20.0, 620.0), v(20.0, 460.0), z(1.5, farthest);
    const Eigen::Isometry3d T_WC = camera_pose(pose, mount);
    for (int n = 0; n < count; ++n) {
      const double depth = z(random);
      const double disparity = stereo.left.fx * stereo.baseline / depth;
      FeatureObservation o;
      o.feature = static_cast<std::uint32_t>(7 * n + 3);
      o.u = u(random);
      o.v = v(random);
      o.disparity = disparity;
      o.true_point = stereo.triangulate(o.u, o.v, o.disparity);
      observations.push_back(o);
      Landmark l;
      l.id = o.feature;
      l.position = T_WC * o.true_point;
      const Eigen::Vector3d to_eye = T_WC.translation() - l.position;
      l.creation_range = to_eye.norm();
      l.creation_direction = to_eye.normalized();
      landmarks[o.feature] = l;
    }
  }

  std::optional<Pose> find(const Pose& guess, int least = 12,
                           const Eigen::Matrix3d& Omega = Eigen::Matrix3d::Zero()) const {
    const auto found = find_surely(guess, least, Omega);
    return found ? std::optional(found->pose) : std::nullopt;
  }

  std::optional<FoundPose> find_surely(const Pose& guess, int least,
                                       const Eigen::Matrix3d& Omega) const {
    return relocalize(
        observations,
        [this](std::uint32_t feature) -> const Landmark* {
          const auto it = landmarks.find(feature);
          return it == landmarks.end() ? nullptr : &it->second;
        },
        stereo, mount, guess, Omega, least);
  }

  void measure(std::mt19937_64& random) {
    std::normal_distribution<double> normal(0.0, 1.0);
    for (FeatureObservation& o : observations) {
      o.u += stereo.sigma_u * normal(random);
      o.v += stereo.sigma_v * normal(random);
      o.disparity += stereo.sigma_d * normal(random);
    }
  }
};

Pose random_pose(std::mt19937_64& random, double yaw_limit = M_PI) {
  std::uniform_real_distribution<double> xy(-30.0, 30.0), yaw(-yaw_limit, yaw_limit);
  const double x = xy(random), y = xy(random);
  return {{x, y, 0.0}, yaw(random)};
}

// Off by up to 0.2 m and 0.5 rad: what a robot has that was lost for some metres.
Pose nearby(const Pose& pose, std::mt19937_64& random) {
  std::uniform_real_distribution<double> off(-0.14, 0.14), turn(-0.5, 0.5);
  Pose guess = pose;
  guess.position.x() += off(random);
  guess.position.y() += off(random);
  guess.yaw += turn(random);
  return guess;
}

double distance(const Pose& a, const Pose& b) { return (a.position - b.position).head<2>().norm(); }

TEST(Relocalization, ExactWithoutNoiseAndContinuousInYaw) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 500; ++n) {
    Pose pose = random_pose(random);
    if (n % 4 == 0) pose.yaw = std::copysign(M_PI - 1e-3 * (n % 16), pose.yaw);
    const Scene scene(12 + n % 60, pose, random);
    Pose guess = nearby(pose, random);
    // The guess may stand on the other side of pi, or have turned about itself many times.
    const double turns = 2.0 * M_PI * (n % 7 - 3);
    guess.yaw += turns;
    guess.position.z() = 0.01;
    const auto found = scene.find(guess);
    ASSERT_TRUE(found) << n;
    EXPECT_LT(distance(*found, pose), 1e-9) << n;
    EXPECT_NEAR(found->yaw, pose.yaw + turns, 1e-9) << n;
    EXPECT_EQ(found->position.z(), guess.position.z());
    const auto again = scene.find(guess);
    EXPECT_EQ(again->position, found->position);
    EXPECT_EQ(again->yaw, found->yaw);
  }
}

// Of the maximum a posteriori estimate without outliers: (Omega + sum_i J_i^T S_i^-1 J_i)^-1.
Eigen::Matrix3d covariance(const Scene& scene, const Eigen::Matrix3d& Omega) {
  Eigen::Matrix3d H = Omega;
  const Eigen::Isometry3d T_WC = camera_pose(scene.pose, scene.mount);
  for (const FeatureObservation& o : scene.observations) {
    const Eigen::Matrix3d Y = scene.stereo.triangulation_covariance(o.u, o.v, o.disparity);
    const Eigen::Vector3d arm = T_WC * o.true_point - scene.pose.position;
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    const Eigen::Matrix3d noise = T_WC.linear() * Y * T_WC.linear().transpose() +
                                  scene.landmarks.at(o.feature).covariance +
                                  4e-4 * Eigen::Matrix3d::Identity();
    H += J.transpose() * noise.topLeftCorner<2, 2>().inverse() * J;
  }
  return H.inverse();
}

// With and without knowledge of the guess; the 2 cm of slack are noise of the landmarks here.
TEST(Relocalization, ErrorsUnderNoiseHaveTheCovarianceOfTheEstimator) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const Eigen::Vector3d sigma(0.03, 0.03, 0.01);
  const Eigen::Matrix3d known = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  for (const bool prior : {false, true}) {
    SCOPED_TRACE(prior);
    std::mt19937_64 random(2);
    constexpr int kTrials = 600;
    double sum = 0.0, square = 0.0, told = 0.0;
    int found_count = 0;
    for (int n = 0; n < kTrials; ++n) {
      // With a prior also few points.
      Scene scene(prior ? 14 : 80, random_pose(random), random, 4.0);
      for (auto& [id, l] : scene.landmarks) {
        l.covariance = Eigen::Matrix3d::Identity() * 4e-4;
        for (int a = 0; a < 3; ++a) l.position[a] += std::sqrt(8e-4) * normal(random);
      }
      const Eigen::Matrix3d Omega = prior ? known : Eigen::Matrix3d::Zero();
      const Eigen::Matrix3d C = covariance(scene, Omega);
      scene.measure(random);
      Pose guess = nearby(scene.pose, random);
      if (prior) {
        guess = scene.pose;
        for (int a = 0; a < 2; ++a) guess.position[a] += sigma[a] * normal(random);
        guess.yaw += sigma[2] * normal(random);
      }
      const auto found = scene.find_surely(guess, 8, Omega);
      if (!found) continue;
      ++found_count;
      const Pose& pose = found->pose;
      const Eigen::Vector3d e(pose.position.x() - scene.pose.position.x(),
                              pose.position.y() - scene.pose.position.y(),
                              pose.yaw - scene.pose.yaw);
      sum += e.dot(C.ldlt().solve(e));
      told += e.dot(found->covariance.ldlt().solve(e));
      square += e.head<2>().squaredNorm();
    }
    EXPECT_GT(found_count, kTrials * 99 / 100);
    const double mean = sum / found_count, rms = std::sqrt(square / found_count);
    RecordProperty("normalized_square", std::to_string(mean));
    RecordProperty("rms_m", std::to_string(rms));
    // Chi-squared with 3 degrees of freedom; its mean over the trials has a deviation of 0.1.
    EXPECT_GT(mean, 2.6);
    EXPECT_LT(mean, 3.5);
    // What it tells of itself counts the points that disagree for less.
    EXPECT_GT(told / found_count, 2.0);
    EXPECT_LT(told / found_count, 3.5);
    EXPECT_LT(rms, 0.03);
  }
}

// Few clustered landmarks that are themselves off say little about the pose; dead reckoning knows
// better. Without its knowledge such a fix is off by decimetres.
TEST(Relocalization, FewClusteredPointsDoNotThrowAwayWhatIsKnown) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Eigen::Vector3d sigma(0.02, 0.02, 0.01);
  const Eigen::Matrix3d Omega = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  double worst = 0.0, worst_without = 0.0;
  int found_count = 0;
  for (int n = 0; n < 300; ++n) {
    Scene scene(14, random_pose(random), random, 4.0);
    for (FeatureObservation& o : scene.observations) {
      o.u = 300.0 + 20.0 * normal(random);
      o.disparity = scene.stereo.left.fx * scene.stereo.baseline / (4.0 + 0.1 * normal(random));
      o.true_point = scene.stereo.triangulate(o.u, o.v, o.disparity);
      Landmark& l = scene.landmarks[o.feature];
      l.position = camera_pose(scene.pose, scene.mount) * o.true_point;
      for (int a = 0; a < 3; ++a) l.position[a] += 0.02 * normal(random);
      l.covariance = 4e-4 * Eigen::Matrix3d::Identity();
      const Eigen::Vector3d to_eye =
          camera_pose(scene.pose, scene.mount).translation() - l.position;
      l.creation_range = to_eye.norm();
      l.creation_direction = to_eye.normalized();
    }
    scene.measure(random);
    Pose guess = scene.pose;
    for (int a = 0; a < 2; ++a) guess.position[a] += sigma[a] * normal(random);
    guess.yaw += sigma[2] * normal(random);
    if (const auto found = scene.find(guess, 8, Omega)) {
      ++found_count;
      worst = std::max(worst, distance(*found, scene.pose));
    }
    if (const auto found = scene.find(guess, 8)) {
      worst_without = std::max(worst_without, distance(*found, scene.pose));
    }
  }
  EXPECT_GT(found_count, 290);
  EXPECT_LT(worst, 5.0 * sigma[0]);
  EXPECT_GT(worst_without, 0.2);
}

TEST(Relocalization, APoseFartherThanItCanHaveDriftedIsRefused) {
  std::mt19937_64 random(10);
  const Scene scene(60, random_pose(random), random, 4.0);
  const Eigen::Matrix3d Omega = Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal();  // 1 cm, 10 mrad
  Pose guess = scene.pose;
  guess.position.x() += 0.03;
  EXPECT_TRUE(scene.find(guess, 12, Omega));
  guess.position.x() += 0.15;
  EXPECT_FALSE(scene.find(guess, 12, Omega));
  EXPECT_TRUE(scene.find(guess));
}

TEST(Relocalization, AThirdOfWrongMatchesDoesNotMoveIt) {
  std::mt19937_64 random(3);
  double square = 0.0, right_square = 0.0;
  constexpr int kTrials = 200;
  for (int n = 0; n < kTrials; ++n) {
    Scene scene(100, random_pose(random), random, 4.0);
    scene.measure(random);
    const Pose guess = nearby(scene.pose, random);
    const auto right = scene.find(guess);
    ASSERT_TRUE(right);
    right_square += std::pow(distance(*right, scene.pose), 2);
    // The first thirty are each taken for the next one: as recognisable, but elsewhere.
    const Landmark first = scene.landmarks[scene.observations[0].feature];
    for (std::size_t m = 0; m < 30; ++m) {
      scene.landmarks[scene.observations[m].feature] =
          m + 1 < 30 ? scene.landmarks[scene.observations[m + 1].feature] : first;
    }
    const auto found = scene.find(guess);
    ASSERT_TRUE(found);
    square += std::pow(distance(*found, scene.pose), 2);
    EXPECT_LT(distance(*found, scene.pose), 0.15);
    EXPECT_NEAR(found->yaw, scene.pose.yaw, 0.06);
  }
  RecordProperty("rms_m", std::to_string(std::sqrt(square / kTrials)));
  RecordProperty("rms_without_m", std::to_string(std::sqrt(right_square / kTrials)));
  EXPECT_LT(std::sqrt(square / kTrials), 0.06);
}

TEST(Relocalization, NothingButWrongMatchesGiveNothing) {
  std::mt19937_64 random(4);
  for (int n = 0; n < 100; ++n) {
    Scene scene(40, random_pose(random), random);
    std::vector<Landmark> all;
    for (const auto& [id, l] : scene.landmarks) all.push_back(l);
    std::shuffle(all.begin(), all.end(), random);
    std::size_t k = 0;
    for (auto& [id, l] : scene.landmarks) l = all[k++];
    EXPECT_FALSE(scene.find(scene.pose)) << n;
  }
}

TEST(Relocalization, TooFewMatchesGiveNothing) {
  std::mt19937_64 random(5);
  const Pose pose = random_pose(random);
  for (int count = 0; count < 30; ++count) {
    const Scene scene(count, pose, random);
    EXPECT_EQ(scene.find(pose).has_value(), count >= 12) << count;
    EXPECT_EQ(scene.find(pose, 20).has_value(), count >= 20) << count;
  }
  // Features that the map does not know do not count.
  Scene scene(40, pose, random);
  while (scene.landmarks.size() > 12) scene.landmarks.erase(scene.landmarks.begin());
  EXPECT_TRUE(scene.find(pose));
  scene.landmarks.erase(scene.landmarks.begin());
  EXPECT_FALSE(scene.find(pose));
}

TEST(Relocalization, ViewsTooDifferentGiveNothing) {
  std::mt19937_64 random(6);
  const Pose pose = random_pose(random);
  const auto with = [&](double turn, double scale) {
    std::mt19937_64 same(7);
    Scene scene(40, pose, same);
    for (auto& [id, l] : scene.landmarks) {
      const Eigen::Vector3d axis = l.creation_direction.unitOrthogonal();
      l.creation_direction = Eigen::AngleAxisd(turn, axis) * l.creation_direction;
      l.creation_range *= scale;
    }
    return scene.find(pose).has_value();
  };
  for (const double turn : {0.0, 0.3, 0.49}) EXPECT_TRUE(with(turn, 1.0)) << turn;
  for (const double turn : {0.51, 1.0, 2.0, M_PI}) EXPECT_FALSE(with(turn, 1.0)) << turn;
  for (const double scale : {1.49, 1.0 / 1.49}) EXPECT_TRUE(with(0.0, scale)) << scale;
  for (const double scale : {1.51, 1.0 / 1.51, 10.0}) EXPECT_FALSE(with(0.0, scale)) << scale;
}

TEST(Relocalization, NonPositiveDisparitiesAndDegenerateLandmarksDoNotCount) {
  std::mt19937_64 random(8);
  const Pose pose = random_pose(random);
  Scene scene(40, pose, random);
  const double bad[] = {0.0, -3.0, std::nan(""), -std::numeric_limits<double>::infinity()};
  for (std::size_t n = 0; n < 24; ++n) scene.observations[n].disparity = bad[n % 4];
  // A landmark in the very place of the camera has no direction.
  for (std::size_t n = 24; n < 28; ++n) {
    scene.landmarks[scene.observations[n].feature].position =
        camera_pose(pose, scene.mount).translation();
  }
  const auto found = scene.find(pose);
  ASSERT_TRUE(found) << "twelve are left";
  EXPECT_LT(distance(*found, pose), 1e-9);
  EXPECT_NEAR(found->yaw, pose.yaw, 1e-9);
  scene.observations[39].disparity = 0.0;
  EXPECT_FALSE(scene.find(pose));
}

}  // namespace
}  // namespace prospect::relocalization_test
