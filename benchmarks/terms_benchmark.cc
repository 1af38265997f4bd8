// SPDX-License-Identifier: Apache-2.0
// Time of one evaluation of the planning problem and of what it is made of, at the planner's
// default sizes (N = 20, 300 landmarks, 200 targets), in a half-explored hall.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/features/occlusion_table.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/clearance_field.h"
#include "engine/safety/certificate.h"
#include "tests/engine/planning_scene.h"

namespace prospect {
namespace {

const test::PlanningScene& scene() {
  static const test::PlanningScene scene = [] {
    PlannerParameters parameters;
    parameters.weights.heading_alignment = 0.1;
    return test::PlanningScene("unicycle_accel", parameters);
  }();
  return scene;
}

Eigen::MatrixXd points(int B) {
  std::mt19937_64 random(7);
  return scene().points(B, random);
}

void term(benchmark::State& state, const std::shared_ptr<const Term>& term, bool gradient) {
  const Horizon& horizon = scene().problem->horizon();
  std::vector<TrajectoryBatch> trajectories;
  for (int b = 0; b < 16; ++b) {
    trajectories.push_back(scene().problem->rollout(points(16).col(b)));
  }
  const auto scratch = term->make_scratch(horizon, 1);
  TermOutput out;
  out.value.setZero(term->rows(horizon), 1);
  out.state_gradient.setZero((horizon.N + 1) * horizon.nx(), 1);
  out.input_gradient.setZero(horizon.N * horizon.nu(), 1);
  out.jacobian.setZero(std::max(horizon.nx(), horizon.nu()),
                       static_cast<Eigen::Index>(term->jacobian_pattern(horizon).size()));
  std::size_t n = 0;
  for (auto _ : state) {
    term->evaluate(trajectories[n++ % trajectories.size()], {gradient}, scratch.get(), out);
    benchmark::DoNotOptimize(out.value.data());
  }
}

void problem_single(benchmark::State& state, Evaluate what) {
  const Problem& problem = *scene().problem;
  const Eigen::MatrixXd X = points(16);
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  Eigen::Index n = 0;
  for (auto _ : state) {
    problem.evaluate(X.col(n++ % X.cols()), what, workspace, evaluation);
    benchmark::DoNotOptimize(evaluation.cost.data());
  }
}

void problem_batch(benchmark::State& state, Evaluate what) {
  const Problem& problem = *scene().problem;
  const Eigen::MatrixXd X = points(static_cast<int>(state.range(0)));
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  for (auto _ : state) {
    problem.evaluate(X, what, workspace, evaluation);
    benchmark::DoNotOptimize(evaluation.cost.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));  // candidates
}

OcclusionTable occlusion_table(int num_points, double reach) {
  std::mt19937_64 random(3);
  std::vector<Eigen::Vector3d> at;
  for (int i = 0; i < num_points; ++i) {
    at.emplace_back(test::uniform(random, -5, 5), test::uniform(random, -5, 5),
                    test::uniform(random, 0.1, 1.5));
  }
  return OcclusionTable(SensorLattice::around({0.0, 0.0, 0.45}, reach, 0.3), std::move(at),
                        *scene().belief.voxels, OcclusionTable::Options());
}

void occlusion_table_evaluate(benchmark::State& state, bool gradient) {
  const int n = static_cast<int>(state.range(0));
  const OcclusionTable table = occlusion_table(n, 2.0);
  std::vector<double> p(static_cast<std::size_t>(n)), x(p), y(p);
  double step = 0.0;
  for (auto _ : state) {
    step = step > 1.0 ? 0.0 : step + 0.013;
    if (gradient) {
      table.evaluate({step, 0.3 * step, 0.45}, p.data(), x.data(), y.data());
    } else {
      table.evaluate({step, 0.3 * step, 0.45}, p.data());
    }
    benchmark::DoNotOptimize(p.data());
  }
}

void occlusion_table_build(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(occlusion_table(static_cast<int>(state.range(0)), 2.0));
  }
}

void clearance_field_build(benchmark::State& state) {
  const Belief& belief = scene().belief;
  for (auto _ : state) {
    benchmark::DoNotOptimize(ClearanceField(belief.pose.position, *belief.voxels, *belief.ground,
                                            ClearanceField::Options()));
  }
}

void clearance_field_distance(benchmark::State& state) {
  const Belief& belief = scene().belief;
  const ClearanceField field(belief.pose.position, *belief.voxels, *belief.ground,
                             ClearanceField::Options());
  Eigen::Vector3d p(0.0, 0.0, 0.3), gradient;
  for (auto _ : state) {
    p.x() = p.x() > 2.0 ? 0.0 : p.x() + 0.013;
    benchmark::DoNotOptimize(field.distance(p, &gradient));
  }
}

void certificate(benchmark::State& state) {
  const Planner& planner = *scene().planner;
  const Certifier certifier(planner.robot().shape, Certifier::options_for(planner.robot()));
  const ProblemDefinition& d = scene().problem->definition();
  Eigen::MatrixXd inputs(d.model->nu(), 2);
  for (int k = 0; k < 2; ++k) inputs.col(k) = 0.5 * d.model->limits().upper;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        certifier.certify(scene().belief, *d.model, d.x0, d.u_previous, inputs, d.dt));
  }
}

void guide_update(benchmark::State& state) {
  // Every second state of the map differs in one cell, as a map does from step to step.
  FrontierPlanner frontier_planner(scene().planner->parameters().frontier_planner);
  GroundMap ground = *scene().belief.ground;
  double stamp = 0.0;
  bool explored = true;
  for (auto _ : state) {
    explored = !explored;
    ground.set({42, 0}, explored ? CellState::kFree : CellState::kUnknown);
    benchmark::DoNotOptimize(frontier_planner.update(ground, scene().belief.pose, stamp += 0.5));
  }
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  using namespace prospect;
  for (const auto& weighted : scene().problem->definition().terms) {
    const std::string name(weighted.term->name());
    for (const bool gradient : {false, true}) {
      benchmark::RegisterBenchmark(
          ("term/" + name + (gradient ? "/gradient" : "/value")).c_str(),
          [=](benchmark::State& state) { term(state, weighted.term, gradient); });
    }
  }
  benchmark::RegisterBenchmark("problem/value", problem_single, Evaluate::kValue);
  benchmark::RegisterBenchmark("problem/gradient", problem_single, Evaluate::kGradient);
  for (const Evaluate what : {Evaluate::kValue, Evaluate::kScore}) {
    const char* name = what == Evaluate::kScore ? "problem/scores" : "problem/batch";
    benchmark::RegisterBenchmark(name, problem_batch, what)
        ->Arg(30)
        ->Arg(1000)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("occlusion_table/value", occlusion_table_evaluate, false)->Arg(300);
  benchmark::RegisterBenchmark("occlusion_table/gradient", occlusion_table_evaluate, true)
      ->Arg(300);
  benchmark::RegisterBenchmark("occlusion_table/build", occlusion_table_build)
      ->Arg(300)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("clearance_field/build", clearance_field_build)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("clearance_field/distance", clearance_field_distance);
  benchmark::RegisterBenchmark("certificate", certificate);
  benchmark::RegisterBenchmark("frontier_planner/update", guide_update)
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
