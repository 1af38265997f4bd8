// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/drive_replay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/missions/log/planner_calls.h"
#include "adapters/missions/run/run_recorder.h"
#include "engine/planner/planner.h"
#include "models/range_text.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// How a plan differs from the recorded one; "" if all that is recorded of it is the same.
std::string difference_of(const Plan& plan, const PlannerCall& recorded) {
  std::string difference;
  const auto compare = [&](const char* name, double was, double is) {
    const bool same = std::bit_cast<std::uint64_t>(was) == std::bit_cast<std::uint64_t>(is);
    if (same || !difference.empty()) return;
    difference =
        std::string(name) + ": " + exact_text(was) + " recorded, " + exact_text(is) + " now";
  };
  compare("cost", recorded.cost, plan.explanation.cost);
  compare("cost evaluations", recorded.cost_evaluations, plan.counters.cost_evaluations);
  compare("gradient evaluations", recorded.gradient_evaluations,
          plan.counters.gradient_evaluations);
  if (difference.empty() && plan_hash(plan) != recorded.plan_hash)
    return "the plan, of the same cost";
  return difference;
}

/// The calls of a log in their order, up to the first that is not there.
struct Calls {
  std::vector<PlannerCall> there;
  bool more = false;  ///< later ones are in the log, or were dropped
};

Calls read_calls(const BagFile& bag, const std::string& log) {
  const BagTopic* topic = bag.find(topic::kPlannerCalls);
  if (!topic) {
    throw InputError(log + ": no " + topic::kPlannerCalls +
                     ", from which a planner can be asked again; expected the log of a drive");
  }
  if (topic->type != PlannerCall::kType) {
    throw InputError(log + ": " + topic->name + " is of " + topic->type + "; expected " +
                     PlannerCall::kType);
  }
  Calls calls;
  std::vector<PlannerCall>& there = calls.there;
  for (const BagTopic::Message& message : topic->messages) {
    const std::string said =
        log + ": message " + std::to_string(there.size() + 1) + " of " + topic->name;
    there.push_back(ros::from_cdr<PlannerCall>(bag.read(message), said));
  }
  // Not by their times: a plan is of a time to come.
  std::stable_sort(there.begin(), there.end(), [](const PlannerCall& a, const PlannerCall& b) {
    return a.sequence < b.sequence;
  });
  std::size_t n = 0;
  while (n < there.size() && there[n].sequence == n) ++n;
  const BagFile::Fields* dropped = bag.metadata(topic::kDropped);
  calls.more = n < there.size() || (dropped && dropped->count(topic::kPlannerCalls) > 0);
  there.resize(n);
  return calls;
}

std::string log_of(const RecordedRun& run) {
  if (run.log) return run.source;
  const std::string log = (std::filesystem::path(run.source) / "mission.mcap").string();
  if (std::error_code error; !std::filesystem::exists(log, error)) {
    throw InputError(log + ": no such file; expected the log that drive writes");
  }
  return log;
}

/// The recorded steps by their number.
std::map<int, const StepRecord*> by_number(const RunRecord& record) {
  std::map<int, const StepRecord*> steps;
  for (const StepRecord& step : record.steps) steps[step.step] = &step;
  return steps;
}

/// A planner that is asked as the recorded one was, a call at a time.
class PlannerAskedAgain final : public RunObserver {
 public:
  /// What comes of it goes into `result`, whose record is that of the log. All outlive this.
  PlannerAskedAgain(const Configuration& configuration, const Registries& registries,
                    const ReplayOptions& options, DriveReplay& result)
      : options_(options),
        result_(result),
        recorded_(by_number(result.replay.record)),
        planner_(configuration.robot, configuration.planner,
                 registries.solvers.make(configuration.solver)),
        recorder_(configuration) {
    recorder_.watched_by({this});
  }
  PlannerAskedAgain(const PlannerAskedAgain&) = delete;
  PlannerAskedAgain& operator=(const PlannerAskedAgain&) = delete;

