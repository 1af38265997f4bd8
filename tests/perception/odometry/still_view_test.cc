// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/still_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "models/image.h"
#include "perception/odometry/image_pyramid.h"
#include "tests/perception/rendered_room.h"

namespace prospect::still_view_test {
namespace {

using test::RenderedRoom;

PyramidLevel quarter(const Image& image) { return ImagePyramid(image.view(), 3).level(2); }

Image room(double x, std::uint64_t seed) {
  return RenderedRoom().render(StereoCamera().left, RenderedRoom::looking(x, 0.1, 1.1, 0.3), 2.0,
                               seed);
}

/// The part of `from` on the right of column u, over `to`.
Image with_right_part(Image to, const Image& from, int u) {
  for (int v = 0; v < to.height; ++v) {
    for (int k = u; k < to.width; ++k) to.at(k, v) = from.at(k, v);
  }
  return to;
}

TEST(StillView, ARobotAtRestSeesNoChange) {
  const Image before = room(0.2, 1);
  Image now = room(0.2, 2);
  EXPECT_EQ(still_view(quarter(before), quarter(now)).changed, 0);
  // Nor by another exposure.
  for (std::uint8_t& grey : now.pixels) grey = static_cast<std::uint8_t>(0.5 * grey + 10);
  const StillView view = still_view(quarter(before), quarter(now));
  EXPECT_EQ(view.changed, 0);
  EXPECT_GT(view.still, 30);
  EXPECT_FALSE(view.moves(false));
}

TEST(StillView, WhatIsCarriedIsNotAViewAtRest) {
  // On the right a board that is the same in both.
  const Image board = room(-1.0, 3);
  const int u = board.width / 2;
  const StillView view = still_view(quarter(with_right_part(room(0.2, 1), board, u)),
                                    quarter(with_right_part(room(0.35, 2), board, u)));
  EXPECT_GE(view.still, 20);
  EXPECT_TRUE(view.moves(false)) << view.still << " " << view.changed;
  // In the edge of the view something small passes.
  const Image before = room(0.2, 1);
  const StillView passing =
      still_view(quarter(before), quarter(with_right_part(room(0.2, 2), board, 15 * u / 8)));
  EXPECT_FALSE(passing.moves(false)) << passing.still << " " << passing.changed;
  // After that it is the same, or it is not.
  EXPECT_TRUE((StillView{40, 2}.moves(true)));
  EXPECT_FALSE((StillView{40, 1}.moves(true)));
}

TEST(StillView, SaysNothingWithoutContrast) {
  const PyramidLevel blank = quarter(Image(320, 240, 90)), other = quarter(Image(160, 120, 90));
  for (const StillView& view : {still_view(blank, blank), still_view(blank, other),
                                still_view(PyramidLevel{}, PyramidLevel{})}) {
    EXPECT_EQ(view.still, 0);
    EXPECT_EQ(view.changed, 0);
  }
}

}  // namespace
}  // namespace prospect::still_view_test
