// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/depth_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "perception/odometry/corner_detector.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/stereo_matcher.h"
#include "tests/perception/rendered_room.h"

namespace prospect::depth_agreement_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Verdict = ScaleAgreement::Verdict;

/// A stereo pair and a depth camera 0.2 m beside, 0.1 m ahead and above of it, turned by 6 degrees,
/// in the rendered room.
struct TwoCameras {
  StereoCamera stereo;
  PinholeCamera depth_camera{220.0, 220.0, 159.5, 119.5, 320.0, 240.0};
  Isometry3d T_WC;
  Isometry3d T_CD = Isometry3d::Identity();
  test::RenderedRoom room;
  test::RenderedRoom::Pair pair;
  DepthImage depth{320, 240};

  explicit TwoCameras(double yaw = 0.15)
      : T_WC(test::RenderedRoom::looking(-1.2, -0.3, 1.05, yaw)) {
    stereo.left = {330.0, 330.0, 240.0, 180.0, 480.0, 360.0};
    stereo.baseline = 0.12;
    T_CD.linear() = Eigen::AngleAxisd(0.1, Vector3d::UnitY()).toRotationMatrix();
    T_CD.translation() << 0.2, -0.1, 0.1;
    pair = room.render(stereo, T_WC, 2.0, 3);
    std::mt19937_64 rng(4);
    std::normal_distribution<double> normal;
    for (int v = 0; v < depth.height; ++v) {
      for (int u = 0; u < depth.width; ++u) {
        const double z = room.depth(depth_camera, T_WC * T_CD, u, v);
        depth.at(u, v) = static_cast<float>(z + (0.0015 + 0.0016 * z * z) * normal(rng));
      }
    }
  }

  /// What the pair sees if its calibration is off by these factors.
  ScaleAgreement agreement(double focal, double baseline, const DepthImage& image) const {
    StereoCamera believed = stereo;
    believed.left.fx *= focal;
    believed.left.fy *= focal;
    believed.baseline *= baseline;
    const auto corners = detect_corners(pair.left.view());
    std::vector<Vector3d> points;
    for (const StereoMatch& m : match_stereo(ImagePyramid(pair.left.view(), 1),
                                             ImagePyramid(pair.right.view(), 1), corners)) {
      const Eigen::Vector2f p = corners[m.index];
      points.push_back(believed.triangulate(p.x(), p.y(), m.disparity));
    }
    return depth_agreement(points, 0.3 / (believed.left.fx * believed.baseline), depth_camera, T_CD,
                           image);
  }
};

constexpr double kFactors[] = {0.5, 0.8, 0.9, 1.1, 1.25, 1.5, 2.0};

TEST(DepthAgreement, FindsAWrongBaselineInOnePairOfImages) {
  for (const double yaw : {0.15, 1.2, 3.0, -2.0}) {
    const TwoCameras cameras(yaw);
    const ScaleAgreement right = cameras.agreement(1.0, 1.0, cameras.depth);
    std::printf("yaw %.2f: %.4f +- %.4f, %d samples\n", yaw, right.ratio, right.sigma,
                right.samples);
    EXPECT_EQ(right.verdict, Verdict::kAgree);
    EXPECT_NEAR(right.ratio, 1.0, 0.01);
    EXPECT_GT(right.samples, 60);
    for (const double factor : kFactors) {
      const ScaleAgreement wrong = cameras.agreement(1.0, factor, cameras.depth);
      EXPECT_NEAR(wrong.ratio, factor, 0.05 * factor) << yaw;
      // A disparity's zero that is off by 0.3 px would explain a tenth of the depth.
      if (std::abs(std::log(factor)) > 0.2) {
        EXPECT_EQ(wrong.verdict, Verdict::kDisagree) << yaw << " " << factor;
      }
    }
  }
}

TEST(DepthAgreement, FindsAWrongFocalLengthBeforeAWallAndHardlyAlongOne) {
  const TwoCameras wall(3.14), along(0.15);
  for (const double factor : kFactors) {
    const ScaleAgreement before = wall.agreement(factor, 1.0, wall.depth);
    const ScaleAgreement beside = along.agreement(factor, 1.0, along.depth);
    std::printf("focal length times %.2f: %.3f +- %.3f before a wall, %.3f +- %.3f along walls\n",
                factor, before.ratio, before.sigma, beside.ratio, beside.sigma);
    EXPECT_NEAR(before.ratio, factor, 0.05 * factor);
    if (std::abs(std::log(factor)) > 0.2) {
      EXPECT_EQ(before.verdict, Verdict::kDisagree) << factor;
    }
  }
}

TEST(DepthAgreement, SaysNothingWithoutDepths) {
  const TwoCameras cameras;
  EXPECT_EQ(cameras.agreement(1.0, 1.5, DepthImage(320, 240)).verdict, Verdict::kUnknown);
  EXPECT_EQ(cameras.agreement(1.0, 1.5, DepthImage(320, 240, 0.0f)).samples, 0);
  EXPECT_EQ(cameras.agreement(1.0, 1.5, DepthImage()).samples, 0);
  DepthImage sparse = cameras.depth;
  // Noise instead of depths has no smooth surfaces.
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<float> uniform(0.3f, 8.0f);
  for (float& z : sparse.depth) z = uniform(rng);
  EXPECT_EQ(cameras.agreement(1.0, 1.0, sparse).verdict, Verdict::kUnknown);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(depth_agreement({{nan, 0, 1}, {0, 0, -1}, {0, 0, 0}}, 0.0, cameras.depth_camera,
                            cameras.T_CD, cameras.depth)
                .samples,
            0);
}

}  // namespace
}  // namespace prospect::depth_agreement_test
