// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prospect {

/// A colour, sRGB.
struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// "#2563eb".
std::string hex(Color color);

/// The scale of quantities: matplotlib's viridis (public domain, CC0) at even distances from 0
/// to 1. It is even to the eye, also in grey and to the colour-blind.
const std::vector<Color>& scale_colors();

/// Colour of a share t of the scale, for lines on white: the last, yellow fifth of viridis is left
/// out. t is clamped; NaN gives the colour of 0.
Color color_on_white(double t);

/// The same on a dark ground: the first, dark quarter is left out.
Color color_on_dark(double t);

/// A colour for each of `modes` (names as in StepRecord), none of them twice unless there are more
/// unknown names than spare colours. Known names always have the same colour.
std::vector<Color> mode_colors(const std::vector<std::string>& modes);

/// Where a scale of these values ends: their 98th percentile (nearest rank), so that a single peak
/// does not flatten the rest; 1 if that is not positive. Values that are not finite do not count.
double scale_end(std::vector<double> values);

}  // namespace prospect
