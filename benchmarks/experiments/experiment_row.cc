#include "benchmarks/experiments/experiment_row.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "adapters/datasets/trajectory_error.h"
#include "benchmarks/result_table.h"

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
  return error.segments > 0 ? error.translation : ExperimentRow::kNone;
}

}  // namespace

const std::vector<ExperimentNumber>& experiment_numbers() {
  using Row = ExperimentRow;
  static const std::vector<ExperimentNumber> numbers = {
      {"duration_s", &Row::duration_s},
      {"coverage", &Row::coverage},
      {"path_length_m", &Row::path_length_m},
      {"error_final_m", &Row::error_final_m},
      {"error_rms_m", &Row::error_rms_m},
      {"error_max_m", &Row::error_max_m},
      {"drift_m_per_m", &Row::drift_m_per_m},
      {"error_at_80_m", &Row::error_at_80_m},
      {"rpe_10_m_per_m", &Row::rpe_10_m_per_m},
      {"coverage_at_10_cm", &Row::coverage_at_10_cm},
      {"coverage_at_25_cm", &Row::coverage_at_25_cm},
      {"coverage_at_50_cm", &Row::coverage_at_50_cm},
      {"coverage_at_60_s", &Row::coverage_at_60_s},
      {"coverage_at_120_s", &Row::coverage_at_120_s},
      {"coverage_at_20_m", &Row::coverage_at_20_m},
      {"coverage_at_40_m", &Row::coverage_at_40_m},
      {"losses", &Row::losses},
      {"few_share", &Row::few_share},
      {"time_to_90_s", &Row::time_to_90_s},
      {"collisions", &Row::collisions},
      {"prediction_error", &Row::prediction_error},
      {"prediction_bias", &Row::prediction_bias},
      {"plan_ms_p50", &Row::plan_ms_p50},
      {"wall_s", &Row::wall_s},
  };
  return numbers;
}

ExperimentRow experiment_row(const Summary& s, const std::vector<StepRecord>& steps, double N_min) {
  ExperimentRow row;
  row.seed = s.seed;
  row.reason = s.reason;
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
    if (last || step.plan_kind == "stopping tail") continue;
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
  return row;
}

std::string experiment_header() {
  std::string header = "world,condition,seed,sensors,reason";
  for (const ExperimentNumber& number : experiment_numbers()) {
    header += std::string(",") + number.name;
  }
  return header;
}

std::vector<ExperimentRow> read_experiment(const std::string& path) {
  std::vector<ExperimentRow> rows;
  for (const TableLine& line : read_table(path, experiment_header())) {
    ExperimentRow row;
    row.world = line.fields[0];
    row.condition = line.fields[1];
    row.seed = read_seed(path, line, 2);
    row.sensors = line.fields[3];
    row.reason = line.fields[4];
    std::size_t at = 5;
    for (const ExperimentNumber& n : experiment_numbers()) {
      row.*n.member = read_number(path, line, at++, n.name);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void append_experiment(const std::string& path, const ExperimentRow& row) {
  std::string line = table_text(row.world) + ',' + table_text(row.condition) + ',' +
                     std::to_string(row.seed) + ',' + table_text(row.sensors) + ',' +
                     table_text(row.reason);
  for (const ExperimentNumber& n : experiment_numbers()) line += ',' + table_number(row.*n.member);
  append_to_table(path, experiment_header(), line);
}

}  // namespace prospect
