// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>

#include "perception/odometry/patch_tracker.h"

namespace prospect::patch_alignment_test {
namespace {

/// A smooth, aperiodic texture, band-limited well below the pixel.
double texture(double x, double y) {
  return 120.0 + 25.0 * std::sin(0.31 * x + 0.12 * y) + 20.0 * std::sin(0.23 * y - 0.17 * x + 1.0) +
         18.0 * std::cos(0.41 * y + 0.05 * x * std::sin(0.01 * x)) +
         12.0 * std::sin(0.55 * x - 0.4 * y);
}

/// Random lattice values, smoothly interpolated, at four scales: no shift of it resembles it.
double random_texture(double x, double y) {
  double sum = 128.0;
  int octave = 0;
  for (double size = 48.0; size > 4.0; size *= 0.5, ++octave) {
    const double fx = std::floor(x / size), fy = std::floor(y / size);
    const auto value = [&](int i, int j) {
      std::uint32_t h = static_cast<std::uint32_t>(static_cast<int>(fx) + i) * 73856093u ^
                        static_cast<std::uint32_t>(static_cast<int>(fy) + j) * 19349663u ^
                        static_cast<std::uint32_t>(octave) * 83492791u;
      h = (h ^ h >> 15) * 2246822519u;
      h = (h ^ h >> 13) * 3266489917u;
      return (h ^ h >> 16) / 4294967295.0 - 0.5;
    };
    double a = x / size - fx, b = y / size - fy;
    a = a * a * (3 - 2 * a);
    b = b * b * (3 - 2 * b);
    sum += 60.0 * ((1 - b) * ((1 - a) * value(0, 0) + a * value(1, 0)) +
                   b * ((1 - a) * value(0, 1) + a * value(1, 1)));
  }
  return sum;
}

Image image_of(const std::function<double(double, double)>& f, int width = 160, int height = 120) {
  Image image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      image.at(u, v) =
          static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, f(u, v)))));
    }
  }
  return image;
}

const Eigen::Matrix2f kSame = Eigen::Matrix2f::Identity();

TEST(PatchAlignment, FindsSubpixelShiftsUnderGainAndOffset) {
  const ImagePyramid first(image_of(texture).view(), 1);
  for (const double dx : {-2.3, -0.5, 0.0, 0.25, 1.7}) {
    for (const double dy : {-1.2, 0.4}) {
      const ImagePyramid second(
          image_of([&](double x, double y) { return 0.7 * texture(x - dx, y - dy) + 30.0; }).view(),
          1);
      for (const Eigen::Vector2f& c : {Eigen::Vector2f(60, 50), Eigen::Vector2f(90, 70)}) {
        const auto patch = Patch::make(first.level(0), c, kSame, 0.5f);
        ASSERT_TRUE(patch.has_value());
        const auto found = patch->align(second.level(0), c, 6.0f);
        ASSERT_TRUE(found.converged);
        EXPECT_NEAR(found.position.x() - c.x(), dx, 0.03);
        EXPECT_NEAR(found.position.y() - c.y(), dy, 0.03);
        EXPECT_NEAR(found.gain, 0.7, 0.02);
        EXPECT_GT(found.agreement, 0.99);
      }
    }
  }
}

TEST(PatchAlignment, TheWarpTakesOutAKnownChangeOfScaleAndRotation) {
  const ImagePyramid first(image_of(texture).view(), 1);
  // The second image shows the first turned by 0.2 rad and 1.3 times as large about c, then
  // shifted.
  const Eigen::Vector2d c(80, 60), shift(1.3, -0.6);
  Eigen::Matrix2d B = 1.3 * Eigen::Rotation2D<double>(0.2).toRotationMatrix();
  const Eigen::Matrix2d A = B.inverse();
  const ImagePyramid second(image_of([&](double x, double y) {
                              const Eigen::Vector2d p = c + A * (Eigen::Vector2d(x, y) - c - shift);
                              return texture(p.x(), p.y());
                            }).view(),
                            1);
  const auto patch = Patch::make(first.level(0), c.cast<float>(), A.cast<float>(), 0.5f);
  ASSERT_TRUE(patch.has_value());
  const auto found = patch->align(second.level(0), c.cast<float>(), 6.0f);
  ASSERT_TRUE(found.converged);
  EXPECT_LE((found.position.cast<double>() - c - shift).norm(), 0.04);
  EXPECT_GT(found.agreement, 0.99);
  // Without the warp the match is far worse, or none.
  const auto plain = Patch::make(first.level(0), c.cast<float>(), kSame, 0.5f);
  EXPECT_LT(plain->align(second.level(0), c.cast<float>(), 6.0f).agreement, 0.9);
}

