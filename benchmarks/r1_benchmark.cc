// SPDX-License-Identifier: Apache-2.0
// Time of one evaluation of R1 (problems/r1.h): value, gradient, a batch, each term, the kernel of
// visible points in every vector width that this processor has, and value and gradient written by
// hand, without Problem, Term or model, as somebody would who has this one problem to solve.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
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

/// R1 by hand: fixed sizes, no allocation, one pass forward, one back; the same kernels for the
/// sums over points, discs and blobs.
class ByHand {
 public:
  ByHand() {
    std::mt19937 disc(7), point(11), blob(13);
    const auto draw = [](std::mt19937& g, double lower, double upper) {
      return std::uniform_real_distribution<double>(lower, upper)(g);
    };
    disc_x_.fill(1e3);
    disc_y_.fill(1e3);
    blob_x_.fill(1e3);
    blob_y_.fill(1e3);
    down_.fill(1e6);
    for (std::size_t i = 0; i < 12; ++i) {
      disc_x_[i] = draw(disc, 1.0, 5.0);
      disc_y_[i] = draw(disc, -2.5, 2.5);
    }
    for (std::size_t i = 0; i < 150; ++i) {
      point_x_[i] = draw(point, 2.0, 8.0);
      point_y_[i] = draw(point, -4.0, 4.0);
      down_[i] = 0.5 - draw(point, 0.2, 2.2);
    }
    for (std::size_t i = 0; i < 10; ++i) {
      blob_x_[i] = draw(blob, 2.0, 7.0);
      blob_y_[i] = draw(blob, -4.0, 4.0);
    }
  }

  /// J at z = (v_0, w_0, v_1, ...), and its gradient.
  double evaluate(const double* z, double* gradient) const {
    constexpr double dt = 0.2;
    R1Pose pose[kStages + 1];
    double d[kStages + 1][3];
    double J = 0.0, theta = 0.0;
    pose[0] = {0.0, 0.0, 1.0, 0.0};
    for (int k = 0; k < kStages; ++k) {
      const double v = z[2 * k];
      theta += dt * z[2 * k + 1];
      const R1Pose& p = pose[k];
      R1Pose& next = pose[k + 1];
      next = {p.px + dt * v * p.cos_theta, p.py + dt * v * p.sin_theta, std::cos(theta),
              std::sin(theta)};
      const R1Value hit = kernel_.collision_gradient(next, disc_x_.data(), disc_y_.data(),
                                                     static_cast<int>(disc_x_.size()));
      const R1Value seen = kernel_.visible_gradient(next, point_x_.data(), point_y_.data(),
                                                    down_.data(), static_cast<int>(down_.size()));
      const R1Value gain = kernel_.gain_gradient(next, blob_x_.data(), blob_y_.data(),
                                                 static_cast<int>(blob_x_.size()));
      const double e = std::exp((20.0 - seen.value) / 5.0);
      const double slope = -0.5 * 0.2 * e / (1.0 + e);
      J += 20.0 * hit.value + 0.5 * std::log1p(e) - 0.3 * gain.value;
      d[k + 1][0] = 20.0 * hit.d_px + slope * seen.d_px - 0.3 * gain.d_px;
      d[k + 1][1] = 20.0 * hit.d_py + slope * seen.d_py - 0.3 * gain.d_py;
      d[k + 1][2] = 20.0 * hit.d_theta + slope * seen.d_theta - 0.3 * gain.d_theta;
    }
    double x = 0.0, y = 0.0, turn = 0.0, next_change = 0.0;
    for (int k = kStages - 1; k >= 0; --k) {
      const R1Pose& p = pose[k];
      x += d[k + 1][0];
      y += d[k + 1][1];
      turn += d[k + 1][2];
      const double v = z[2 * k], w = z[2 * k + 1];
      const double change = w - (k > 0 ? z[2 * k - 1] : 0.0);
      J += 0.05 * w * w + 0.1 * (v - 0.5) * (v - 0.5) + 0.2 * change * change;
      gradient[2 * k] = dt * (x * p.cos_theta + y * p.sin_theta) + 0.2 * (v - 0.5);
      gradient[2 * k + 1] = dt * turn + 0.1 * w + 0.4 * change - 0.4 * next_change;
      turn += dt * v * (y * p.cos_theta - x * p.sin_theta);
      next_change = change;
    }
    return J;
  }

 private:
  static constexpr int kStages = 20;
  R1Kernel kernel_ = r1_kernel(best_instruction_set());
  std::array<double, R1Kernel::padded(12)> disc_x_{}, disc_y_{};
  std::array<double, R1Kernel::padded(150)> point_x_{}, point_y_{}, down_{};
  std::array<double, R1Kernel::padded(10)> blob_x_{}, blob_y_{};
};

void by_hand(benchmark::State& state, const Problem& problem) {
  const ByHand r1;
  const Eigen::MatrixXd X = points(16);
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  Eigen::VectorXd gradient(40);
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    problem.evaluate(X.col(i), Evaluate::kGradient, workspace, evaluation);
    const double J = r1.evaluate(X.col(i).data(), gradient.data());
    if (!(std::abs(J - evaluation.cost[0]) <= 1e-10 * std::abs(J)) ||
        !(gradient - evaluation.gradient).isZero(1e-8)) {
      state.SkipWithError("not the same function");
      return;
    }
  }
  Eigen::Index n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(r1.evaluate(X.col(n++ % 16).data(), gradient.data()));
    benchmark::ClobberMemory();
  }
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
  benchmark::RegisterBenchmark("r1/by_hand/gradient",
                               [&](benchmark::State& state) { by_hand(state, r1); });
  add("r1/batch/32", r1, Evaluate::kValue, 32);
  add("r1/score/32", r1, Evaluate::kScore, 32);
  add("r1/score/1000", r1, Evaluate::kScore, 1000);
  for (const auto& term : r1.definition().terms) {
    const std::string name(term.term->name());
    add("r1/term/" + name + "/value", of_one_term(term), Evaluate::kValue, 1);
    add("r1/term/" + name + "/score", of_one_term(term), Evaluate::kScore, 1);
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
