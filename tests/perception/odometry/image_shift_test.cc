// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

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

TEST(ImageShift, OfAPart) {
  // The left half has moved by 4 pixels, the right one not at all.
  const RenderedRoom room;
  const ImagePyramid pyramid(
      room.render(StereoCamera().left, RenderedRoom::looking(0.2, 0.1, 1.1, 0.3), 2.0, 1).view(),
      5);
  const PyramidLevel& from = pyramid.level(4);
  PyramidLevel to = from;
  std::vector<char> left(static_cast<std::size_t>(from.width) * from.height, 0), right = left;
  for (int v = 0; v < from.height; ++v) {
    for (int u = 0; u < from.width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * from.width + u;
      (2 * u < from.width ? left : right)[i] = 1;
      if (2 * u < from.width && u >= 4)
        to.pixels[static_cast<Eigen::Index>(i)] = from.row(v)[u - 4];
    }
  }
  // What the moved half covers of the other one does not count.
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (static_cast<int>(i) % from.width >= from.width / 2 - 4) left[i] = 0;
  }
  const auto moved = image_shift(from, to, 0.4, left), rests = image_shift(from, to, 0.4, right);
  ASSERT_TRUE(moved && rests);
  EXPECT_EQ(*moved, Eigen::Vector2d(4, 0));
  EXPECT_EQ(*rests, Eigen::Vector2d(0, 0));
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
