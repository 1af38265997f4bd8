// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/replay.h"

#include <algorithm>
#include <cmath>

#include "adapters/formats/files/csv.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/run_recorder.h"
#include "adapters/missions/run/step_row.h"
#include "engine/planner/planner.h"
#include "engine/support/named.h"
#include "models/range_text.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

std::vector<std::string> term_names(const std::vector<ReplayedStep>& steps) {
  std::vector<std::string> names;
  for (const ReplayedStep& step : steps) {
    for (const StepRecord* record : {&step.recorded, &step.other}) {
      for (const TermValue& term : record->explanation.terms) {
        if (std::find(names.begin(), names.end(), term.name) == names.end()) {
          names.push_back(term.name);
        }
      }
    }
  }
  return names;
}

std::string field_of(double value) { return std::isfinite(value) ? exact_text(value) : ""; }

/// Of one plan, without its times.
std::string plan_fields(const StepRecord& s, const std::vector<std::string>& terms) {
  const bool explained = !s.explanation.terms.empty();
  std::string row = explained ? field_of(s.explanation.cost) : "";
  for (const std::string& name : terms) {
    row += ',';
    for (const TermValue& term : s.explanation.terms) {
      if (term.name == name) row += field_of(term.weighted);
    }
  }
  row += ',';
  if (explained) row += field_of(s.explanation.violation);
  row += ',' + std::to_string(s.cost_evaluations) + ',' + std::to_string(s.gradient_evaluations) +
         ',' + field_of(s.predicted_features) + ',' + csv::field(name_of(s.plan_kind)) + ',' +
         csv::field(name_of(s.mode)) + ',' + csv::field(s.seed) + ',' + (s.certified ? "1" : "0");
  return row;
}

/// Between the ends of both horizons [m]; NaN where one plan has none.
double apart(const ReplayedStep& step) {
  if (step.recorded.horizon.empty() || step.other.horizon.empty()) return NAN;
  const Eigen::Vector3d difference =
      step.recorded.horizon.back().position - step.other.horizon.back().position;
  return difference.norm();
}

/// Compares the steps of a mission that is driven again with the recorded rows, and asks another
/// planner beside it, whose plans are not driven.
class Comparison final : public RunObserver {
 public:
  Comparison(const RecordedRun& recorded, const Configuration& other, const ReplayOptions& options,
             Replay& replay)
      : recorded_(recorded),
        options_(options),
        replay_(replay),
        beside_(other.robot, other.planner,
                options.solvers ? options.solvers->make(other.solver) : make_solver(other.solver)),
        other_recorder_(other, recorded.seed) {
    other_recorder_.watched_by({&other_record_});
  }

  void on_plan(const Belief& belief) override { other_plan_ = beside_.plan(belief); }
  void on_task(const Task& task) override { beside_.set_task(task); }
  void on_record(const StepRecord& record, const MissionStep& step) override {
    if (step.index >= options_.from) {
      MissionStep beside = step;
      const std::shared_ptr<const GlobalPlan> global_plan = beside_.global_plan();
      beside.plan = &other_plan_;
      beside.global_plan = global_plan.get();
      beside.made = beside_.step();
      other_recorder_.on_step(beside);
    }
    compare(record);
    past_ = record.step >= options_.to;
    if (!parted_ && record.step >= options_.from && record.step <= options_.to) {
      replay_.steps.push_back({record, other_record_.newest});
    }
    if (options_.progress) options_.progress(record);
  }
  bool over() const {
    return past_ || parted_ || (!recorded_.log && compared_ >= recorded_.rows.size());
  }

 private:
  struct NewestRecord final : public RunObserver {
    void on_record(const StepRecord& record, const MissionStep&) override { newest = record; }
    StepRecord newest;
  };

  void compare(const StepRecord& step) {
    if (!columns_.empty()) return row_is(step);
    first_.push_back(step);
    columns_ = step_columns({step});
    if (columns_.empty()) return;
    std::string header = step_header(columns_);
    header.pop_back();
    kept_.emplace(recorded_.header, header);
    for (const StepRecord& s : first_) row_is(s);
    first_.clear();
  }
  void row_is(const StepRecord& s) {
    std::string row = step_row(s, columns_);
    row.pop_back();
    row = kept_->of(row);
    if (compared_ < recorded_.rows.size() && recorded_.rows[compared_] == row) {
      ++compared_;
      return;
    }
    if (parted_ || recorded_.log) return;
    RecordedRun until = recorded_;
    until.rows = {compared_ < recorded_.rows.size() ? recorded_.rows[compared_] : ""};
    std::string header = step_header(columns_);
    header.pop_back();
    header = kept_->of(header);
    replay_.difference = first_difference(until, header, {row});
    replay_.difference.step = s.step;
    parted_ = true;
  }

  const RecordedRun& recorded_;
  const ReplayOptions& options_;
  Replay& replay_;
  Planner beside_;
  Plan other_plan_;
  NewestRecord other_record_;
  RunRecorder other_recorder_;
  bool parted_ = false, past_ = false;
  StepColumns columns_;
  std::optional<RecordedColumns> kept_;  // once these are known
  std::vector<StepRecord> first_;        // before the columns of steps.csv are known
  std::size_t compared_ = 0;
};

}  // namespace

Replay replay_beside(const RecordedRun& recorded, const std::shared_ptr<const World>& world,
                     const Configuration& configuration, const Configuration& other,
                     const ReplayOptions& options) {
  Replay replay;
  Comparison comparison(recorded, other, options, replay);
  ExplorationRunOptions driven;
  driven.seed = recorded.seed;
  driven.solvers = options.solvers;
  driven.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&comparison}; };
  driven.cancelled = [&] {
    return comparison.over() || (options.cancelled && options.cancelled());
  };
  replay.record = run_exploration(world, configuration, driven).record;
  return replay;
}

std::string replay_csv(const Replay& replay) {
  const std::vector<std::string> terms = term_names(replay.steps);
  std::string table = "step,time,open_loop";
  for (const std::string side : {"recorded_", "other_"}) {
    table += ',' + side + "cost";
    for (const std::string& term : terms) table += ',' + csv::field(side + "term_" + term);
    for (const char* name : {"violation", "cost_evaluations", "gradient_evaluations",
                             "predicted_features", "plan_kind", "mode", "seed", "certified"}) {
      table += ',' + side + name;
    }
  }
  table += ",tracked_features_next,horizon_ends_apart,recorded_plan_ms,other_plan_ms\n";
  for (std::size_t i = 0; i < replay.steps.size(); ++i) {
    const ReplayedStep& step = replay.steps[i];
    table +=
        std::to_string(step.recorded.step) + ',' + exact_text(step.recorded.time) + ",1," +
        plan_fields(step.recorded, terms) + ',' + plan_fields(step.other, terms) + ',' +
        (i + 1 < replay.steps.size() ? std::to_string(replay.steps[i + 1].recorded.tracked_features)
                                     : "") +
        ',' + field_of(apart(step)) + ',' + field_of(step.recorded.wall.plan) + ',' +
        field_of(step.other.wall.plan) + '\n';
  }
  return table;
}

}  // namespace prospect
