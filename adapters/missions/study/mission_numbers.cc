// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/mission_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/trajectory_error.h"
#include "adapters/missions/run/step_fields.h"
#include "adapters/missions/run/summary.h"
#include "adapters/views/report/step_table.h"

namespace prospect {
namespace {

/// At the first step of which `number` is more than `limit`; if there is none, at the end.
double coverage_past(const std::vector<StepRecord>& steps, double StepRecord::*number, double limit,
                     double at_end) {
  for (const StepRecord& step : steps) {
    if (step.*number > limit) return step.coverage;
  }
  return at_end;
}

Eigen::Isometry3d in_plane(const Pose& pose) {
  return Eigen::Translation3d(pose.position.x(), pose.position.y(), 0.0) *
         Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ());
}

double relative_pose_error(const std::vector<StepRecord>& steps) {
  std::vector<PosePair> pairs;
  pairs.reserve(steps.size());
  for (const StepRecord& step : steps) {
    pairs.push_back({step.time, in_plane(step.estimated_pose), in_plane(step.true_pose)});
  }
  const RelativeError error = relative_error(pairs, 10.0);
  return error.segments > 0 ? error.translation : MissionNumbers::kNone;
}

/// Over the steps that say the weight of that cost; NaN where none does.
double mean_weight(const std::vector<StepRecord>& steps, std::string_view name,
                   double TermWeight::*which) {
  double sum = 0.0;
  int count = 0;
  for (const StepRecord& step : steps) {
    for (const TermWeight& weight : step.weights) {
      if (weight.name != name || !std::isfinite(weight.*which)) continue;
      sum += weight.*which;
      ++count;
    }
  }
  return count > 0 ? sum / count : MissionNumbers::kNone;
}

/// Enters a column of steps.csv; what is empty there the step lacks.
void enter_column(const StepTable& table, const std::string& column,
                  std::vector<StepRecord>& steps) {
  const auto [field, name] = field_of_column(column);
  const std::vector<std::string> texts = table.words(column);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!texts[i].empty()) enter_field(*field, name, texts[i], table.row_name(i), steps[i]);
  }
}

}  // namespace

const std::vector<MissionNumber>& mission_number_list() {
  using M = MissionNumbers;
  static const std::vector<MissionNumber> numbers = {
      {{"done", "task done, of missions [%]", 100.0, 1, false, false}, &M::done},
      {{"losses", "losses of localization", 1.0, 1, true, false, true}, &M::losses},
      {{"few_share", "time with fewer than N_min features [%]", 100.0, 1, true, false, true},
       &M::few_share},
      {{"error_rms_m", "position error, RMS [m]", 1.0, 3, true, false, true}, &M::error_rms_m},
      {{"error_final_m", "position error, final [m]", 1.0, 3, true, false}, &M::error_final_m},
      {{"error_max_m", "position error, largest [m]", 1.0, 3, true, false}, &M::error_max_m},
      {{"error_at_80_m", "position error at 80 % coverage [m]", 1.0, 3, true, false},
       &M::error_at_80_m},
      {{"drift_m_per_m", "drift [mm/m]", 1000.0, 1, true, false}, &M::drift_m_per_m},
      {{"rpe_10_m_per_m", "relative pose error over 10 m [mm/m]", 1000.0, 1, true, false},
       &M::rpe_10_m_per_m},
      {{"coverage_at_10_cm", "coverage when the error passes 0.1 m [%]", 100.0, 1, true, false},
       &M::coverage_at_10_cm},
      {{"coverage_at_25_cm", "coverage when it passes 0.25 m [%]", 100.0, 1, true, false},
       &M::coverage_at_25_cm},
      {{"coverage_at_50_cm", "coverage when it passes 0.5 m [%]", 100.0, 1, true, false},
       &M::coverage_at_50_cm},
      {{"coverage_at_60_s", "coverage after 60 s [%]", 100.0, 1, true, false},
       &M::coverage_at_60_s},
      {{"coverage_at_120_s", "coverage after 120 s [%]", 100.0, 1, true, false},
       &M::coverage_at_120_s},
      {{"coverage_at_20_m", "coverage after 20 m [%]", 100.0, 1, true, false},
       &M::coverage_at_20_m},
      {{"coverage_at_40_m", "coverage after 40 m [%]", 100.0, 1, true, false},
       &M::coverage_at_40_m},
      {{"coverage", "coverage at the end [%]", 100.0, 1, true, false, true}, &M::coverage},
      {{"time_to_90_s", "time to 90 % [s]", 1.0, 0, true, false, true}, &M::time_to_90_s},
      {{"duration_s", "duration [s]", 1.0, 0, true, false}, &M::duration_s},
      {{"path_length_m", "path [m]", 1.0, 1, true, false, true}, &M::path_length_m},
      {{"collisions", "collisions", 1.0, 1, true, false}, &M::collisions},
      {{"prediction_error", "predicted features, relative error", 1.0, 3, true, false},
       &M::prediction_error},
      {{"prediction_bias", "predicted features, relative bias", 1.0, 3, false, false},
       &M::prediction_bias},
      {{"weight_asked_visible_features", "weight of the features, asked for", 1.0, 3, false, false},
       &M::weight_asked_visible_features},
      {{"weight_visible_features", "weight of the features, in effect", 1.0, 3, false, false},
       &M::weight_visible_features},
      {{"weight_asked_exploration_gain", "weight of the exploration gain, asked for", 1.0, 3, false,
        false},
       &M::weight_asked_exploration_gain},
      {{"weight_exploration_gain", "weight of the exploration gain, in effect", 1.0, 3, false,
        false},
       &M::weight_exploration_gain},
      {{"plan_ms_p50", "replanning, median [ms]", 1.0, 1, true, true}, &M::plan_ms_p50},
      {{"wall_s", "wall clock [s]", 1.0, 1, true, true}, &M::wall_s},
  };
  return numbers;
}

