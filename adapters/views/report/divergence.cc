// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/divergence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/support/named.h"
#include "models/formatted.h"

namespace prospect {
namespace {

/// Which of two steps differ, as text of both; "" where they are equal.
std::string difference(const DrivenSteps& a, std::size_t i, const DrivenSteps& b, std::size_t j) {
  const auto differ = [](double p, double q) {
    return std::isnan(p) != std::isnan(q) || std::abs(p - q) > Divergence::kEqual;
  };
  const auto pair = [](double p, double q) {
    return std::isfinite(p) ? formatted("(%.2f, %.2f)", p, q) : std::string("none");
  };
  if (a.mode[i] != b.mode[j]) return "mode: " + a.mode[i] + ", " + b.mode[j];
  if (differ(a.target_x[i], b.target_x[j]) || differ(a.target_y[i], b.target_y[j])) {
    return "target: " + pair(a.target_x[i], a.target_y[i]) + ", " +
           pair(b.target_x[j], b.target_y[j]);
  }
  if (differ(a.v[i], b.v[j]) || differ(a.vy[i], b.vy[j]) || differ(a.omega[i], b.omega[j])) {
    const auto command = [](const DrivenSteps& of, std::size_t k) {
      return formatted("%.3f m/s %.3f rad/s", std::hypot(of.v[k], of.vy[k]), of.omega[k]);
    };
    return "command: " + command(a, i) + ", " + command(b, j);
  }
  if (differ(a.x[i], b.x[j]) || differ(a.y[i], b.y[j])) {
    return "position: " + pair(a.x[i], a.y[i]) + ", " + pair(b.x[j], b.y[j]);
  }
  if (std::abs(std::remainder(a.yaw[i] - b.yaw[j], 2.0 * M_PI)) > Divergence::kEqual) {
    return formatted("heading: %.3f rad, %.3f rad", a.yaw[i], b.yaw[j]);
  }
  return "";
}

}  // namespace

DrivenSteps driven_steps(const StepTable& table) {
  // A program of before may not have told all of them.
  const auto numbers = [&](const char* column) {
    return table.has(column) ? table.numbers(column)
                             : std::vector<double>(table.rows(), std::nan(""));
  };
  return {table.numbers("time"),
          table.has("mode") ? table.words("mode") : std::vector<std::string>(table.rows()),
          numbers("target_x"),
          numbers("target_y"),
          numbers("command_v"),
          numbers("command_vy"),
          numbers("command_omega"),
          table.numbers("estimated_x"),
          table.numbers("estimated_y"),
          table.numbers("estimated_yaw")};
}

DrivenSteps driven_steps(const std::vector<StepRecord>& steps) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  DrivenSteps driven;
  for (const StepRecord& s : steps) {
    driven.time.push_back(s.time);
    driven.mode.push_back(s.mode ? name_of(s.mode) : "");
    driven.target_x.push_back(s.target ? s.target->viewpoint.x() : kNone);
    driven.target_y.push_back(s.target ? s.target->viewpoint.y() : kNone);
    driven.v.push_back(s.command.linear.x());
    driven.vy.push_back(s.command.linear.y());
    driven.omega.push_back(s.command.yaw_rate);
    driven.x.push_back(s.estimated_pose.position.x());
    driven.y.push_back(s.estimated_pose.position.y());
    driven.yaw.push_back(s.estimated_pose.yaw);
  }
  return driven;
}

Divergence first_divergence(const DrivenSteps& first, const DrivenSteps& second) {
  constexpr double kSameTime = 1e-6;  // [s]
  Divergence found;
  const std::size_t n = first.time.size(), m = second.time.size();
  std::size_t j = 0;
  for (std::size_t i = 0; i < n && m > 0; ++i) {
    if (first.time[i] > second.time.back() + kSameTime) break;
    while (j + 1 < m && second.time[j + 1] <= first.time[i] + kSameTime) ++j;
    if (found.step < 0) {
      found.what = difference(first, i, second, j);
      if (!found.what.empty()) {
        found.step = static_cast<int>(i);
        found.time = first.time[i];
      }
    }
    if (std::hypot(first.x[i] - second.x[j], first.y[i] - second.y[j]) > Divergence::kApart) {
      found.apart = first.time[i];
      break;
    }
  }
  return found;
}

}  // namespace prospect
