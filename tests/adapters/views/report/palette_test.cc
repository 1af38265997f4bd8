// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/palette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace prospect::palette_test {
namespace {

double luminance(Color c) {
  const auto linear = [](std::uint8_t v) {
    const double s = v / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}

TEST(Palette, TheScaleGrowsLighterAndStaysReadableOnWhite) {
  double last = -1.0;
  for (int i = 0; i <= 100; ++i) {
    const double now = luminance(color_on_white(0.01 * i));
    EXPECT_GE(now, last - 1e-3) << i;
    EXPECT_LT(now, 0.56) << i;  // of white's 1
    last = now;
  }
  EXPECT_EQ(hex(color_on_white(0.0)), "#440154");
  EXPECT_EQ(color_on_white(-3.0), color_on_white(0.0));
  EXPECT_EQ(color_on_white(std::nan("")), color_on_white(0.0));
  EXPECT_EQ(color_on_white(7.0), color_on_white(1.0));
  EXPECT_EQ(color_on_white(HUGE_VAL), color_on_white(1.0));
}

TEST(Palette, EachModeHasItsOwnColourAndKeepsIt) {
  const std::vector<std::string> modes = {"explore", "approach",         "look around", "retreat",
                                          "done",    "turn on the spot", "fly home",    ""};
  std::set<std::string> seen;
  for (const Color& c : mode_colors(modes)) {
    EXPECT_TRUE(seen.insert(hex(c)).second) << hex(c);
    EXPECT_LT(luminance(c), 0.2) << hex(c) << ": white words stand on it";
  }
  EXPECT_EQ(mode_colors({"hover", "retreat"})[1], mode_colors({"retreat"})[0]);
  EXPECT_EQ(mode_colors(std::vector<std::string>(50, "unheard of")).size(), 50U);
}

TEST(Palette, OnePeakDoesNotStretchAScale) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  EXPECT_EQ(scale_end(values), 98.0);
  values.push_back(1e9);
  EXPECT_EQ(scale_end(values), 99.0);
  EXPECT_EQ(scale_end({std::nan(""), HUGE_VAL, 2.0}), 2.0);
  EXPECT_EQ(scale_end({}), 1.0);
  EXPECT_EQ(scale_end({0.0, 0.0}), 1.0);
}

}  // namespace
}  // namespace prospect::palette_test
