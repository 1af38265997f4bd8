// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_samples.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "perception/odometry/image_pyramid.h"

namespace prospect::patch_samples_test {
namespace {

constexpr int kHalf = 2, kSide = 2 * kHalf + 1;

/// Grey values with a mixed term, of which bilinear samples are exact: f(u, v) = 3 + 2 u - v + u v.
float grey(float u, float v) { return 3.0f + 2.0f * u - v + u * v; }

PyramidLevel level(int width, int height) {
  PyramidLevel level;
  level.width = width;
  level.height = height;
  level.pixels.resize(width * height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      level.pixels[v * width + u] = grey(static_cast<float>(u), static_cast<float>(v));
    }
  }
  return level;
}

void expect_samples(const PyramidLevel& image, const Eigen::Vector2f& c, const Eigen::Matrix2f& A) {
  const auto samples = sample_square<kHalf>(image, c, A);
  for (int y = -kHalf; y <= kHalf; ++y) {
    for (int x = -kHalf; x <= kHalf; ++x) {
      const Eigen::Vector2f p =
          c + A * Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
      EXPECT_NEAR(samples[(y + kHalf) * kSide + x + kHalf], grey(p.x(), p.y()), 2e-4f)
          << "at " << p.transpose();
    }
  }
}

TEST(PatchSamples, AreBilinearAtTheWarpedOffsetsRowByRow) {
  const PyramidLevel image = level(19, 13);
  Eigen::Matrix2f A;
  A << 1.3f, -0.4f, 0.2f, 0.9f;
  expect_samples(image, {8.25f, 6.5f}, A);
  expect_samples(image, {9.0f, 6.0f}, Eigen::Matrix2f::Identity());
}

TEST(PatchSamples, ReachTheBordersOfTheImage) {
  const PyramidLevel image = level(11, 9);
  const Eigen::Matrix2f I = Eigen::Matrix2f::Identity();
  expect_samples(image, {2.0f, 2.0f}, I);
  // Up to the last column and row, as a corner may round to them.
  expect_samples(image, {8.0f, 6.0f}, I);
}

TEST(PatchSamples, AreFiniteBeyondTheSquareToo) {
  const auto samples =
      sample_square<kHalf>(level(11, 9), {5.5f, 4.5f}, Eigen::Matrix2f::Identity());
  EXPECT_EQ(samples.size() % 4, 0);
  for (Eigen::Index k = kSide * kSide; k < samples.size(); ++k) {
    EXPECT_FLOAT_EQ(samples[k], grey(5.5f, 4.5f));
  }
}

}  // namespace
}  // namespace prospect::patch_samples_test
