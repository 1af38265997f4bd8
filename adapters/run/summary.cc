#include "adapters/run/summary.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "engine/support/quantile.h"

namespace prospect {
namespace {

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

/// Time and path at which coverage first reaches `share`.
std::pair<double, double> reach(const std::vector<StepRecord>& steps, double share) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(steps[i].coverage >= share)) continue;  // nor where there is none
    if (i == 0) return {steps[0].time, steps[0].path_length};
    const StepRecord& a = steps[i - 1];
    const StepRecord& b = steps[i];
    const double rise = b.coverage - a.coverage;
    const double s = rise > 0.0 ? (share - a.coverage) / rise : 1.0;
    return {a.time + s * (b.time - a.time), a.path_length + s * (b.path_length - a.path_length)};
  }
  return {kNever, kNever};
}

}  // namespace

Summary summarize(const std::vector<StepRecord>& steps) {
  Summary s;
  s.time_to_90_s = s.time_to_95_s = s.time_to_99_s = kNever;
  s.path_to_90_m = s.path_to_95_m = s.path_to_99_m = kNever;
  s.plan_ms_p50 = s.plan_ms_p95 = s.plan_ms_p99 = s.plan_ms_max = kNever;
  s.localization_rmse_m = s.localization_final_m = s.drift_percent = kNever;
  if (steps.empty()) return s;
  std::tie(s.time_to_90_s, s.path_to_90_m) = reach(steps, 0.90);
  std::tie(s.time_to_95_s, s.path_to_95_m) = reach(steps, 0.95);
  std::tie(s.time_to_99_s, s.path_to_99_m) = reach(steps, 0.99);
  std::vector<double> plan_ms;
  double squares = 0.0;
  for (const StepRecord& step : steps) {
    plan_ms.push_back(step.wall.plan);
    squares += step.localization_error * step.localization_error;
    s.guard_stops += step.guard_stops;
    s.fallbacks += step.plan_kind == "stopping tail";
  }
  s.plan_ms_p50 = quantile(plan_ms, 0.5);
  s.plan_ms_p95 = quantile(plan_ms, 0.95);
  s.plan_ms_p99 = quantile(plan_ms, 0.99);
  s.plan_ms_max = quantile(plan_ms, 1.0);
  const StepRecord& last = steps.back();
  s.coverage = last.coverage;
  s.area_m2 = last.area;
  s.collisions = last.collisions;
  s.duration_s = last.time;
  s.path_length_m = last.path_length;
  s.localization_rmse_m = std::sqrt(squares / static_cast<double>(steps.size()));
  s.localization_final_m = last.localization_error;
  s.drift_percent =
      last.path_length > 0.0 ? 100.0 * last.localization_error / last.path_length : kNever;
  s.steps = static_cast<int>(steps.size());
  return s;
}

std::string summary_json(const Summary& s) {
  const nlohmann::ordered_json collisions =
      s.measured ? nlohmann::ordered_json(s.collisions) : nullptr;
  // Numbers that are not finite become null.
  const nlohmann::ordered_json json = {{"world", s.world},
                                       {"solver", s.solver},
                                       {"seed", s.seed},
                                       {"task", s.task},
                                       {"done", s.done},
                                       {"reason", s.reason},
                                       {"detail", s.detail},
                                       {"coverage", s.coverage},
                                       {"area_m2", s.area_m2},
                                       {"reachable_area_m2", s.reachable_area_m2},
                                       {"too_long_for_m2", s.too_long_for_m2},
                                       {"collisions", collisions},
                                       {"losses", s.losses},
                                       {"duration_s", s.duration_s},
                                       {"wall_s", s.wall_s},
                                       {"path_length_m", s.path_length_m},
                                       {"time_to_90_s", s.time_to_90_s},
                                       {"time_to_95_s", s.time_to_95_s},
                                       {"time_to_99_s", s.time_to_99_s},
                                       {"path_to_90_m", s.path_to_90_m},
                                       {"path_to_95_m", s.path_to_95_m},
                                       {"path_to_99_m", s.path_to_99_m},
                                       {"localization_rmse_m", s.localization_rmse_m},
                                       {"localization_final_m", s.localization_final_m},
                                       {"drift_percent", s.drift_percent},
                                       {"plan_ms",
                                        {{"p50", s.plan_ms_p50},
                                         {"p95", s.plan_ms_p95},
                                         {"p99", s.plan_ms_p99},
                                         {"max", s.plan_ms_max}}},
                                       {"deadline_misses", s.deadline_misses},
                                       {"fallbacks", s.fallbacks},
                                       {"guard_stops", s.guard_stops},
                                       {"steps", s.steps},
                                       {"floor_share", s.floor_share},
                                       {"read_without", s.read_without}};
  // A world may be named after a file whose name is no UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace prospect
