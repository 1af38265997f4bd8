// SPDX-License-Identifier: Apache-2.0
// How the cost of an evaluation grows with what it is made of: landmarks and exploration targets
// (a term alone, N = 20) from 100 to 10,000, stages (the planner's problem over the same five
// seconds) from 10 to 100. The last lines printed are the exponents: least squares of log time over
// log size, of the least processor time of all repetitions, and the exponent between the two
// largest sizes alone.
//
//   build/benchmarks/scaling_benchmark --benchmark_repetitions=5

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/features/occlusion_table.h"
#include "engine/terms/exploration_gain.h"
#include "engine/terms/visible_features.h"
#include "models/unicycle.h"
#include "tests/engine/planning_scene.h"

namespace prospect {
namespace {

using test::uniform;

constexpr int kTrajectories = 16;

/// A term with the trajectories it is evaluated at, one after the other.
void term(benchmark::State& state, const Term& term, bool gradient) {
  static const Unicycle model;
  std::mt19937_64 random(5);
  std::vector<TrajectoryBatch> trajectories;
  for (int b = 0; b < kTrajectories; ++b) {
    trajectories.push_back(test::random_trajectories(model, 20, 0.25, 1, random));
  }
  const Horizon& horizon = trajectories.front().horizon;
  const auto scratch = term.make_scratch(horizon, 1);
  TermOutput out = visibility_scene::output(trajectories.front());
  std::size_t n = 0;
  for (auto _ : state) {
    term.evaluate(trajectories[n++ % trajectories.size()], {gradient}, scratch.get(), out);
    benchmark::DoNotOptimize(out.value.data());
  }
}

/// Line of sight of these points from all positions the trajectories come to.
std::shared_ptr<const OcclusionTable> occlusion(const std::vector<Eigen::Vector3d>& points) {
  std::mt19937_64 random(3);
  static const VoxelGrid hall = test::hall(random, true, 25);
  return std::make_shared<const OcclusionTable>(SensorLattice::around({0.0, 0.0, 0.45}, 4.0, 0.3),
                                                points, hall, OcclusionTable::Options());
}

void landmarks(benchmark::State& state, bool gradient) {
  std::mt19937_64 random(1);
  std::vector<Landmark> all = visibility_scene::landmarks(random, static_cast<int>(state.range(0)));
  // As select_landmarks orders them.
  std::sort(all.begin(), all.end(), [](const Landmark& a, const Landmark& b) {
    return std::atan2(a.position.y(), a.position.x()) < std::atan2(b.position.y(), b.position.x());
  });
  std::vector<Eigen::Vector3d> points;
  for (const Landmark& l : all) points.push_back(l.position);
  const VisibleFeatures features(
      std::make_shared<const VisibilityPrediction>(all, StereoCamera(), CameraMount(),
                                                   occlusion(points), VisibilityParameters()),
      VisibleFeaturesParameters());
  term(state, features, gradient);
}

void targets(benchmark::State& state, bool gradient) {
  std::mt19937_64 random(2);
  ExplorationTargets all;
  for (int i = 0; i < state.range(0); ++i) {
    const double x = uniform(random, -5, 5), y = uniform(random, -5, 5);
    all.targets.push_back({{x, y, 0.45}, uniform(random, 0.01, 0.16)});
  }
  term(state, ExplorationGain(all, RgbdFootprint(), CameraMount(), occlusion(all.positions())),
       gradient);
}

/// The planner's problem with N stages in five seconds; M knots, 0: one a stage.
void stages(benchmark::State& state, Evaluate what, int M) {
  PlannerParameters parameters;
  parameters.N = static_cast<int>(state.range(0));
  parameters.M = M > 0 ? M : parameters.N;
  parameters.dt = 5.0 / parameters.N;
  const test::PlanningScene scene("unicycle_accel", parameters);
  std::mt19937_64 random(7);
  const Eigen::MatrixXd X = scene.points(kTrajectories, random);
  Workspace workspace = scene.problem->make_workspace();
  Evaluation evaluation;
  Eigen::Index n = 0;
  for (auto _ : state) {
    scene.problem->evaluate(X.col(n++ % X.cols()), what, workspace, evaluation);
    benchmark::DoNotOptimize(evaluation.cost.data());
  }
}

/// Prints the runs as usual, then the exponent of each family of runs.
class ExponentReporter final : public benchmark::ConsoleReporter {
 public:
  ExponentReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.run_name.args.empty()) continue;
      const double seconds = run.cpu_accumulated_time / static_cast<double>(run.iterations);
      auto& sizes = families_[run.run_name.function_name];
      const auto [at, first] = sizes.try_emplace(std::stod(run.run_name.args), seconds);
      if (!first) at->second = std::min(at->second, seconds);
    }
    ConsoleReporter::ReportRuns(runs);
  }

  void Finalize() override {
    std::ostream& out = GetOutputStream();
    out << "\nfamily: microseconds at each size; exponent over all, over the last two sizes\n";
    for (const auto& [name, sizes] : families_) {
      if (sizes.size() < 2) continue;
      double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
      out << name << ':';
      for (const auto& [size, seconds] : sizes) {
        out << "  " << size << ": " << 1e6 * seconds;
        const double u = std::log(size), v = std::log(seconds);
        n += 1.0;
        x += u;
        y += v;
        xx += u * u;
        xy += u * v;
      }
      const auto last = std::prev(sizes.end()), before = std::prev(last);
      out << ";  " << (n * xy - x * y) / (n * xx - x * x) << ", "
          << std::log(last->second / before->second) / std::log(last->first / before->first)
          << '\n';
    }
  }

 private:
  std::map<std::string, std::map<double, double>> families_;
};

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  using namespace prospect;
  const auto over_points = [](const std::string& name, auto run, bool gradient) {
    auto* family = benchmark::RegisterBenchmark(name.c_str(), run, gradient);
    for (const int n : {100, 300, 1000, 3000, 10000}) family->Arg(n);
    family->Unit(benchmark::kMicrosecond);
  };
  over_points("landmarks/value", landmarks, false);
  over_points("landmarks/gradient", landmarks, true);
  over_points("targets/value", targets, false);
  over_points("targets/gradient", targets, true);
  const auto over_stages = [](const std::string& name, Evaluate what, int M) {
    auto* family = benchmark::RegisterBenchmark(name.c_str(), stages, what, M);
    for (const int N : {10, 20, 50, 100}) family->Arg(N);
    family->Unit(benchmark::kMicrosecond);
  };
  over_stages("stages/value", Evaluate::kValue, 10);
  over_stages("stages/gradient", Evaluate::kGradient, 10);
  over_stages("stages_and_knots/gradient", Evaluate::kGradient, 0);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  ExponentReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
}
