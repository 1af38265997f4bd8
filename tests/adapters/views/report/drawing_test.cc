#include "adapters/views/report/drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/images/image_file.h"

namespace prospect::drawing_test {
namespace {

using testing::HasSubstr;

constexpr Color kRed = {200, 0, 0}, kBlue = {0, 0, 200};

Drawing sample() {
  Drawing drawing(100.0, 50.0);
  drawing.rectangles({{10.0, 10.0, 20.0, 10.0}, {30.0, 10.0, 5.0, 5.0}}, kBlue);
  drawing.line({{60.0, 40.0}, {90.0, 40.0}}, kRed, 2.0);
  drawing.circle({50.0, 25.0}, 4.0, kBlue, kRed, 3.0);
  drawing.text("a < b & c", {50.0, 48.0}, 6.0, kRed, Drawing::Anchor::kCenter);
  return drawing;
}

cv::Mat image_of(const Drawing& drawing, double dots_per_inch) {
  return test::decoded(drawing.png(dots_per_inch), cv::IMREAD_COLOR);
}

TEST(Drawing, TheImageShowsShapesWhereTheyAre) {
  const cv::Mat image = image_of(sample(), 144.0);  // two pixels a point
  ASSERT_EQ(image.cols, 200);
  ASSERT_EQ(image.rows, 100);
  const auto at = [&](double x, double y) {
    const auto p = image.at<cv::Vec3b>(static_cast<int>(2.0 * y), static_cast<int>(2.0 * x));
    return Color{p[2], p[1], p[0]};
  };
  const Color white{255, 255, 255};
  EXPECT_EQ(at(2.0, 2.0), white);
  EXPECT_EQ(at(10.5, 10.5), kBlue);
  EXPECT_EQ(at(29.5, 19.5), kBlue);
  EXPECT_EQ(at(30.0, 12.0), kBlue) << "no seam between neighbours";
  EXPECT_EQ(at(30.5, 15.5), white);
  EXPECT_EQ(at(9.0, 12.0), white);
  EXPECT_EQ(at(75.0, 40.0), kRed);
  EXPECT_EQ(at(75.0, 43.0), white);
  EXPECT_EQ(at(50.0, 25.0), kBlue);
  EXPECT_EQ(at(54.0, 25.0), kRed);
  EXPECT_EQ(at(57.0, 25.0), white);
}

TEST(Drawing, WordsTakeTheRoomThatIsReckonedWithThem) {
  Drawing drawing(200.0, 20.0);
  const std::string words = "features in view, 0.25 m/s";
  drawing.text(words, {0.0, 15.0}, 8.0, {0, 0, 0});
  const cv::Mat image = image_of(drawing, 300.0);
  int last = 0;
  for (int u = 0; u < image.cols; ++u) {
    for (int v = 0; v < image.rows; ++v) {
      if (image.at<cv::Vec3b>(v, u)[0] < 128) last = u;
    }
  }
  const double width = last * 72.0 / 300.0;
  EXPECT_LT(width, Drawing::text_width(words, 8.0));
  EXPECT_GT(width, 0.7 * Drawing::text_width(words, 8.0));
}

TEST(Drawing, TheSvgIsSoundXml) {
  const std::string svg = sample().svg();
  EXPECT_THAT(svg, HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100pt\""));
  EXPECT_THAT(svg, HasSubstr(">a &lt; b &amp; c</text>"));
  EXPECT_THAT(svg, HasSubstr("points=\"60,40 90,40\""));
  EXPECT_THAT(svg, HasSubstr("M10 10h20v10h-20z"));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#c80000\""));
  EXPECT_EQ(svg, sample().svg());
  EXPECT_EQ(sample().png(), sample().png());
}

TEST(Drawing, WhatIsNoAsciiDoesNotBreakIt) {
  Drawing drawing(10.0, 10.0);
  drawing.text("\xff\x01 Ω", {0.0, 5.0}, 6.0, kRed);
  // In two parts, or the compiler sees a trigraph.
  EXPECT_THAT(drawing.svg(), HasSubstr(">?? ?"
                                       "?</text>"));
}

}  // namespace
}  // namespace prospect::drawing_test
