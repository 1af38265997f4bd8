// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/perception/rendered_room.h"

namespace prospect::stereo_check_test {
namespace {

using test::RenderedRoom;
using ::testing::HasSubstr;

class StereoCheckTest : public ::testing::Test {
 protected:
  StereoCheckTest() {
    StereoCamera camera;
    camera.left = {300.0, 300.0, 200.0, 150.0, 400.0, 300.0};
    pair_ = RenderedRoom().render(camera, RenderedRoom::looking(0.4, 0.2, 1.1, 0.3), 2.0, 5);
  }
  Image moved_down(const Image& image, int rows) const {
    Image out = image;
    for (int v = rows; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) out.at(u, v) = image.at(u, v - rows);
    }
    return out;
  }
  RenderedRoom::Pair pair_;
};

TEST_F(StereoCheckTest, ARectifiedPairPasses) {
  const StereoCheck check = check_stereo(pair_.left.view(), pair_.right.view());
  EXPECT_GT(check.matches, 50);
  EXPECT_LT(check.matches_swapped, check.matches / 5);
  EXPECT_EQ(check.row_shift, 0);
  EXPECT_LT(std::abs(check.row_error), 0.05);
  EXPECT_EQ(stereo_complaint(check), "");
}

TEST_F(StereoCheckTest, NamesWhatIsWrong) {
  EXPECT_THAT(stereo_complaint(check_stereo(pair_.right.view(), pair_.left.view())),
              HasSubstr("exchanged"));
  const Image lower = moved_down(pair_.right, 4);
  const StereoCheck check = check_stereo(pair_.left.view(), lower.view());
  EXPECT_EQ(check.row_shift, 4);
  EXPECT_THAT(stereo_complaint(check), HasSubstr("fits 4 px higher"));
  EXPECT_THAT(stereo_complaint(check_stereo(moved_down(pair_.left, 4).view(), pair_.right.view())),
              HasSubstr("fits 4 px lower"));
}

TEST_F(StereoCheckTest, WithoutTextureItSaysNothing) {
  const Image blank(400, 300, 80);
  EXPECT_EQ(stereo_complaint(check_stereo(blank.view(), blank.view())), "");
  EXPECT_THROW(check_stereo(blank.view(), Image(40, 30).view()), std::invalid_argument);
  EXPECT_THROW(check_stereo(ImageView{}, ImageView{}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::stereo_check_test