  /// said: what the call is in messages. Throws InputError for one that is damaged.
  void take(const PlannerCall& call, const std::string& said) {
    switch (call.kind) {
      case PlannerCall::kPrepare:
        planner_.prepare(reader_.belief(call, said));
        break;
      case PlannerCall::kPlan:
        plan(reader_.belief(call, said));
        break;
      case PlannerCall::kPlanned:
        compare(call, said);
        break;
      case PlannerCall::kTask:
        planner_.set_task(task_of(call, said));
        break;
      case PlannerCall::kMapFrame:
        reader_.take_map_frame(call, said);
        break;
      default:
        fail(said, "is of kind " + std::to_string(call.kind) + "; expected 0 to 4");
    }
  }

  /// Of the newest plan; -1: none.
  int step() const { return step_; }
  /// "after step 12 at 3.2 s", the newest that is recorded.
  std::string reached() const {
    if (!newest_) return "before the first step";
    return "after step " + std::to_string(newest_->step) + " at " +
           exact_text(std::round(1e3 * newest_->time) / 1e3) + " s";
  }

 private:
  void on_record(const StepRecord& record, const MissionStep&) override { made_ = record; }
  void plan(const Belief& belief) {
    plan_ = planner_.plan(belief);
    ++step_;
    if (!belief.ground) return;  // nothing can be planned, nothing was
    const auto found = recorded_.find(step_);
    const StepRecord* const recorded = found == recorded_.end() ? nullptr : found->second;
    if (recorded) newest_ = recorded;
    const std::shared_ptr<const GlobalPlan> global_plan = planner_.global_plan();
    const MissionStep shown{step_,
                            recorded ? recorded->time : belief.stamp,
                            &belief,
                            &plan_,
                            global_plan.get(),
                            0,
                            GuardReason::kPassed,
                            planner_.step()};
    recorder_.on_step(shown);
    if (options_.progress) options_.progress(made_);
    if (recorded && step_ >= options_.from) result_.replay.steps.push_back({*recorded, made_});
  }

  void compare(const PlannerCall& recorded, const std::string& said) {
    if (step_ < 0) fail(said, "a plan that nobody asked for; expected what drive wrote");
    ++result_.plans;
    if (result_.difference.step >= 0) return;
    const std::string what = difference_of(plan_, recorded);
    if (!what.empty()) result_.difference = {step_, what};
  }

  const ReplayOptions& options_;
  DriveReplay& result_;
  const std::map<int, const StepRecord*> recorded_;
  Planner planner_;
  RunRecorder recorder_;
  PlannerCallReader reader_;
  Plan plan_;
  StepRecord made_;  ///< what the recorder makes of it
  int step_ = -1;
  const StepRecord* newest_ = nullptr;
};

/// How many steps a drive had, as far as its record tells.
int steps_of(const RecordedRun& run, const RunRecord& logged) {
  int steps = static_cast<int>(run.rows.size());
  for (const StepRecord& step : logged.steps) steps = std::max(steps, step.step + 1);
  return steps;
}

}  // namespace

DriveReplay replay_calls(const RecordedRun& run, const Configuration& configuration,
                         const Registries& registries, const ReplayOptions& options) {
  const std::string log = log_of(run);
  const BagFile bag = run.log ? *run.log : BagFile::open(log);
  const Calls calls = read_calls(bag, log);
  LoggedRun logged = read_logged_run(bag, log, registries);
  DriveReplay result;
  result.notes = std::move(logged.notes);
  result.replay.record = std::move(logged.record);
  result.steps = steps_of(run, result.replay.record);

  PlannerAskedAgain planner(configuration, registries, options, result);
  const auto cancelled = [&] { return options.cancelled && options.cancelled(); };
  const auto reached_end = [&] { return planner.step() >= options.to; };
  for (std::size_t n = 0; n < calls.there.size() && !reached_end() && !cancelled(); ++n) {
    planner.take(calls.there[n], log + ": call " + std::to_string(n) + " of the planner");
  }
  const bool all = !calls.more && result.plans >= result.steps;
  if (all || reached_end() || cancelled()) return result;
  result.missing =
      "call " + std::to_string(calls.there.size()) + " of the planner, " + planner.reached();
  if (result.plans == 0 || planner.step() < options.from) {
    fail(log, result.missing + ", is not in it; expected the calls up to step " +
                  std::to_string(std::max(options.from, 0)) + " at least");
  }
  return result;
}

}  // namespace prospect
