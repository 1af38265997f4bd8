// Time of one evaluation of R1 (problems/r1.h): value, gradient, a batch, each term, and the kernel
// of visible points in every vector width that this processor has.

#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "problems/r1.h"
#include "problems/r1_kernel.h"

namespace prospect {
namespace {

/// Random inputs within the bounds, a column a candidate.
Eigen::MatrixXd points(int B) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> speed(0.0, 0.7), turn(-1.0, 1.0);
  Eigen::MatrixXd X(40, B);
  for (int b = 0; b < B; ++b) {
    for (int k = 0; k < 20; ++k) X.col(b).segment<2>(2 * k) << speed(random), turn(random);
  }
  return X;
}

/// A call evaluates `batch` candidates.
void evaluate(benchmark::State& state, const Problem& problem, Evaluate what, int batch) {
  const Eigen::MatrixXd X = points(16 * batch);
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  Eigen::Index n = 0;
  for (auto _ : state) {
    problem.evaluate(X.middleCols(batch * (n++ % 16), batch), what, workspace, evaluation);
    benchmark::DoNotOptimize(evaluation.cost.data());
  }
  state.SetItemsProcessed(state.iterations() * batch);  // candidates
}

Problem of_one_term(const ProblemDefinition::WeightedTerm& term) {
  ProblemDefinition d = make_r1().definition();
  d.terms = {term};
  return Problem(d);
}

void visible_points(benchmark::State& state, InstructionSet set, bool gradient) {
  constexpr int n = R1Kernel::padded(150);
  const R1Kernel kernel = r1_kernel(set);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> along(2.0, 8.0), across(-4.0, 4.0), height(0.2, 2.2);
  std::vector<double> x(n), y(n), down(n);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = along(random);
    y[i] = across(random);
    down[i] = 0.5 - height(random);
  }
  const auto visible = gradient ? kernel.visible_gradient : kernel.visible;
  R1Pose pose{0.0, 0.0, 1.0, 0.0};
  for (auto _ : state) {
    pose.px = pose.px > 1.0 ? 0.0 : pose.px + 0.013;
    benchmark::DoNotOptimize(visible(pose, x.data(), y.data(), down.data(), n));
  }
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  using namespace prospect;
  const Problem r1 = make_r1();
  const auto add = [](const std::string& name, const Problem& problem, Evaluate what, int batch) {
    benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State& state) { evaluate(state, problem, what, batch); });
  };
  add("r1/value", r1, Evaluate::kValue, 1);
  add("r1/gradient", r1, Evaluate::kGradient, 1);
  add("r1/batch/32", r1, Evaluate::kValue, 32);
  for (const auto& term : r1.definition().terms) {
    const std::string name(term.term->name());
    add("r1/term/" + name + "/value", of_one_term(term), Evaluate::kValue, 1);
    add("r1/term/" + name + "/gradient", of_one_term(term), Evaluate::kGradient, 1);
  }
  for (const InstructionSet set : available_instruction_sets()) {
    for (const bool gradient : {false, true}) {
      const std::string width(name(set));
      benchmark::RegisterBenchmark(
          ("r1/visible_points/" + width + (gradient ? "/gradient" : "/value")).c_str(),
          [=](benchmark::State& state) { visible_points(state, set, gradient); });
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
