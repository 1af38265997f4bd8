// SPDX-License-Identifier: Apache-2.0
#include "perception/places/stereo_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/perception/rendered_room.h"

namespace prospect::stereo_view_test {
namespace {

StereoCamera camera() {
  StereoCamera camera;
  camera.left = {330.0, 330.0, 239.5, 179.5, 480.0, 360.0};
  return camera;
}

TEST(StereoView, DepthsAreThoseOfTheSurfaces) {
  const test::RenderedRoom room;
  const Eigen::Isometry3d T_WC = test::RenderedRoom::looking(-1.0, 0.2, 1.05, 0.1);
  const auto pair = room.render(camera(), T_WC, 2.0, 1);
  const StereoView view = stereo_view(camera(), pair.left.view(), pair.right.view());
  int with_depth = 0, wrong = 0;
  double squares = 0.0;
  for (const StereoView::Point& p : view.points) {
    if (!p.has_depth()) continue;
    ++with_depth;
    const double truth = camera().left.fx * camera().baseline /
                         room.depth(camera().left, T_WC, p.pixel.x(), p.pixel.y());
    if (std::abs(p.disparity - truth) > 1.0)
      ++wrong;  // at the pillar's edges
    else
      squares += (p.disparity - truth) * (p.disparity - truth);
  }
  EXPECT_GT(with_depth, 150);
  EXPECT_LE(20 * wrong, with_depth);
  EXPECT_LT(std::sqrt(squares / with_depth), 0.25);  // [px]
}

TEST(StereoView, NothingWithoutTexture) {
  const Image grey(480, 360, 120);
  EXPECT_TRUE(stereo_view(camera(), grey.view(), grey.view()).points.empty());
}

TEST(StereoView, RefusesOtherSizes) {
  const Image grey(480, 360, 120), small(320, 240, 120);
  EXPECT_THROW(stereo_view(camera(), grey.view(), small.view()), std::invalid_argument);
  EXPECT_THROW(stereo_view(camera(), {}, grey.view()), std::invalid_argument);
}

TEST(StereoView, DistanceCountsBits) {
  ViewDescriptor a = {1, 2, 4, ~std::uint64_t{0}}, b = {};
  EXPECT_EQ(distance(a, b), 67);
  EXPECT_EQ(distance(a, a), 0);
  StereoView view;
  view.points.resize(3);
  view.points[1].descriptor = a;
  view.points[2].descriptor = {3, 2, 4, 0};
  std::int16_t bits[3];
  distances(a, view, bits);
  EXPECT_EQ(bits[0], 67);
  EXPECT_EQ(bits[1], 0);
  EXPECT_EQ(bits[2], 65);
}

}  // namespace
}  // namespace prospect::stereo_view_test
