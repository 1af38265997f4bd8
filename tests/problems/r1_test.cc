// SPDX-License-Identifier: Apache-2.0
#include "problems/r1.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "problems/r1_kernel.h"
#include "solvers/registry.h"

namespace prospect::r1_test {
namespace {

/// J written down as it is stated, without the shortcuts of the terms.
double stated_cost(const Eigen::Vector3d& x0, const Eigen::VectorXd& z) {
  const auto uniform = [](std::mt19937& g, double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(g);
  };
  const auto s = [](double a) { return 0.5 * (1.0 + std::tanh(0.05 * a)); };
  double px = x0[0], py = x0[1], theta = x0[2], J = 0.0, before = 0.0;
  for (int k = 0; k < 20; ++k) {
    const double v = z[2 * k], w = z[2 * k + 1];
    J += 0.05 * w * w + 0.1 * std::pow(v - 0.5, 2) + 0.2 * std::pow(w - before, 2);
    before = w;
    px += 0.2 * v * std::cos(theta);
    py += 0.2 * v * std::sin(theta);
    theta += 0.2 * w;
    std::mt19937 discs(7), points(11), blobs(13);
    for (int j = 0; j < 12; ++j) {
      const double x = uniform(discs, 1.0, 5.0), y = uniform(discs, -2.5, 2.5);
      const double d = std::hypot(px - x, py - y) - 0.25;
      J += 20.0 * 0.5 * (1.0 - std::tanh(8.0 * (d - 0.35)));
    }
    double n = 0.0;
    for (int i = 0; i < 150; ++i) {
      const double x = uniform(points, 2.0, 8.0), y = uniform(points, -4.0, 4.0),
                   height = uniform(points, 0.2, 2.2);
      const double zc = std::cos(theta) * (x - px) + std::sin(theta) * (y - py);
      const double xc = std::sin(theta) * (x - px) - std::cos(theta) * (y - py);
      if (zc <= 0.05) continue;
      const double u = 450.0 * xc / zc + 320.0, r = 450.0 * (0.5 - height) / zc + 240.0;
      n += s(u) * s(640.0 - u) * s(r) * s(480.0 - r) / (1.0 + std::exp(-(zc - 0.5) / 0.1));
    }
    J += 0.5 * std::log1p(std::exp((20.0 - n) / 5.0));
    for (int i = 0; i < 10; ++i) {
      const double x = uniform(blobs, 2.0, 7.0), y = uniform(blobs, -4.0, 4.0);
      J -= 0.3 * std::exp(-(std::pow(px + 1.5 * std::cos(theta) - x, 2) +
                            std::pow(py + 1.5 * std::sin(theta) - y, 2)) /
                          (2.0 * 0.8 * 0.8));
    }
  }
  return J;
}

double cost(const Problem& problem, const Eigen::VectorXd& z) { return problem.explain(z).cost; }

Eigen::VectorXd random_inputs(std::mt19937& generator) {
  std::uniform_real_distribution<double> speed(0.0, 0.7), turn(-1.0, 1.0);
  Eigen::VectorXd z(40);
  for (int k = 0; k < 20; ++k) z.segment<2>(2 * k) << speed(generator), turn(generator);
  return z;
}

TEST(R1, HasItsCheckValue) {
  EXPECT_NEAR(cost(make_r1(), r1_cold()), 404.3937943800, 404.0 * 1e-12);
}

TEST(R1, CostsWhatItStates) {
  std::mt19937 generator(3);
  for (const Eigen::Vector3d& x0 : r1_starts(17, 30)) {
    const Problem problem = make_r1(x0);
    for (int i = 0; i < 5; ++i) {
      const Eigen::VectorXd z = random_inputs(generator);
      const double stated = stated_cost(x0, z);
      EXPECT_NEAR(cost(problem, z), stated, 1e-9 * std::abs(stated));
    }
  }
}

TEST(R1, HasTheGradientOfItsCost) {
  std::mt19937 generator(5);
  for (const Eigen::Vector3d& x0 : r1_starts(18, 20)) {
    const Problem problem = make_r1(x0);
    Workspace workspace = problem.make_workspace();
    Evaluation e, value;
    const Eigen::VectorXd z = random_inputs(generator);
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kGradient, workspace, e));
    problem.evaluate(z, Evaluate::kValue, workspace, value);
    EXPECT_EQ(e.cost[0], value.cost[0]);
    for (int i = 0; i < 40; ++i) {
      // Five points: the error of the formula stays below that of rounding.
      const double h = 1e-4;
      const auto at = [&](double step) {
        Eigen::VectorXd moved = z;
        moved[i] += step;
        return cost(problem, moved);
      };
      const double difference = (8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h);
      EXPECT_NEAR(e.gradient[i], difference, 1e-6 * std::max(1.0, e.gradient.norm())) << i;
    }
  }
}

TEST(R1, EvaluatesABatchLikeOneByOne) {
  std::mt19937 generator(7);
  const Problem problem = make_r1();
  Eigen::MatrixXd Z(40, 33);
  for (int b = 0; b < Z.cols(); ++b) Z.col(b) = random_inputs(generator);
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  ASSERT_TRUE(problem.evaluate(Z, Evaluate::kValue, workspace, e));
  for (int b = 0; b < Z.cols(); ++b) EXPECT_EQ(e.cost[b], cost(problem, Z.col(b)));
}

