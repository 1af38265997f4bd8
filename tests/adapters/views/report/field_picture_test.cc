// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/field_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/images/image_file.h"

namespace prospect::field_picture_test {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

TEST(FieldPicture, APixelIsACellWhereThereAreFew) {
  CostToGoPicture field;
  field.frame = {0.1, -3, 7, 3, 2};
  field.seconds = {0.0F,  5.0F,  10.0F,  // the lower row
                   kNone, -1.0F, 2.5F};
  const FieldPicture picture = field_picture(field);
  EXPECT_EQ(picture.frame, field.frame);
  EXPECT_EQ(picture.most, 10.0);
  const cv::Mat image = test::decoded(picture.png, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC1);
  ASSERT_EQ(image.cols, 3);
  ASSERT_EQ(image.rows, 2);
  const int expected[2][3] = {{0, 0, 65}, {1, 128, 255}};  // 1 + 254 s / 10, the upper row first
  for (int v = 0; v < 2; ++v) {
    for (int u = 0; u < 3; ++u) {
      EXPECT_NEAR(image.at<std::uint8_t>(v, u), expected[v][u], 0.5) << u << ' ' << v;
    }
  }
}

TEST(FieldPicture, ManyCellsShareAPixelThatHasTheLowestValue) {
  CostToGoPicture field;
  field.frame = {0.1, -5, -5, 10, 10};  // blocks of 2 begin at even cells: 6 by 6
  field.seconds.assign(100, 4.0F);
  field.seconds[static_cast<std::size_t>(field.frame.index({-3, 2}))] = 1.0F;
  field.seconds[static_cast<std::size_t>(field.frame.index({0, 0}))] = kNone;
  const FieldPicture picture = field_picture(field, 40);
  EXPECT_EQ(picture.frame, (GridFrame{0.2, -3, -3, 6, 6}));
  const cv::Mat image = test::decoded(picture.png, cv::IMREAD_UNCHANGED);
  const auto at = [&](int i, int j) { return image.at<std::uint8_t>(5 - (j + 3), i + 3); };
  EXPECT_EQ(at(-2, 1), 65);  // 1 + 254 / 4, rounded
  EXPECT_EQ(at(0, 0), 255) << "three of its four cells have a value";
  EXPECT_EQ(at(2, 2), 255);
}

TEST(FieldPicture, NothingIsNoPicture) {
  EXPECT_TRUE(field_picture({}).png.empty());
  CostToGoPicture field;
  field.frame = {0.1, 0, 0, 2, 2};
  field.seconds.assign(4, kNone);
  EXPECT_TRUE(field_picture(field).png.empty());
  field.seconds.resize(3);  // not as many as cells
  EXPECT_TRUE(field_picture(field).png.empty());
  field.seconds.assign(4, 0.0F);  // all at the target
  const cv::Mat at_target = test::decoded(field_picture(field).png, cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::countNonZero(at_target == 1), 4);
}

}  // namespace
}  // namespace prospect::field_picture_test
