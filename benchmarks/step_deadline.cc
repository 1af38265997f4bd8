// SPDX-License-Identifier: Apache-2.0
// How well a planning step keeps its deadline, over the beliefs of a mission.
//   step_deadline [WORLD] [--deadline MS] [--steps N] [--seed S] [--solver NAME] [--known M]
// Drives the mission in lockstep, each step with that deadline and prepared as the real-time driver
// does, and prints what preparing and the steps took, in wall time and in processor time of all
// threads, in all and by their parts, and by how much the deadline was overrun; besides, what the
// guard's check of one command of each plan costs.
// Processor time is what counts where others keep the machine busy; there the wall clock ends the
// polishing earlier. The floor is what a step takes that has no time to polish
// (--deadline 0.001).
// --known: instead of a mission, rooms of M by M metres that are known, but for each fifth, from
// the first step on; a robot that drives as it is told, and no time between the steps.
#include <octomap/OcTree.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "engine/planner/planner.h"
#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"
#include "runtime/next_command.h"
#include "solvers/registry.h"
#include "tests/engine/known_rooms.h"

namespace prospect {
namespace {

/// Times each step of the planner that it stands for.
class TimedPlanner final : public Replanner {
 public:
  TimedPlanner(std::unique_ptr<Planner> planner, std::vector<PlanTimes>& times,
               std::vector<double>& prepared, std::vector<double>& processor,
               std::vector<double>& guard)
      : planner_(std::move(planner)),
        check_(planner_->make_guard()),
        times_(times),
        prepared_(prepared),
        processor_(processor),
        guard_(guard) {}
  Plan plan(const Belief& belief) override {
    // A step with a deadline does a part of its work in a thread that it waits for.
    ProcessorStopwatch watch(CLOCK_PROCESS_CPUTIME_ID);
    planner_->prepare(belief);
    prepared_.push_back(watch.lap());
    Plan plan = planner_->plan(belief);
    processor_.push_back(watch.lap());
    times_.push_back(plan.times);
    if (plan.certified) {
      // As a command thread asks, at the plan's first stage.
      const Twist previous = belief.command.value_or(belief.twist);
      TimedCommand asked;
      asked.hold = 0.15;
      const NextCommand next = next_command(*planner_->robot().model, plan, 1.0, belief.pose,
                                            previous, belief.stamp, asked.step);
      asked.input = next.input;
      asked.pose = belief.pose;
      watch.lap();
      check_.check(plan, asked, previous, belief, belief.stamp);
      guard_.push_back(watch.lap());
    }
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return planner_->global_plan(); }
  std::shared_ptr<const PlanningStep> step() const override { return planner_->step(); }
  std::string set_task(const Task& task) override { return planner_->set_task(task); }