std::vector<double> values_of(const MissionNumbers& numbers) {
  std::vector<double> values;
  for (const MissionNumber& number : mission_number_list()) {
    values.push_back(numbers.*number.member);
  }
  return values;
}

MissionNumbers mission_numbers(const Summary& s, const std::vector<StepRecord>& steps,
                               double N_min) {
  MissionNumbers row;
  row.done = outcome(s) == Outcome::kDone ? 1.0 : 0.0;
  row.duration_s = s.duration_s;
  row.coverage = s.coverage;
  row.path_length_m = s.path_length_m;
  row.error_final_m = s.localization_final_m;
  row.error_rms_m = s.localization_rmse_m;
  if (s.path_length_m >= 1.0) row.drift_m_per_m = s.localization_final_m / s.path_length_m;
  row.losses = s.losses;
  row.time_to_90_s = s.time_to_90_s;
  row.collisions = s.collisions;
  row.plan_ms_p50 = s.plan_ms_p50;
  row.wall_s = s.wall_s;
  if (steps.empty()) return row;

  row.error_max_m = 0.0;
  double time = 0.0, few = 0.0, magnitude = 0.0, sum = 0.0;
  int predictions = 0;
  bool predicts = false;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const StepRecord& step = steps[i];
    row.error_max_m = std::max(row.error_max_m, step.localization_error);
    if (std::isnan(row.error_at_80_m) && step.coverage >= 0.8) {
      row.error_at_80_m = step.localization_error;
    }
    const bool last = i + 1 == steps.size();
    const double length =
        (last ? std::max(s.duration_s, step.time) : steps[i + 1].time) - step.time;
    time += length;
    if (step.tracked_features < N_min) few += length;
    if (last || step.plan_kind == PlanKind::kStoppingTail) continue;
    const double tracked = steps[i + 1].tracked_features;
    const double e = (step.predicted_features - tracked) / std::max(tracked, N_min);
    magnitude += std::abs(e);
    sum += e;
    ++predictions;
    predicts = predicts || step.predicted_features > 0.0;
  }
  if (time > 0.0) row.few_share = few / time;
  if (predicts) {
    row.prediction_error = magnitude / predictions;
    row.prediction_bias = sum / predictions;
  }
  const auto when = [&](double StepRecord::*number, double limit) {
    return coverage_past(steps, number, limit, s.coverage);
  };
  row.coverage_at_10_cm = when(&StepRecord::localization_error, 0.10);
  row.coverage_at_25_cm = when(&StepRecord::localization_error, 0.25);
  row.coverage_at_50_cm = when(&StepRecord::localization_error, 0.50);
  row.coverage_at_60_s = when(&StepRecord::time, 60.0);
  row.coverage_at_120_s = when(&StepRecord::time, 120.0);
  row.coverage_at_20_m = when(&StepRecord::path_length, 20.0);
  row.coverage_at_40_m = when(&StepRecord::path_length, 40.0);
  row.rpe_10_m_per_m = relative_pose_error(steps);
  const auto weights = [&](std::string_view name, double& asked, double& in_effect) {
    asked = mean_weight(steps, name, &TermWeight::asked);
    in_effect = mean_weight(steps, name, &TermWeight::in_effect);
  };
  weights("visible_features", row.weight_asked_visible_features, row.weight_visible_features);
  weights("exploration_gain", row.weight_asked_exploration_gain, row.weight_exploration_gain);
  return row;
}

MissionNumbers mission_numbers_of_run(const std::string& folder, double N_min) {
  const std::string file = folder + "/summary.json";
  std::ifstream in(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  const std::optional<Summary> summary = summary_from_json(text);
  if (!summary) fail(file, "no summary of a run; expected one that explore wrote");
  const StepTable table = StepTable::read(folder + "/steps.csv");
  std::vector<StepRecord> steps(table.rows());
  const auto enter = [&](const std::string& column) { enter_column(table, column, steps); };
  for (const std::string pose : {"true_", "estimated_"}) {
    for (const std::string part : {"x", "y", "yaw"}) enter(pose + part);
  }
  for (const char* column : {"time", "coverage", "localization_error", "path_length",
                             "predicted_features", "tracked_features", "plan_kind"}) {
    enter(column);
  }
  for (const std::string& column : table.columns()) {
    const StepField* field = field_of_column(column).first;
    if (field && field->per == FieldPer::kWeight) enter(column);
  }
  return mission_numbers(*summary, steps, N_min);
}

}  // namespace prospect