TEST(PatchAlignment, AnEdgeOfStepsHoldsThePatchAndTheCovarianceSaysSo) {
  // The edge of something dark, coarsely sampled, moves by 2 px along itself: the image stays as it
  // is, and so does the patch, without a residual.
  const Eigen::Vector2f along = Eigen::Vector2f(1.0f, 0.4f).normalized();
  const ImagePyramid edge(image_of([](double x, double y) {
                            double sum = 0.0;
                            for (const double dx : {-0.25, 0.25}) {
                              for (const double dy : {-0.25, 0.25}) {
                                sum += y + dy - 60.0 > 0.4 * (x + dx - 80.0) ? 15.0 : 50.0;
                              }
                            }
                            return sum;
                          }).view(),
                          1);
  const Eigen::Vector2f c(80, 60);
  const auto on_edge = Patch::make(edge.level(0), c, kSame, 0.5f);
  ASSERT_TRUE(on_edge.has_value());  // its steps look like texture
  const auto held = on_edge->align(edge.level(0), c, 6.0f);
  ASSERT_TRUE(held.converged);
  EXPECT_GT((2.0f * along - (held.position - c)).norm(), 1.9f);
  EXPECT_GT(along.dot(held.covariance * along), 0.01f);
  // Texture in both directions is worth what it was.
  const ImagePyramid rich(image_of(random_texture).view(), 1);
  const auto on_texture = Patch::make(rich.level(0), c, kSame, 0.5f);
  ASSERT_TRUE(on_texture.has_value());
  const auto found = on_texture->align(rich.level(0), c, 6.0f);
  ASSERT_TRUE(found.converged);
  EXPECT_LT(found.covariance.trace(), 0.001f);
  std::printf("variance along an edge %.4f px^2, of texture %.6f px^2 in all\n",
              along.dot(held.covariance * along), found.covariance.trace());
}

TEST(PatchAlignment, TheCovarianceIsThatOfTheErrorsAndLongAlongAnEdge) {
  // An edge with little texture along it, under noise of two grey levels.
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  const auto noisy = [&] {
    return image_of(
        [&](double x, double y) {
          return 120.0 + 60.0 * std::tanh((x - 80.0) / 3.0) + 6.0 * std::sin(0.5 * y) +
                 2.0 * normal(generator);
        },
        160, 120);
  };
  Eigen::Matrix2f spread = Eigen::Matrix2f::Zero(), claimed = spread;
  constexpr int kDraws = 60;
  for (int draw = 0; draw < kDraws; ++draw) {
    const ImagePyramid from(noisy().view(), 1), to(noisy().view(), 1);
    const auto patch = Patch::make(from.level(0), {80.0f, 60.0f}, kSame, 0.5f);
    ASSERT_TRUE(patch);
    const Patch::Alignment found = patch->align(to.level(0), {80.0f, 60.0f}, 4.0f);
    ASSERT_TRUE(found.converged);
    const Eigen::Vector2f error = found.position - Eigen::Vector2f(80.0f, 60.0f);
    spread += error * error.transpose() / kDraws;
    claimed += found.covariance / kDraws;
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_GT(claimed(i, i), 0.4f * spread(i, i)) << i;
    EXPECT_LT(claimed(i, i), 2.5f * spread(i, i)) << i;
  }
  EXPECT_GT(claimed(1, 1), 5.0f * claimed(0, 0));
}

