// SPDX-License-Identifier: Apache-2.0
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

TEST(Drawing, APageMayHaveOtherColours) {
  const std::string svg = sample().svg({{"#ffffff", "var(--surface)"}, {"#0000c8", "teal"}});
  EXPECT_THAT(svg, HasSubstr("<rect width=\"100\" height=\"50\" fill=\"var(--surface)\"/>"));
  EXPECT_THAT(svg, HasSubstr("fill=\"teal\""));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#c80000\""));
  EXPECT_THAT(svg, testing::Not(HasSubstr("#ffffff")));
}

/// Where the table of a PDF says that its objects begin.
std::vector<std::size_t> object_places(const std::string& pdf) {
  std::vector<std::size_t> places;
  std::size_t at = std::stoul(pdf.substr(pdf.find("startxref\n") + 10));
  EXPECT_EQ(pdf.substr(at, 5), "xref\n");
  at = pdf.find(" f \n", at) + 4;
  for (; pdf.compare(at + 16, 4, " n \n") == 0; at += 20) {
    places.push_back(std::stoul(pdf.substr(at, 10)));
  }
  return places;
}

TEST(Drawing, ThePdfHoldsEachShapeAndItsTableLeadsToItsObjects) {
  const std::string pdf = sample().pdf();
  EXPECT_EQ(pdf.rfind("%PDF-1.4\n", 0), 0U);
  const std::vector<std::size_t> places = object_places(pdf);
  ASSERT_EQ(places.size(), 5U);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(pdf.compare(places[i], 8, std::to_string(i + 1) + " 0 obj\n"), 0) << i;
  }
  const std::size_t begin = pdf.find("stream\n") + 7, end = pdf.find("\nendstream");
  EXPECT_THAT(pdf, HasSubstr("/Length " + std::to_string(end - begin) + " "));
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [0 0 100 50 ]"));
  EXPECT_THAT(pdf, HasSubstr("0 0 0.784 rg\n10 10 20 10 re\n30 10 5 5 re\nf\n"));
  EXPECT_THAT(pdf, HasSubstr("2 w\n60 40 m\n90 40 l\nS\n"));
  // "a < b & c" in Helvetica: 556 + 278 + 584 + 278 + 556 + 278 + 667 + 278 + 500 thousandths of 6.
  EXPECT_THAT(pdf, HasSubstr("1 0 0 -1 38.08 48 Tm 0 Tr (a < b & c) Tj"));
  EXPECT_EQ(pdf, sample().pdf());
}

TEST(Drawing, ThePgfIsOfShapesInLatex) {
  const std::string pgf = sample().pgf();
  EXPECT_THAT(pgf, HasSubstr("\\begin{pgfpicture}%\n"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfpathrectangle{\\pgfpoint{10bp}{30bp}}{\\pgfpoint{20bp}{10bp}}"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfpathmoveto{\\pgfpoint{60bp}{10bp}}%\n\\pgfpathlineto"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfpathcircle{\\pgfpoint{50bp}{25bp}}{4bp}"));
  EXPECT_THAT(pgf, HasSubstr("a \\ensuremath{<} b \\& c"));
  Drawing words(10.0, 10.0);
  words.text("50 %_{x}~^\\#$", {0.0, 5.0}, 6.0, kRed);
  EXPECT_THAT(words.pgf(), HasSubstr("50 \\%\\_\\{x\\}\\textasciitilde{}\\textasciicircum{}"
                                     "\\textbackslash{}\\#\\$}"));
}

TEST(Drawing, NamesAreWholeWhereTheirLettersAre) {
  Drawing drawing(10.0, 10.0);
  drawing.text("caf\u00e9 (\u03a9)\xff\x01", {0.0, 5.0}, 6.0, kRed);
  EXPECT_THAT(drawing.svg(), HasSubstr(">caf\u00e9 (\u03a9)?"
                                       "?</text>"));
  EXPECT_THAT(drawing.pgf(), HasSubstr("caf\u00e9 (\u03a9)?"));
  EXPECT_THAT(drawing.pdf(), HasSubstr("(caf\xe9 \\(?\\)?"
                                       "?)"));
  EXPECT_EQ(Drawing::text_width("\u00e9", 6.0), Drawing::text_width("e", 6.0));
}

}  // namespace
}  // namespace prospect::drawing_test
