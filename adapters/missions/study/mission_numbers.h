// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "adapters/missions/run/run_record.h"
#include "adapters/missions/study/study_number.h"

namespace prospect {

/// What a mission came to. NaN: never reached, or no such number.
struct MissionNumbers {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double done = kNone;  ///< 1: outcome() is kDone, else 0
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
  /// Of the visible features (w_l) and the exploration gain (w_e, negative: a reward): the weight
  /// as asked for, and the mean over the steps with a plan of that in effect.
  double weight_asked_visible_features = kNone, weight_visible_features = kNone;
  double weight_asked_exploration_gain = kNone, weight_exploration_gain = kNone;
  double plan_ms_p50 = kNone;
  double wall_s = kNone;
};

struct MissionNumber {
  StudyNumber number;
  double MissionNumbers::*member;
};
/// All of them, in the order of tables.
const std::vector<MissionNumber>& mission_number_list();
/// In that order.
std::vector<double> values_of(const MissionNumbers& numbers);

/// From the summary of a mission and its steps, of which only the columns of steps.csv count; N_min
/// as in the planner's parameters.
MissionNumbers mission_numbers(const Summary& summary, const std::vector<StepRecord>& steps,
                               double N_min);

/// The same of a run folder. Throws InputError for files that are missing or damaged.
MissionNumbers mission_numbers_of_run(const std::string& folder, double N_min);

}  // namespace prospect
