// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/summary.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
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

/// Told of each entry in the order of the file; the percentiles are a group of their own.
template <class S, class Visit, class VisitPlanMs>
void summary_entries(S& s, const Visit& visit, const VisitPlanMs& plan_ms) {
  visit("world", s.world);
  visit("solver", s.solver);
  visit("seed", s.seed);
  visit("task", s.task);
  visit("done", s.done);
  visit("reason", s.end);
  visit("detail", s.detail);
  visit("turned_back_s", s.turned_back_s);
  visit("heading_missed_deg", s.heading_missed_deg);
  visit("coverage", s.coverage);
  visit("area_m2", s.area_m2);
  visit("reachable_area_m2", s.reachable_area_m2);
  visit("too_long_for_m2", s.too_long_for_m2);
  visit("collisions", s.collisions);
  visit("losses", s.losses);
  visit("duration_s", s.duration_s);
  visit("wall_s", s.wall_s);
  visit("path_length_m", s.path_length_m);
  visit("time_to_90_s", s.time_to_90_s);
  visit("time_to_95_s", s.time_to_95_s);
  visit("time_to_99_s", s.time_to_99_s);
  visit("path_to_90_m", s.path_to_90_m);
  visit("path_to_95_m", s.path_to_95_m);
  visit("path_to_99_m", s.path_to_99_m);
  visit("localization_rmse_m", s.localization_rmse_m);
  visit("localization_final_m", s.localization_final_m);
  visit("drift_percent", s.drift_percent);
  plan_ms("p50", s.plan_ms_p50);
  plan_ms("p95", s.plan_ms_p95);
  plan_ms("p99", s.plan_ms_p99);
  plan_ms("max", s.plan_ms_max);
  visit("deadline_misses", s.deadline_misses);
  visit("fallbacks", s.fallbacks);
  visit("guard_stops", s.guard_stops);
  visit("steps", s.steps);
  visit("floor_share", s.floor_share);
  visit("read_without", s.read_without);
}

}  // namespace

Outcome outcome(const Summary& summary) {
  const Outcome of_end = row_of(summary.end).outcome;
  if (of_end != Outcome::kDone) return of_end;
  if (summary.collisions > 0) return Outcome::kFailed;
  return summary.done ? Outcome::kDone : Outcome::kNotDone;
}

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
    s.fallbacks += step.plan_kind == PlanKind::kStoppingTail;
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
  constexpr double kMoved = 1e-3;  // [m]: a robot that stands turns and sways by rounding
  s.drift_percent =
      last.path_length > kMoved ? 100.0 * last.localization_error / last.path_length : kNever;
  s.steps = static_cast<int>(steps.size());
  return s;
}

std::string summary_json(const Summary& summary) {
  nlohmann::ordered_json json;
  // Numbers that are not finite become null.
  summary_entries(
      summary,
      [&](const char* name, const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, MissionEnd>) {
          json[name] = to_string(value);
        } else {
          json[name] = value;
        }
      },
      [&](const char* name, const auto& value) { json["plan_ms"][name] = value; });
  json["outcome"] = to_string(outcome(summary));
  if (!summary.measured) json["collisions"] = nullptr;
  // A world may be named after a file whose name is no UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::optional<Summary> summary_from_json(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  Summary summary;
  bool sound = true;
  const auto reader = [&](const nlohmann::json& from) {
    return [&](const char* name, auto& value) {
      const auto found = from.find(name);
      if (found == from.end()) return;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, MissionEnd>) {
        const auto end =
            found->is_string() ? mission_end_named(found->get<std::string>()) : std::nullopt;
        sound = sound && end;
        value = end.value_or(value);
      } else if constexpr (std::is_same_v<Value, std::string>) {
        sound = sound && found->is_string();
        if (found->is_string()) value = found->get<std::string>();
      } else if constexpr (std::is_same_v<Value, bool>) {
        sound = sound && found->is_boolean();
        if (found->is_boolean()) value = found->get<bool>();
      } else if (std::is_floating_point_v<Value> && found->is_null()) {
        value = std::numeric_limits<Value>::quiet_NaN();
      } else if (std::is_same_v<Value, int> && found->is_null()) {
        summary.measured = false;  // collisions that nobody has counted
      } else {
        sound = sound && found->is_number();
        if (found->is_number()) value = found->get<Value>();
      }
    };
  };
  const nlohmann::json plan_ms = json.value("plan_ms", nlohmann::json::object());
  sound = plan_ms.is_object();
  summary_entries(summary, reader(json),
                  reader(plan_ms.is_object() ? plan_ms : nlohmann::json::object()));
  if (!sound) return std::nullopt;
  return summary;
}

}  // namespace prospect
