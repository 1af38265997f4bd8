// SPDX-License-Identifier: Apache-2.0
// feature_prediction [--worlds LIST] [--seeds N] [--first-seed N] [--time-limit T] [--sensors S]:
// the number of visible features that the planner predicts against the number tracked, by the time
// ahead. At each step of a mission the plan's own prediction is evaluated along the way that was
// then really driven (the estimated poses of the steps that followed), so that replanning does not
// count as an error; at the end of the committed part, as the plan said it. Errors are divided by
// the tracked number or N_min, whichever is more, as in docs/results/experiments.md. Same
// arguments, same numbers.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/study/mission_start.h"
#include "benchmarks/program_options.h"
#include "engine/planner/planner.h"

namespace prospect {
namespace {

struct Errors {
  int count = 0;
  double predicted = 0.0, tracked = 0.0, bias = 0.0, magnitude = 0.0;

  void add(double prediction, double truth, double N_min) {
    const double e = (prediction - truth) / std::max(truth, N_min);
    ++count;
    predicted += prediction;
    tracked += truth;
    bias += e;
    magnitude += std::abs(e);
  }
  void print(const char* name) const {
    if (count == 0) return;
    std::printf("%-20s %6d %10.1f %9.1f %+8.1f %% %8.1f %%\n", name, count, predicted / count,
                tracked / count, 100.0 * bias / count, 100.0 * magnitude / count);
  }
};

/// A step, and what its plan would have predicted for any way.
struct Step {
  double time;
  Pose pose;
  double tracked;
  bool comparable;  ///< with a plan, and neither lost then
  double predicted;
  double predicted_at;  ///< [s]
  std::shared_ptr<const ProblemSpecification> specification;
};

class Comparison final : public RunObserver {
 public:
  /// committed [s]: of a plan.
  Comparison(int stages, double dt, double N_min, double committed)
      : stages_(stages),
        dt_(dt),
        N_min_(N_min),
        committed_time_(committed),
        ahead_(static_cast<std::size_t>(stages) + 1) {}

  void on_record(const StepRecord& r, const MissionStep& step) override {
    const auto specification = step.made ? step.made->specification : nullptr;
    const bool comparable = specification != nullptr && r.plan_kind != PlanKind::kStoppingTail &&
                            r.localization != Localization::kLost;
    add({r.time, r.estimated_pose, static_cast<double>(r.tracked_features), comparable,
         r.predicted_features, committed_time_, specification});
  }

  void add(Step step) {
    if (!steps_.empty()) {
      const Step& last = steps_.back();
      if (last.comparable && std::abs(step.time - last.time - last.predicted_at) < 1e-6) {
        committed_.add(last.predicted, step.tracked, N_min_);
      }
      // A plan that was broken off by the guard: the times no longer fit.
      const double stage = (step.time - steps_.front().time) / dt_;
      if (std::abs(stage - std::round(stage)) > 1e-6) steps_.clear();
    }
    steps_.push_back(std::move(step));
    while (!steps_.empty() && steps_.back().time - steps_.front().time > stages_ * dt_ - 1e-6) {
      compare();
      steps_.pop_front();
    }
  }
  void end_of_mission() { steps_.clear(); }

  void print() const {
    std::printf("%-20s %6s %10s %9s %10s %10s\n", "ahead", "steps", "predicted", "tracked", "bias",
                "|error|");
    committed_.print("plan, committed part");
    for (int k = 2; k <= stages_; k += 2) {
      char name[32];
      std::snprintf(name, sizeof name, "%.1f s", k * dt_);
      ahead_[static_cast<std::size_t>(k)].print(name);
    }
  }

