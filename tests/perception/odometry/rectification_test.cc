// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/rectification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace prospect::rectification_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A pair like EuRoC's, not quite parallel, on a body whose axes are not the cameras'.
CalibratedCamera camera(bool right) {
  CalibratedCamera c;
  c.pinhole = {229.0, 228.5, 121.0 + 3 * right, 82.0 - 2 * right, 240.0, 160.0};
  c.distortion = {-0.28, 0.07, 2e-4, -4e-5};
  Isometry3d T = Isometry3d::Identity();
  T.linear() = (AngleAxisd(M_PI / 2, Vector3d::UnitZ()) *
                AngleAxisd(right ? 0.02 : -0.01, Vector3d(0.3, 1, 0.2).normalized()))
                   .toRotationMatrix();
  T.translation() = Vector3d(0.02, right ? 0.05 : -0.06, 0.003);
  c.T_BC = T;
  return c;
}

TEST(Rectification, UndistortInvertsTheModel) {
  const CalibratedCamera c = camera(false);
  for (double u = 0; u < 240; u += 17) {
    for (double v = 0; v < 160; v += 13) {
      EXPECT_LE((project_distorted(c, undistort(c, {u, v})) - Vector2d(u, v)).norm(), 1e-8);
    }
  }
  // Barrel distortion draws inwards.
  CalibratedCamera barrel = c;
  barrel.distortion = {-0.2, 0, 0, 0};
  EXPECT_LT(project_distorted(barrel, {0.5, 0}).x(), 229.0 * 0.5 + 121.0);
}

TEST(Rectification, UndistortInvertsOtherLenses) {
  CalibratedCamera rational = camera(false);
  rational.distortion = {0.4, 0.05, 2e-4, -4e-5, 0.01, 0.7, 0.2, 0.02};
  CalibratedCamera fisheye = camera(false);
  fisheye.lens = Lens::kEquidistant;
  fisheye.distortion = {-0.02, 0.01, -0.004, 0.001};
  for (const CalibratedCamera& c : {rational, fisheye}) {
    for (double u = 0; u < 240; u += 17) {
      for (double v = 0; v < 160; v += 13) {
        EXPECT_LE((project_distorted(c, undistort(c, {u, v})) - Vector2d(u, v)).norm(), 1e-7);
      }
    }
  }
  // 229 px a radian: 0.5 rad aside is 114.5 px, less k1 and more.
  const double t = 0.5, k = 1 - 0.02 * t * t + 0.01 * std::pow(t, 4) - 0.004 * std::pow(t, 6) +
                            0.001 * std::pow(t, 8);
  EXPECT_NEAR(project_distorted(fisheye, {std::tan(t), 0.0}).x(), 121.0 + 229.0 * t * k, 1e-9);
}

TEST(Rectification, FisheyeThatSeesBehindItselfIsCutToAHundredDegrees) {
  CalibratedCamera pair[2] = {camera(false), camera(true)};
  for (CalibratedCamera& c : pair) {
    c.lens = Lens::kEquidistant;
    c.distortion = {};
    c.pinhole.fx = c.pinhole.fy = 70.0;  // 240 px are 196 degrees
  }
  const Rectification rectification(pair[0], pair[1]);
  const PinholeCamera& view = rectification.camera().left;
  EXPECT_NEAR(view.fx, 239.0 / (2.0 * std::tan(50.0 * M_PI / 180.0)), 1e-6);
  EXPECT_NEAR(view.cx, 119.5, 1e-6);
}

