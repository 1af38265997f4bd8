// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_shift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/perception/rendered_room.h"

namespace prospect::image_shift_test {
namespace {

using test::RenderedRoom;

TEST(ImageShift, FindsATurn) {
  // Turned by 12 degrees to the left and moved by 3 cm: all shifts to the right by about f tan 12.
  const StereoCamera camera;
  const RenderedRoom room;
  const double turn = 12.0 * M_PI / 180.0;
  const ImagePyramid before(
      room.render(camera.left, RenderedRoom::looking(0.2, 0.1, 1.1, 0.3), 2.0, 1).view(), 5);
  const ImagePyramid after(
      room.render(camera.left, RenderedRoom::looking(0.23, 0.1, 1.1, 0.3 + turn), 2.0, 2).view(),
      5);
  const auto shift = image_shift(before.level(4), after.level(4));
  ASSERT_TRUE(shift.has_value());
  EXPECT_NEAR(16.0 * shift->x(), camera.left.fx * std::tan(turn), 16.0);
  EXPECT_NEAR(16.0 * shift->y(), 0.0, 16.0);
}

TEST(ImageShift, SaysNothingWithoutTexture) {
  const ImagePyramid blank(Image(320, 240, 90).view(), 4);
  EXPECT_FALSE(image_shift(blank.level(3), blank.level(3)).has_value());
  const ImagePyramid small(Image(160, 120, 90).view(), 3);
  EXPECT_FALSE(image_shift(blank.level(2), small.level(2)).has_value());
  EXPECT_FALSE(image_shift(PyramidLevel{}, PyramidLevel{}).has_value());
}

}  // namespace
}  // namespace prospect::image_shift_test