TEST(R1, ScoresAreWithinTheirErrorFromEveryStart) {
  std::mt19937 generator(8);
  for (const Eigen::Vector3d& x0 : r1_starts(17, 30)) {
    const Problem problem = make_r1(x0);
    Eigen::MatrixXd Z(40, 50);
    for (int b = 0; b < Z.cols(); ++b) Z.col(b) = random_inputs(generator);
    Workspace workspace = problem.make_workspace();
    Evaluation value, score;
    ASSERT_TRUE(problem.evaluate(Z, Evaluate::kValue, workspace, value));
    ASSERT_TRUE(problem.evaluate(Z, Evaluate::kScore, workspace, score));
    EXPECT_TRUE(((score.cost - value.cost).abs() <= 0.5 * score.cost_error).all());
    EXPECT_LT((score.cost_error / value.cost.abs().max(1.0)).maxCoeff(), 2e-3);
  }
}

TEST(R1, HasFiniteGradientsAtAwkwardPoses) {
  // In a disc's centre, and with a point 5 cm before the lens, where images are far off.
  const double disc_x = 1.909356, disc_y = -0.905139, point_x = 2.409841, point_y = 1.317763;
  std::vector<Eigen::Vector3d> poses = {{disc_x, disc_y, 0.0}, {0, 0, 3.14159}, {1e4, -1e4, 1e3}};
  for (const double ahead : {0.0, 0.0499, 0.0501, 0.06}) {
    poses.emplace_back(point_x - ahead, point_y, 0.0);
    poses.emplace_back(point_x - ahead, point_y + 2.0, 0.0);
  }
  for (const Eigen::Vector3d& x0 : poses) {
    const Problem problem = make_r1(x0);
    Workspace workspace = problem.make_workspace();
    Evaluation e;
    EXPECT_TRUE(problem.evaluate(Eigen::VectorXd::Zero(40), Evaluate::kGradient, workspace, e));
    EXPECT_NEAR(e.cost[0], stated_cost(x0, Eigen::VectorXd::Zero(40)),
                1e-9 * std::max(1.0, std::abs(e.cost[0])));
  }
}

TEST(R1Kernel, GivesTheSameBitsForEveryInstructionSet) {
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> place(-4.0, 8.0), depth(-1.7, 0.3);
  constexpr int n = 16;
  std::vector<double> x(n), y(n), down(n);
  for (int i = 0; i < n; ++i) {
    x[static_cast<std::size_t>(i)] = place(generator);
    y[static_cast<std::size_t>(i)] = place(generator);
    down[static_cast<std::size_t>(i)] = depth(generator);
  }
  const auto expect_same = [](const R1Value& a, const R1Value& b) {
    EXPECT_EQ(a.value, b.value);
    EXPECT_EQ(a.d_px, b.d_px);
    EXPECT_EQ(a.d_py, b.d_py);
    EXPECT_EQ(a.d_theta, b.d_theta);
  };
  const R1Kernel generic = r1_kernel(InstructionSet::kGeneric);
  for (const InstructionSet set : available_instruction_sets()) {
    SCOPED_TRACE(name(set));
    const R1Kernel kernel = r1_kernel(set);
    for (double theta = -3.0; theta < 3.0; theta += 0.1) {
      const R1Pose pose{0.3 * theta, -theta, std::cos(theta), std::sin(theta)};
      expect_same(kernel.visible_gradient(pose, x.data(), y.data(), down.data(), n),
                  generic.visible_gradient(pose, x.data(), y.data(), down.data(), n));
      expect_same(kernel.collision_gradient(pose, x.data(), y.data(), n),
                  generic.collision_gradient(pose, x.data(), y.data(), n));
      expect_same(kernel.gain_gradient(pose, x.data(), y.data(), n),
                  generic.gain_gradient(pose, x.data(), y.data(), n));
      EXPECT_EQ(kernel.visible(pose, x.data(), y.data(), down.data(), n).value,
                generic.visible_gradient(pose, x.data(), y.data(), down.data(), n).value);
    }
  }
}

TEST(S30, StartsWhereItDid) {
  const std::vector<Eigen::Vector3d> starts = r1_starts(17, 30);
  ASSERT_EQ(starts.size(), 30U);
  // The first two numbers of std::mt19937(17) through the library's own distribution.
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const Eigen::Vector3d& x : starts) {
    EXPECT_NEAR(x[0], unit(generator) - 0.5, 1e-15);
    EXPECT_NEAR(x[1], unit(generator) - 0.5, 1e-15);
    EXPECT_NEAR(x[2], 1.2 * unit(generator) - 0.6, 1e-15);
  }
}

TEST(S30, BestKnownHasItsStatedMeanAndIsReached) {
  double mean = 0.0;
  for (const double J : s30_best_known()) mean += J / 30.0;
  EXPECT_NEAR(mean, 7.4425, 1e-3);  // as stated with the measurements
  // Reached, and not beaten, at the first start: this ties the order of the starts to the table's.
  const auto polish = make_solver("nlopt");
  const Problem problem = make_r1(r1_starts(17, 30)[0]);
  if (!polish->explain_unsupported(problem).empty()) GTEST_SKIP() << "needs NLopt";
  const Result seed = make_solver("sampling")->solve(problem, {}, {}, {});
  const Result r = polish->solve(problem, seed.next, {}, {});
  EXPECT_NEAR(r.cost, s30_best_known()[0], 1e-4);
}

TEST(S30, CountsAsSolvedWithinOnePercentOrAHundredth) {
  EXPECT_TRUE(r1_solved(0.3094, 0.3));
  EXPECT_FALSE(r1_solved(0.3101, 0.3));
  EXPECT_TRUE(r1_solved(88.8, 88.0));
  EXPECT_FALSE(r1_solved(88.9, 88.0));
}

}  // namespace
}  // namespace prospect::r1_test
