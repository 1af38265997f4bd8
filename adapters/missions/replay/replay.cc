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

}  // namespace

Replay replay_beside(const RecordedRun& recorded, const std::shared_ptr<const World>& world,
                     const Configuration& configuration, const Configuration& other,
                     const ReplayOptions& options) {
  Replay replay;
  ExplorationRunOptions driven;
  driven.seed = recorded.seed;
  driven.solvers = options.solvers;
  Planner beside(other.robot, other.planner,
                 options.solvers ? options.solvers->make(other.solver) : make_solver(other.solver));
  driven.beside = &beside;

  ExplorationRunOptions observed;
  observed.seed = recorded.seed;
  StepRecord other_step;
  observed.on_step = [&](const StepRecord& step) { other_step = step; };
  RunRecorder other_recorder(other, observed, &beside);
  driven.on_beside = [&](const MissionStep& step, const SimulatedTruth& truth) {
    if (step.index >= options.from) other_recorder.add(step, truth);
  };
  bool parted = false, past = false;
  StepColumns columns;
  std::vector<StepRecord> first;  // before the columns of steps.csv are known
  std::size_t compared = 0;
  const auto compare = [&](const StepRecord& step) {
    const auto row_is = [&](const StepRecord& s) {
      std::string row = step_row(s, columns);
      row.pop_back();
      if (compared < recorded.rows.size() && recorded.rows[compared] == row) {
        ++compared;
        return;
      }
      if (parted || recorded.log) return;
      RecordedRun until = recorded;
      until.rows = {compared < recorded.rows.size() ? recorded.rows[compared] : ""};
      std::string header = step_header(columns);
      header.pop_back();
      replay.difference = first_difference(until, header, {row});
      replay.difference.step = s.step;
      parted = true;
    };
    if (columns.empty()) {
      first.push_back(step);
      columns = step_columns({step});
      if (columns.empty()) return;
      for (const StepRecord& s : first) row_is(s);
      first.clear();
      return;
    }
    row_is(step);
  };
  driven.on_step = [&](const StepRecord& step) {
    compare(step);
    past = step.step >= options.to;
    // on_beside comes before it.
    if (!parted && step.step >= options.from && step.step <= options.to) {
      replay.steps.push_back({step, other_step});
    }
    if (options.progress) options.progress(step);
  };
  driven.cancelled = [&] {
    const bool all_driven = !recorded.log && compared >= recorded.rows.size();
    return past || parted || all_driven || (options.cancelled && options.cancelled());
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