 private:
  /// The prediction of the oldest step along what was driven since.
  void compare() {
    const Step& first = steps_.front();
    if (!first.comparable || first.specification->N != stages_) return;
    const MotionModel& model = *first.specification->robot.model;
    TrajectoryBatch t;
    t.horizon = {&model, stages_, dt_};
    t.layout = model.pose_layout();
    t.u_previous = first.specification->u_previous;
    t.states.setZero((stages_ + 1) * model.nx(), 1);
    t.inputs.setZero(stages_ * model.nu(), 1);
    std::size_t i = 0;
    for (int k = 0; k <= stages_; ++k) {
      const double time = first.time + k * dt_;
      while (i + 1 < steps_.size() && steps_[i + 1].time < time - 1e-6) ++i;
      const Step& a = steps_[i];
      const Step& b = steps_[std::min(i + 1, steps_.size() - 1)];
      const double share =
          b.time > a.time ? std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0) : 0.0;
      // Where the pose was found again, or corrected by much, it jumps.
      if ((b.pose.position - a.pose.position).norm() >
          1.5 * model.max_speed() * (b.time - a.time) + 0.05)
        return;
      Pose pose;
      pose.position = a.pose.position + share * (b.pose.position - a.pose.position);
      pose.yaw = a.pose.yaw + share * std::remainder(b.pose.yaw - a.pose.yaw, 2.0 * M_PI);
      t.states.col(0).segment(k * model.nx(), model.nx()) = model.state(pose, Twist{}).array();
    }
    CachedEvaluators evaluators;
    update_views(*first.specification, evaluators);
    const std::vector<double> visible = evaluators.visible_features->visible(t, 0);
    for (const Step& s : steps_) {
      const auto k = static_cast<std::size_t>(std::lround((s.time - first.time) / dt_));
      if (k >= 1 && k < ahead_.size()) ahead_[k].add(visible[k], s.tracked, N_min_);
    }
  }

  int stages_;
  double dt_, N_min_, committed_time_;
  std::deque<Step> steps_;
  Errors committed_;
  std::vector<Errors> ahead_;
};

int run(int argc, char** argv) {
  std::vector<std::string> worlds = {"office", "corridor", "loop", "plan:1", "plan:2"};
  int seeds = 1, first_seed = 11;
  double time_limit = 100.0;
  std::string sensors = "model", overlay;
  ProgramOptions options("Visible features: predicted against tracked, by the time ahead");
  options.add("--worlds", worlds, "as `prospect explore` takes them", {.commas = true});
  options.add("--seeds", seeds, "how many", {.least = 1, .most = 1000});
  options.add("--first-seed", first_seed, "the first of them", {.least = 1, .most = 100000});
  options.add("--time-limit", time_limit, "of a mission [s]", {.least = 1.0, .most = 1e6});
  options.add("--sensors", sensors, "model, camera", {.one_of = {"model", "camera"}});
  options.add("--config", overlay, "YAML text over the defaults");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  Configuration configuration =
      configuration_from_text(overlay, "--config", {}, {"simulator.sensors=" + sensors});
  configuration.mission.time_limit = time_limit;
  const PlannerParameters& planner = configuration.planner;
  Comparison comparison(planner.N, planner.dt, planner.features.N_min, planner.committed);
  for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
    for (const std::string& name : worlds) {
      World loaded = load_world(name, world_options_for(configuration));
      loaded.start = mission_start(loaded.start, roomy_columns(loaded, configuration),
                                   static_cast<std::uint64_t>(seed));
      ExplorationRunOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      options.keep_steps = false;
      options.observers = [&](const Configuration&) {
        return std::vector<RunObserver*>{&comparison};
      };
      const auto result =
          run_exploration(std::make_shared<const World>(std::move(loaded)), configuration, options);
      comparison.end_of_mission();
      const Summary& s = result.record.summary;
      std::fprintf(stderr, "%s, seed %d: %.0f s, coverage %.1f %%, losses %d, error %.3f m\n",
                   name.c_str(), seed, s.duration_s, 100.0 * s.coverage, s.losses,
                   s.localization_rmse_m);
    }
  }
  comparison.print();
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  try {
    return prospect::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "feature_prediction: %s\n", e.what());
    return 2;
  }
}
