#include "adapters/replay/drive_replay.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "adapters/datasets/bag_file.h"
#include "adapters/datasets/mission_topics.h"
#include "adapters/files/input_error.h"
#include "adapters/log/logged_run.h"
#include "adapters/ros/cdr.h"
#include "adapters/run/run_recorder.h"
#include "adapters/run/unmeasured.h"
#include "engine/planner/planner.h"
#include "models/range_text.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// How a plan differs from the recorded one; "" if its bits are the same.
std::string difference_of(const Plan& plan, const PlannerCall& recorded) {
  const auto differs = [](const char* name, const auto& was, const auto& is) {
    return std::string(name) + ": " + exact_text(static_cast<double>(was)) + " recorded, " +
           exact_text(static_cast<double>(is)) + " now";
  };
  if (plan_hash(plan) == recorded.plan_hash) return "";
  if (plan.explanation.cost != recorded.cost) {
    return differs("cost", recorded.cost, plan.explanation.cost);
  }
  if (plan.counters.cost_evaluations != recorded.cost_evaluations) {
    return differs("cost evaluations", recorded.cost_evaluations, plan.counters.cost_evaluations);
  }
  return "the plan, of the same cost";
}

}  // namespace

std::vector<PlannerCall> read_planner_calls(const std::string& log) {
  if (std::error_code error; !std::filesystem::exists(log, error)) {
    throw InputError(log + ": no such file; expected the log that drive writes");
  }
  const BagFile bag = BagFile::open(log);
  const BagTopic* topic = bag.find(topic::kPlannerCalls);
  if (!topic || topic->messages.empty()) {
    throw InputError(log + ": no " + topic::kPlannerCalls +
                     ", from which a planner can be asked again; expected the log of a drive");
  }
  if (topic->type != PlannerCall::kType) {
    throw InputError(log + ": " + topic->name + " is of " + topic->type + "; expected " +
                     PlannerCall::kType);
  }
  std::vector<PlannerCall> calls;
  for (const BagTopic::Message& message : topic->messages) {
    const std::string said =
        log + ": message " + std::to_string(calls.size() + 1) + " of " + topic->name;
    calls.push_back(ros::from_cdr<PlannerCall>(bag.read(message), said));
  }
  // Not by their times: a plan is of a time to come.
  std::stable_sort(calls.begin(), calls.end(), [](const PlannerCall& a, const PlannerCall& b) {
    return a.sequence < b.sequence;
  });
  for (std::size_t n = 0; n < calls.size(); ++n) {
    if (calls[n].sequence == n) continue;
    calls.resize(n);
    break;
  }
  return calls;
}

DriveReplay replay_calls(const std::string& log, const Configuration& configuration,
                         const Registries& registries, const ReplayOptions& options) {
  DriveReplay result;
  const std::vector<PlannerCall> calls = read_planner_calls(log);
  result.replay.record = read_logged_run(log, registries).record;
  std::map<int, const StepRecord*> recorded;
  for (const StepRecord& step : result.replay.record.steps) recorded[step.step] = &step;

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
  int step = -1;  // of the newest plan
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
    const double time = found == recorded.end() ? belief.stamp : found->second->time;
    const MissionStep shown{step, time, &belief, &plan, global_plan.get(), 0, GuardReason::kPassed};
    recorder.add(shown, unmeasured.at(shown));
    if (options.progress) options.progress(made);
    if (step >= options.from && found != recorded.end()) {
      result.replay.steps.push_back({*found->second, made});
    }
  }
  return result;
}

}  // namespace prospect