TEST(PatchAlignment, RefusesWhatDoesNotFixBothCoordinates) {
  const ImagePyramid blank(Image(160, 120, 77).view(), 1);
  EXPECT_FALSE(Patch::make(blank.level(0), {80, 60}, kSame, 0.5f).has_value());
  const ImagePyramid edge(
      image_of([](double x, double) { return 100.0 + 60.0 * std::tanh(0.3 * (x - 80.0)); }).view(),
      1);
  EXPECT_FALSE(Patch::make(edge.level(0), {80, 60}, kSame, 0.5f).has_value());
  const ImagePyramid good(image_of(texture).view(), 1);
  EXPECT_TRUE(Patch::make(good.level(0), {80, 60}, kSame, 0.5f).has_value());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector2f& c : {Eigen::Vector2f(3, 60), Eigen::Vector2f(157, 60),
                                   Eigen::Vector2f(nan, 60), Eigen::Vector2f(80, 1e30f)}) {
    EXPECT_FALSE(Patch::make(good.level(0), c, kSame, 0.5f).has_value());
  }
  const auto patch = Patch::make(good.level(0), {80, 60}, kSame, 0.5f);
  EXPECT_FALSE(patch->align(good.level(0), {nan, 60}, 6.0f).converged);
  EXPECT_FALSE(patch->align(good.level(0), {-5, 60}, 6.0f).converged);
  EXPECT_FALSE(patch->align(blank.level(0), {80, 60}, 6.0f).converged);
}

TEST(PatchTracker, PyramidsReachFarAndTheReturnRejectsWhatIsNotThere) {
  const auto& fine = random_texture;
  const ImagePyramid first(image_of(fine, 320, 240).view(), 4);
  const ImagePyramid second(
      image_of([&](double x, double y) { return fine(x - 17.4, y + 9.2); }, 320, 240).view(), 4);
  int tracked = 0, good = 0, total = 0;
  for (float v = 60; v < 190; v += 20) {
    for (float u = 60; u < 260; u += 20) {
      ++total;
      const auto result = track_patch(first, {u, v}, second, {{u, v}, kSame}, {3, 0}, true);
      if (result.outcome != TrackOutcome::kTracked) continue;
      ++tracked;
      good += (result.position - Eigen::Vector2f(u + 17.4f, v - 9.2f)).norm() < 0.1f;
    }
  }
  // The points are a lattice, not corners, and 20 px are far: many have nothing to hold on to.
  EXPECT_GE(good, 0.4 * total);
  EXPECT_GE(good, 0.9 * tracked);
  // An image that shows something else: whatever alignment settles on does not come back.
  const ImagePyramid other(
      image_of([](double x, double y) { return random_texture(y + 4000.0, x); }, 320, 240).view(),
      4);
  int wrong = 0;
  for (float v = 60; v < 190; v += 20) {
    for (float u = 60; u < 260; u += 20) {
      wrong += track_patch(first, {u, v}, other, {{u, v}, kSame}, {3, 0}, true).outcome ==
               TrackOutcome::kTracked;
    }
  }
  EXPECT_LE(wrong, total / 20);
}

TEST(PatchTracker, OnePatchForBothImages) {
  const ImagePyramid first(image_of(texture).view(), 1);
  const auto moved = [](double dx, double dy) {
    return ImagePyramid(
        image_of([=](double x, double y) { return texture(x - dx, y - dy); }).view(), 1);
  };
  const auto result = track_stereo_patch(first, {80, 60}, moved(1.3, 0.4), {{80, 60}, kSame},
                                         moved(-10.6, 0.4), {{68, 60}, kSame});
  ASSERT_EQ(result.left.outcome, TrackOutcome::kTracked);
  EXPECT_NEAR(result.left.position.x(), 81.3, 0.03);
  EXPECT_NEAR(result.left.position.y(), 60.4, 0.03);
  ASSERT_TRUE(result.in_right);
  EXPECT_NEAR(result.right.x(), 69.4, 0.03);
  // A right image without it.
  const ImagePyramid blank(Image(160, 120, 9).view(), 1);
  EXPECT_FALSE(track_stereo_patch(first, {80, 60}, moved(1.3, 0.4), {{80, 60}, kSame}, blank,
                                  {{68, 60}, kSame})
                   .in_right);
}

}  // namespace
}  // namespace prospect::patch_alignment_test
