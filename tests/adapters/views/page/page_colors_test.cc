// SPDX-License-Identifier: Apache-2.0
// The colours of all pages: text against what is behind it as WCAG 2.1 asks for at level AA, and
// the map's lines and cells apart for who tells red from green and for who does not.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adapters/views/page/page_assets.h"
#include "adapters/views/report/palette.h"
#include "engine/behaviour/mode.h"

namespace prospect::page_colors_test {
namespace {

using Colors = std::map<std::string, Eigen::Vector3d>;  // linear RGB

double linear(int value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

Eigen::Vector3d color_of(const std::string& hex) {
  return {linear(std::stoi(hex.substr(0, 2), nullptr, 16)),
          linear(std::stoi(hex.substr(2, 2), nullptr, 16)),
          linear(std::stoi(hex.substr(4, 2), nullptr, 16))};
}

/// "--name: #rrggbb;" of a block.
Colors colors_of(const std::string& block) {
  Colors colors;
  for (std::size_t at = block.find("--"); at != std::string::npos; at = block.find("--", at + 2)) {
    const std::size_t colon = block.find(": #", at);
    if (colon == std::string::npos || block.find(';', at) < colon) continue;
    colors[block.substr(at + 2, colon - at - 2)] = color_of(block.substr(colon + 3, 6));
  }
  return colors;
}

/// By day, and at night: the first and the second block of the style.
Colors scheme(bool dark) {
  const std::string style(page_assets::style());
  std::size_t begin = style.find(":root {");
  if (dark) begin = style.find(":root {", style.find("prefers-color-scheme: dark"));
  return colors_of(style.substr(begin, style.find('}', begin) - begin));
}

double luminance(const Eigen::Vector3d& c) {
  return Eigen::Vector3d(0.2126, 0.7152, 0.0722).dot(c);
}

double contrast(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double x = luminance(a), y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

/// CIE L*a*b* under D65.
Eigen::Vector3d lab(const Eigen::Vector3d& c) {
  Eigen::Matrix3d xyz;
  xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Eigen::Vector3d v = (xyz * c).cwiseQuotient(Eigen::Vector3d(0.9505, 1.0, 1.089));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(v.y()) - 16.0, 500.0 * (f(v.x()) - f(v.y())), 200.0 * (f(v.y()) - f(v.z()))};
}

/// CIE76 distance, the least of full sight, protanopia and deuteranopia (Machado, Oliveira,
/// Fernandes 2009).
double apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Matrix3d protan, deutan;
  protan << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116,
      1.051998;
  deutan << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940,
      0.968881;
  double least = (lab(a) - lab(b)).norm();
  for (const Eigen::Matrix3d& sight : {protan, deutan}) {
    const auto seen = [&](const Eigen::Vector3d& c) {
      return lab((sight * c).cwiseMax(0.0).cwiseMin(1.0));
    };
    least = std::min(least, (seen(a) - seen(b)).norm());
  }
  return least;
}

TEST(PageColors, TextIsReadableByDayAndAtNight) {
  for (const bool dark : {false, true}) {
    Colors colors = scheme(dark);
    for (const char* text : {"ink", "ink-2", "ink-3", "accent", "good", "warn", "bad"}) {
      for (const char* behind : {"surface", "page"}) {
        ASSERT_TRUE(colors.count(text) && colors.count(behind)) << text;
        EXPECT_GE(contrast(colors[text], colors[behind]), 4.5)
            << text << " on " << behind << (dark ? ", dark" : "");
      }
    }
    for (const char* mark :
         {"estimated", "true", "horizon", "frontier", "target", "mover", "seen-high"}) {
      EXPECT_GE(contrast(colors[mark], colors["map-free"]), 3.0) << mark << (dark ? ", dark" : "");
    }
  }
}

TEST(PageColors, MarksOfTheMapAreApartWithoutRedAndGreen) {
  const std::pair<const char*, const char*> pairs[] = {
      {"estimated", "frontier"}, {"true", "frontier"},      {"horizon", "frontier"},
      {"target", "frontier"},    {"seen-high", "frontier"}, {"estimated", "horizon"},
      {"estimated", "true"},     {"estimated", "target"},   {"mover", "target"},
      {"mover", "horizon"},      {"mover", "estimated"},    {"mover", "frontier"}};
  for (const bool dark : {false, true}) {
    Colors colors = scheme(dark);
    for (const auto& [a, b] : pairs) {
      EXPECT_GE(apart(colors[a], colors[b]), 20.0) << a << ", " << b << (dark ? ", dark" : "");
    }
  }
}

TEST(PageColors, TheWhiteNameOfAModeIsReadable) {
  std::vector<std::string> names;
  for (int kind = 0; kind <= static_cast<int>(ModeKind::kDone); ++kind) {
    names.emplace_back(to_string(static_cast<ModeKind>(kind)));
  }
  for (const Color color : mode_colors(names)) {
    EXPECT_GE(contrast(color_of(hex(color).substr(1)), {1.0, 1.0, 1.0}), 4.5) << hex(color);
  }
}

}  // namespace
}  // namespace prospect::page_colors_test
