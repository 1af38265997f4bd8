// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/palette.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "engine/behaviour/mode.h"
#include "engine/support/quantile.h"

namespace prospect {
namespace {

constexpr std::pair<ModeKind, Color> kModes[] = {
    {ModeKind::kExplore, {0x25, 0x63, 0xeb}},       {ModeKind::kApproach, {0x0f, 0x76, 0x6e}},
    {ModeKind::kLookAround, {0x7c, 0x3a, 0xed}},    {ModeKind::kRetreat, {0xb4, 0x53, 0x09}},
    {ModeKind::kTurnOnTheSpot, {0xbe, 0x18, 0x5d}}, {ModeKind::kDone, {0x52, 0x5f, 0x70}},
    {ModeKind::kGoToGoal, {0x03, 0x69, 0xa1}},      {ModeKind::kReturn, {0x4d, 0x7c, 0x0f}},
    {ModeKind::kArrive, {0x15, 0x5e, 0x75}},        {ModeKind::kHold, {0x85, 0x4d, 0x0e}}};
constexpr Color kSpare[] = {{0x9f, 0x12, 0x39}, {0x86, 0x19, 0x8f}};
constexpr double kEndOnWhite = 0.8, kBeginOnDark = 0.3;

/// Of the scale from share `from` to `to`.
Color shade(double from, double to, double t) {
  const std::vector<Color>& colors = scale_colors();
  const double share = std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : t > 0.0 ? 1.0 : 0.0;
  const double at = (from + share * (to - from)) * static_cast<double>(colors.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(low);
  const Color a = colors[low], b = colors[std::min(low + 1, colors.size() - 1)];
  const auto mix = [part](std::uint8_t first, std::uint8_t second) {
    return static_cast<std::uint8_t>(std::lround(first + part * (second - first)));
  };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

}  // namespace

std::string hex(Color color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color.red, color.green, color.blue);
  return text;
}

const std::vector<Color>& scale_colors() {
  static const std::vector<Color> colors = {
      {0x44, 0x01, 0x54}, {0x48, 0x24, 0x75}, {0x41, 0x44, 0x87}, {0x35, 0x5f, 0x8d},
      {0x2a, 0x78, 0x8e}, {0x21, 0x91, 0x8c}, {0x22, 0xa8, 0x84}, {0x44, 0xbf, 0x70},
      {0x7a, 0xd1, 0x51}, {0xbd, 0xdf, 0x26}, {0xfd, 0xe7, 0x25}};
  return colors;
}

Color color_on_white(double t) { return shade(0.0, kEndOnWhite, t); }

Color color_on_dark(double t) { return shade(kBeginOnDark, 1.0, t); }

std::vector<Color> mode_colors(const std::vector<std::string>& modes) {
  std::vector<Color> colors;
  std::size_t spare = 0;
  for (const std::string& mode : modes) {
    const auto* known = std::find_if(std::begin(kModes), std::end(kModes), [&](const auto& entry) {
      return to_string(entry.first) == mode;
    });
    colors.push_back(known != std::end(kModes) ? known->second
                                               : kSpare[spare++ % std::size(kSpare)]);
  }
  return colors;
}

double scale_end(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return 1.0;
  const double end = quantile(std::move(values), 0.98);
  return end > 0.0 ? end : 1.0;
}

}  // namespace prospect
