// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/calibration_report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace prospect {
namespace {

template <typename... Values>
std::string line(const char* format, Values... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// JSON has no word for numbers that are not finite.
nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json as_json(const VisibilityAgreement& a) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const ReliabilityBin& bin : a.reliability.bins) {
    bins.push_back(
        {{"predicted", bin.predicted}, {"observed", bin.observed}, {"count", bin.count}});
  }
  return {{"frames", a.count.count},
          {"predicted_mean", a.count.predicted},
          {"tracked_mean", a.count.counted},
          {"bias", a.count.bias},
          {"mean_absolute_error", a.count.mean_absolute_error},
          {"correlation", number_or_null(a.count.correlation)},
          {"landmarks", a.reliability.count},
          {"brier", a.reliability.brier},
          {"calibration_error", a.reliability.error},
          {"bins", bins}};
}

nlohmann::ordered_json as_json(const PoseConsistency& c) {
  const double none = c.count > 0 ? 0.0 : std::nan("");
  return {{"errors", c.count},
          {"degrees", c.degrees},
          {"mean", number_or_null(c.mean + none)},
          {"median", number_or_null(c.median + none)},
          {"within_95", number_or_null(c.within_95 + none)}};
}

std::string row(const char* survival, const VisibilityAgreement& a) {
  return line("  %-9s %3d  %7.1f %7.1f %+7.1f %7.1f", survival, a.horizon, a.count.predicted,
              a.count.counted, a.count.bias, a.count.mean_absolute_error) +
         (std::isfinite(a.count.correlation) ? line("  %6.3f", a.count.correlation)
                                             : std::string("       -")) +
         line("  %6.4f  %6.4f\n", a.reliability.brier, a.reliability.error);
}

std::string row(const char* what, const PoseConsistency& c) {
  if (c.count == 0) return {};
  return line("  %-22s %6d  %7.2f %7.2f   %5.1f %%\n", what, c.count, c.mean, c.median,
              100.0 * c.within_95);
}

}  // namespace

std::string calibration_text(const OdometryCalibrationResult& r) {
  if (r.predictions == 0) {
    return "calibration  too few frames: expected more than the shortest horizon\n";
  }
  std::string text = line(
      "calibration  %d predictions of a landmark; %d more given up for an older one nearby\n"
      "  survival   in  predicted tracked  bias  abs.err.   corr.  Brier   cal.err.\n",
      r.predictions, r.given_up);
  for (const VisibilityAgreement& a : r.constant) {
    if (a.count.count > 0) text += row("constant", a);
  }
  for (const VisibilityAgreement& a : r.online) {
    if (a.count.count > 0) text += row("learned", a);
  }
  text += "  in: frames ahead. Reliability of the learned one, predicted > observed (landmarks):\n";
  for (const VisibilityAgreement& a : r.online) {
    if (a.count.count == 0) continue;
    text += line("  %3d ", a.horizon);
    for (const ReliabilityBin& bin : a.reliability.bins) {
      if (bin.count > 0) {
        text += line(" %.2f>%.2f(%d)", bin.predicted, bin.observed, bin.count);
      }
    }
    text += "\n";
  }
  if (r.consistency.pose.count > 0) {
    text +=
        "consistency  squared error over its claimed variance, a degree of freedom: 1 if true\n"
        "                         errors     mean  median  within 95 %\n";
    text += row("pose, since the first", r.consistency.pose);
    for (const ConsistencyResult::Motion& m : r.consistency.motions) {
      text += row(line("motion, %d frames", m.frames).c_str(), m.consistency);
    }
    for (std::size_t h = 0; h < r.motion.size(); ++h) {
      text += row(line("planner, %d frames", r.online[h].horizon).c_str(), r.motion[h]);
      text += row("  with assumed noise", r.motion_assumed[h]);
    }
  }
  return text;
}

nlohmann::ordered_json calibration_json(const OdometryCalibrationResult& r) {
  nlohmann::ordered_json horizons = nlohmann::ordered_json::array();
  for (std::size_t h = 0; h < r.online.size(); ++h) {
    horizons.push_back({{"horizon_frames", r.online[h].horizon},
                        {"learned", as_json(r.online[h])},
                        {"constant", as_json(r.constant[h])},
                        {"planner_consistency", as_json(r.motion[h])},
                        {"planner_consistency_assumed", as_json(r.motion_assumed[h])}});
  }
  return {{"predictions", r.predictions},
          {"given_up", r.given_up},
          {"horizons", horizons},
          {"consistency", consistency_json(r.consistency)}};
}

nlohmann::ordered_json consistency_json(const ConsistencyResult& r) {
  nlohmann::ordered_json motions = nlohmann::ordered_json::array();
  for (const ConsistencyResult::Motion& m : r.motions) {
    motions.push_back({{"frames", m.frames}});
    motions.back().update(as_json(m.consistency));
  }
  return {{"pose", as_json(r.pose)}, {"motions", motions}};
}

}  // namespace prospect
