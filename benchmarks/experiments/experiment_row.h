#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "adapters/run/run_record.h"

namespace prospect {

/// One mission of an experiment. NaN: never reached, or no such number.
struct ExperimentRow {
  std::string world, condition;
  std::uint64_t seed = 0;
  std::string sensors;  ///< "model" or "camera"
  std::string reason;   ///< why the mission ended; "failed: ..." if it could not be run to an end

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double duration_s = kNone;
  double coverage = kNone;
  double path_length_m = kNone;
  /// Distance of the estimated from the true position: at the end, root mean square and largest
  /// over the steps, at the end by metre of path (of a metre or more), and when coverage first
  /// reaches 80 %.
  double error_final_m = kNone, error_rms_m = kNone, error_max_m = kNone;
  double drift_m_per_m = kNone;
  double error_at_80_m = kNone;
  /// Relative pose error over 10 m of the true path, by metre (relative_error()); in the plane.
  double rpe_10_m_per_m = kNone;
  /// Coverage at the first step with an error above 0.1, 0.25, 0.5 m; if there is none, that at the
  /// end.
  double coverage_at_10_cm = kNone, coverage_at_25_cm = kNone, coverage_at_50_cm = kNone;
  /// Coverage at the first step after 60 and 120 s, and after 20 and 40 m; of a shorter mission
  /// that at the end.
  double coverage_at_60_s = kNone, coverage_at_120_s = kNone;
  double coverage_at_20_m = kNone, coverage_at_40_m = kNone;
  double losses = kNone;     ///< of localization
  double few_share = kNone;  ///< of the time, with fewer than N_min tracked features
  double time_to_90_s = kNone;
  double collisions = kNone;
  /// Means of |e| and of e over the steps, where e = (predicted - tracked) / max(tracked, N_min):
  /// what a plan predicts for the end of its committed part against the image in which the next one
  /// begins. Steps without a prediction (a stopping tail) are left out; NaN for a planner that
  /// predicts nothing at any step.
  double prediction_error = kNone, prediction_bias = kNone;
  double plan_ms_p50 = kNone;
  double wall_s = kNone;

  bool failed() const { return reason.rfind("failed", 0) == 0; }
};

/// The numbers of a row, by their names in the table.
struct ExperimentNumber {
  const char* name;
  double ExperimentRow::*member;
};
const std::vector<ExperimentNumber>& experiment_numbers();

/// Fills the numbers from the summary of a mission and its steps; N_min as in the planner's
/// parameters.
ExperimentRow experiment_row(const Summary& summary, const std::vector<StepRecord>& steps,
                             double N_min);

/// Tables as of result_table.h. Throw InputError.
std::string experiment_header();
std::vector<ExperimentRow> read_experiment(const std::string& path);
void append_experiment(const std::string& path, const ExperimentRow& row);

}  // namespace prospect