TEST(Rectification, RectifiedPixelsShowWhatTheRawOnesDid) {
  const CalibratedCamera raw[2] = {camera(false), camera(true)};
  const Rectification rectification(raw[0], raw[1]);
  const StereoCamera& stereo = rectification.camera();
  EXPECT_NEAR(stereo.baseline, 0.11, 1e-12);
  // Raw images whose grey value is a raw coordinate.
  Image columns(240, 160), rows(240, 160);
  for (int v = 0; v < 160; ++v) {
    for (int u = 0; u < 240; ++u) {
      columns.at(u, v) = static_cast<std::uint8_t>(u);
      rows.at(u, v) = static_cast<std::uint8_t>(v);
    }
  }
  const Image shown[2][2] = {
      {rectification.left(columns.view()), rectification.left(rows.view())},
      {rectification.right(columns.view()), rectification.right(rows.view())}};
  int points = 0;
  for (double z : {0.8, 2.0, 9.0}) {
    for (double u = 10; u < 230; u += 15) {
      for (double v = 10; v < 150; v += 15) {
        const double d = stereo.left.fx * stereo.baseline / z;
        if (u - d < 10) continue;
        const Vector3d in_left = stereo.triangulate(u, v, d);
        const Vector3d body = rectification.T_BC() * in_left;
        for (int i = 0; i < 2; ++i) {
          // Where the raw camera sees the point is what the rectified pixel must show.
          const Vector3d Y = raw[i].T_BC.inverse() * body;
          const Vector2d p = project_distorted(raw[i], Y.hnormalized());
          const int x = static_cast<int>(std::lround(i == 0 ? u : u - d));
          const double off = (i == 0 ? u : u - d) - x;  // rounded to a pixel
          EXPECT_NEAR(shown[i][0].at(x, static_cast<int>(v)), p.x() - off, 1.0);
          EXPECT_NEAR(shown[i][1].at(x, static_cast<int>(v)), p.y(), 1.0);
          ++points;
        }
      }
    }
  }
  EXPECT_GT(points, 400);
  // No border: every pixel has a source inside the raw image.
  for (int i = 0; i < 2; ++i) {
    for (const auto& [u, v] : {std::pair(0, 0), {239, 0}, {0, 159}, {239, 159}}) {
      const Vector3d ray =
          rectification.T_BC().linear() *
          Vector3d((u - stereo.left.cx) / stereo.left.fx, (v - stereo.left.cy) / stereo.left.fy, 1);
      const Vector2d p =
          project_distorted(raw[i], (raw[i].T_BC.linear().transpose() * ray).hnormalized());
      EXPECT_GT(p.x(), -1.0);
      EXPECT_LT(p.x(), 240.0);
      EXPECT_GT(p.y(), -1.0);
      EXPECT_LT(p.y(), 160.0);
    }
  }
}

TEST(Rectification, RefusesWhatIsNoStereoPair) {
  const CalibratedCamera left = camera(false), right = camera(true);
  EXPECT_NO_THROW(Rectification(left, right));
  EXPECT_THROW(Rectification(right, left), std::invalid_argument);  // exchanged
  EXPECT_THROW(Rectification(left, left), std::invalid_argument);   // no baseline
  CalibratedCamera above = left;
  above.T_BC.translation() += 0.1 * left.T_BC.linear().col(1);
  EXPECT_THROW(Rectification(left, above), std::invalid_argument);
  CalibratedCamera larger = right;
  larger.pinhole.width = 320;
  EXPECT_THROW(Rectification(left, larger), std::invalid_argument);
  CalibratedCamera back = right;
  back.T_BC.linear() = back.T_BC.linear() * AngleAxisd(M_PI, Vector3d::UnitY()).toRotationMatrix();
  EXPECT_THROW(Rectification(left, back), std::invalid_argument);
  CalibratedCamera endless = right;
  endless.distortion[2] = std::nan("");
  EXPECT_THROW(Rectification(left, endless), std::invalid_argument);
  CalibratedCamera flat = right;
  flat.pinhole.fy = 0.0;
  EXPECT_THROW(Rectification(left, flat), std::invalid_argument);
}

TEST(Rectification, RefusesImagesOfAnotherSize) {
  const Rectification rectification(camera(false), camera(true));
  const Image right_size(240, 160, 7), larger(320, 160, 7);
  const ImagePair pair = rectification.pair(right_size.view(), right_size.view());
  EXPECT_EQ(pair.left.pixels, right_size.pixels);
  EXPECT_EQ(pair.right.pixels, right_size.pixels);
  EXPECT_THROW(rectification.pair(larger.view(), right_size.view()), std::invalid_argument);
  EXPECT_THROW(rectification.pair(right_size.view(), larger.view()), std::invalid_argument);
  EXPECT_THROW(rectification.left({}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::rectification_test
