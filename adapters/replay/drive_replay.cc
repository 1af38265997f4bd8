#include "adapters/replay/drive_replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "adapters/datasets/bag_file.h"
#include "adapters/datasets/mission_topics.h"
#include "adapters/files/input_error.h"
#include "adapters/log/logged_run.h"
#include "adapters/log/planner_calls.h"
#include "adapters/ros/cdr.h"
#include "adapters/run/run_recorder.h"
#include "adapters/run/unmeasured.h"
#include "engine/planner/planner.h"
#include "models/range_text.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// How a plan differs from the recorded one; "" if all that is recorded of it is the same.
std::string difference_of(const Plan& plan, const PlannerCall& recorded) {
  std::string difference;
  const auto compare = [&](const char* name, double was, double is) {
    const bool same = was == is || (std::isnan(was) && std::isnan(is));
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
  if (!topic || topic->messages.empty()) {
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

}  // namespace

DriveReplay replay_calls(const RecordedRun& run, const Configuration& configuration,
                         const Registries& registries, const ReplayOptions& options) {
  DriveReplay result;
  const std::string log = log_of(run);
  const BagFile bag = run.log ? *run.log : BagFile::open(log);
  const auto [calls, more] = read_calls(bag, log);
  LoggedRun logged = read_logged_run(bag, log, registries);
  result.notes = std::move(logged.notes);
  result.replay.record = std::move(logged.record);
  std::map<int, const StepRecord*> recorded;
  for (const StepRecord& step : result.replay.record.steps) recorded[step.step] = &step;
  result.steps = std::max(static_cast<int>(run.rows.size()),
                          recorded.empty() ? 0 : recorded.rbegin()->first + 1);

  Planner planner(configuration.robot, configuration.planner,
                  registries.solvers.make(configuration.solver));
  ExplorationRunOptions observed;
  observed.keep_steps = true;
  StepRecord made;
  observed.on_step = [&](const StepRecord& step) { made = step; };
  RunRecorder recorder(configuration, observed, &planner);
  Unmeasured unmeasured;
  PlannerCallReader reader;
  Plan plan;
  int step = -1;                       // of the newest plan
  const StepRecord* newest = nullptr;  // that is recorded
  for (std::size_t n = 0; n < calls.size() && step < options.to; ++n) {
    if (options.cancelled && options.cancelled()) break;
    const PlannerCall& call = calls[n];
    const std::string said = log + ": call " + std::to_string(n) + " of the planner";
    if (call.kind == PlannerCall::kTask) {
      planner.set_task(task_of(call, said));
      continue;
    }
    if (call.kind == PlannerCall::kPlanned) {
      if (step < 0) fail(said, "a plan that nobody asked for; expected what drive wrote");
      ++result.plans;
      if (const std::string what = difference_of(plan, call);
          !what.empty() && result.difference.step < 0) {
        result.difference = {step, what};
      }
      continue;
    }
    const Belief belief = reader.belief(call, said);
    if (call.kind == PlannerCall::kPrepare) {
      planner.prepare(belief);
      continue;
    }
    plan = planner.plan(belief);
    ++step;
    if (!belief.ground) continue;  // nothing can be planned, nothing was
    const std::shared_ptr<const GlobalPlan> global_plan = planner.global_plan();
    const auto found = recorded.find(step);
    if (found != recorded.end()) newest = found->second;
    const double time = found == recorded.end() ? belief.stamp : found->second->time;
    const MissionStep shown{step, time, &belief, &plan, global_plan.get(), 0, GuardReason::kPassed};
    recorder.add(shown, unmeasured.at(shown));
    if (options.progress) options.progress(made);
    if (step >= options.from && found != recorded.end()) {
      result.replay.steps.push_back({*found->second, made});
    }
  }
  const bool cancelled = options.cancelled && options.cancelled();
  if (cancelled || step >= options.to || (!more && result.plans >= result.steps)) return result;
  result.missing = "call " + std::to_string(calls.size()) + " of the planner, " +
                   (newest ? "after step " + std::to_string(newest->step) + " at " +
                                 exact_text(std::round(1e3 * newest->time) / 1e3) + " s"
                           : "before the first step");
  if (result.plans == 0 || step < options.from) {
    fail(log, result.missing + ", is not in it; expected the calls up to step " +
                  std::to_string(std::max(options.from, 0)) + " at least");
  }
  return result;
}

}  // namespace prospect