 private:
  std::unique_ptr<Planner> planner_;
  Guard check_;
  std::vector<PlanTimes>& times_;
  std::vector<double>&prepared_, &processor_, &guard_;
};

void print(const char* name, const std::vector<double>& ms) {
  std::printf("  %-16s %8.2f %8.2f %8.2f %8.2f\n", name, quantile(ms, 0.5), quantile(ms, 0.95),
              quantile(ms, 0.99), quantile(ms, 1.0));
}

/// Steps of a robot that drives as it is told, in rooms that are known. Returns how many of the
/// first ones were not whole yet.
int drive_known_rooms(const Configuration& configuration, Replanner& planner, double side,
                      int steps) {
  Belief belief;
  test::give_rooms(belief, side);
  belief.octree = std::make_shared<const octomap::OcTree>(0.1);
  belief.landmarks = test::landmarks_about(300);
  belief.tracked_features = 80;
  belief.command = Twist();
  const MotionModel& model = *configuration.robot.model;
  int unfinished = 0;
  for (int n = 0; n < steps; ++n) {
    belief.set_stamps(configuration.planner.dt * n);
    const Plan plan = planner.plan(belief);
    if (plan.fault == PlanFault::kUnfinished) ++unfinished;
    Eigen::VectorXd next(model.nx());
    model.step(model.state(belief.pose, belief.twist), plan.inputs.front(), plan.dt, next);
    belief.pose = model.pose(next);
    belief.twist = plan.commands.front();
    belief.command = belief.twist;
  }
  return unfinished;
}

int measure(int argc, char** argv) {
  std::string world = "office", solver = "nlopt";
  double deadline_ms = 20.0, known = 0.0;
  int steps = 300;
  int seed = 1;
  ProgramOptions program("How well a planning step keeps its deadline");
  program.add("world", world, "Built-in name or file");
  program.add("--deadline", deadline_ms, "Of a step [ms]", {.least = 1e-3, .most = 1e6});
  program.add("--steps", steps, "Of the mission", {.least = 1});
  program.add("--seed", seed, "Of all noise", {.least = 0});
  program.add("--solver", solver, "Back end");
  program.add("--known", known, "Side of rooms that are known, instead of a mission [m]",
              {.least = 0.0, .most = 1000.0});
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;
  Configuration configuration = read_configuration("");
  configuration.solver = solver;
  configuration.planner.deadline = 1e-3 * deadline_ms;
  configuration.mission.time_limit = 1e6;
  std::vector<PlanTimes> times;
  std::vector<double> prepared, processor, guard;
  ExplorationRunOptions options;
  options.seed = static_cast<std::uint64_t>(seed);
  options.keep_steps = false;
  options.cancelled = [&] { return static_cast<int>(times.size()) >= steps; };
  options.make_planner = [&](const Configuration& c) -> std::unique_ptr<Replanner> {
    return std::make_unique<TimedPlanner>(
        std::make_unique<Planner>(c.robot, c.planner, SolverRegistry().make(c.solver)), times,
        prepared, processor, guard);
  };
  if (known > 0.0) {
    world = "known rooms";
    const int unfinished =
        drive_known_rooms(configuration, *options.make_planner(configuration), known, steps);
    double ms = 0.0;
    for (std::size_t n = 0; n <= static_cast<std::size_t>(unfinished) && n < processor.size();
         ++n) {
      ms += prepared[n] + processor[n];
    }
    std::printf("%g m known: %d steps before the first plan, processor time with it %.0f ms\n",
                known, unfinished, ms);
  } else {
    const auto loaded =
        std::make_shared<const World>(load_world(world, world_options_for(configuration)));
    run_exploration(loaded, configuration, options);
  }

  const auto part = [&](const auto& ms) {
    std::vector<double> all;
    for (const PlanTimes& t : times) all.push_back(ms(t));
    return all;
  };
  std::printf("%s, seed %d, %s, deadline %g ms: %zu steps\n", world.c_str(), seed, solver.c_str(),
              deadline_ms, times.size());
  std::printf("  %-16s %8s %8s %8s %8s  [ms]\n", "", "p50", "p95", "p99", "max");
  print("prepare, proc.", prepared);
  print("step, wall", part([](const PlanTimes& t) { return t.total; }));
  print("step, processor", processor);
  print("facts", part([](const PlanTimes& t) { return t.frontier_planner; }));
  print("clearance", part([](const PlanTimes& t) { return t.clearance; }));
  print("views", part([](const PlanTimes& t) { return t.views; }));
  print("seeds", part([](const PlanTimes& t) { return t.seeds; }));
  print("polish", part([](const PlanTimes& t) { return t.polish; }));
  print("certificate", part([](const PlanTimes& t) { return t.certify; }));
  print("guard, proc.", guard);
  const auto overrun = [&](std::vector<double> ms) {
    for (double& t : ms) t = std::max(0.0, t - deadline_ms);
    return ms;
  };
  print("overrun, wall", overrun(part([](const PlanTimes& t) { return t.total; })));
  print("overrun, proc.", overrun(processor));
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("step_deadline", prospect::measure, argc, argv);
}
