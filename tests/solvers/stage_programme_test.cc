// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/stage_programme.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "problems/path_problem.h"
#include "problems/r1.h"
#include "solvers/sqp/quadratic_program.h"
#include "solvers/sqp/stage_curvature.h"

namespace prospect::stage_programme_test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Status = StageProgramme::Status;

/// A programme at some inputs of a problem, and at states that do not follow them.
class Drawn {
 public:
  Drawn(const Problem& problem, unsigned seed) : generator_(seed) {
    const Vector lower = problem.lower(), upper = problem.upper();
    const Eigen::Index nx = problem.horizon().nx(), nodes = problem.horizon().N + 1;
    const Vector z = lower + (upper - lower).cwiseProduct(vector(lower.size(), 0.0, 1.0));
    Workspace workspace = problem.make_workspace();
    Evaluation e;
    problem.evaluate(z, Evaluate::kStages, workspace, e);
    X = e.stages.states;
    X.rightCols(nodes - 1) += vector(nx * (nodes - 1), -0.1, 0.1).reshaped(nx, nodes - 1);
    problem.evaluate_states(z, X, workspace, e);
    curvature_.reset(static_cast<int>(nx), static_cast<int>(nodes));
    Matrix all(nx, nx * nodes);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const Matrix half = vector(nx * nx, -5.0, 5.0).reshaped(nx, nx);
      all.middleCols(k * nx, nx) = half + half.transpose();
    }
    curvature_.set_hessians(all);
    curvature_.project(0.01);
    P = curvature_.projections();
    H = e.stages.input_hessian;
    h = Vector::Constant(z.size(), 1e-3);
    g = 10.0 * vector(z.size(), -1.0, 1.0);
    drift = e.stages.drift;
    low = lower - z;
    high = upper - z;
    at = z;
    condensed = H;
    condensed.diagonal() += h;
    gradient = g;
    curvature_.condense(0.01, e.stages.sensitivity, drift, condensed, gradient);
  }
  Status solve(StageProgramme& programme) const {
    programme.linearise(X, at);
    return programme.solve(P, H, h, g, drift, low, high);
  }

  Matrix X, P, H, drift, condensed;
  Vector h, g, low, high, at, gradient;

 private:
  Vector vector(Eigen::Index n, double low_end, double high_end) {
    std::uniform_real_distribution<double> draw(low_end, high_end);
    return Vector::NullaryExpr(n, [&] { return draw(generator_); });
  }
  std::mt19937 generator_;
  StageCurvature curvature_;
};

/// Largest difference from the dense programme, and of the multipliers from the gradient.
void expect_as_dense(const Drawn& drawn, const StageProgramme& programme) {
  QuadraticProgram dense;
  ASSERT_EQ(dense.solve(drawn.condensed, drawn.gradient, Matrix(0, drawn.g.size()), Vector(0),
                        drawn.low, drawn.high),
            QuadraticProgram::Status::kSolved);
  EXPECT_LE((dense.x() - programme.x()).lpNorm<Eigen::Infinity>(), 1e-7);
  const Vector slope = drawn.condensed * programme.x() + drawn.gradient;
  EXPECT_LE((slope - programme.multipliers()).lpNorm<Eigen::Infinity>(), 1e-7);
  EXPECT_TRUE((programme.x().array() >= drawn.low.array()).all());
  EXPECT_TRUE((programme.x().array() <= drawn.high.array()).all());
}

TEST(StageProgramme, IsTheDenseProgrammeWithoutItsMatrix) {
  int rounds = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const Problem problem = make_r1();
    const Drawn drawn(problem, seed);
    StageProgramme programme(problem);
    ASSERT_EQ(drawn.solve(programme), Status::kSolved);
    expect_as_dense(drawn, programme);
    rounds += programme.rounds();
  }
  EXPECT_LE(rounds, 50 * 12);
}

// Several stages have the input of one knot.
TEST(StageProgramme, TakesMoveBlocking) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const PathProblem path = path_problem();
    ASSERT_LT(path.problem.definition().M, path.problem.horizon().N);
    const Drawn drawn(path.problem, seed);
    StageProgramme programme(path.problem);
    ASSERT_EQ(drawn.solve(programme), Status::kSolved);
    expect_as_dense(drawn, programme);
  }
}

TEST(StageProgramme, BeginsWithWhatWasAtABound) {
  const Problem problem = make_r1();
  Drawn drawn(problem, 7);
  StageProgramme programme(problem);
  ASSERT_EQ(drawn.solve(programme), Status::kSolved);
  EXPECT_GT(programme.rounds(), 1);
  drawn.g *= 1.0 + 1e-9;
  ASSERT_EQ(drawn.solve(programme), Status::kSolved);
  EXPECT_EQ(programme.rounds(), 1);
}

TEST(StageProgramme, SaysWhatItDoesNotTake) {
  const Problem problem = make_r1();
  Drawn drawn(problem, 9);
  StageProgramme programme(problem);
  drawn.H(38, 0) = drawn.H(0, 38) = 0.1;
  EXPECT_EQ(drawn.solve(programme), Status::kNotOfStages);
  drawn.H(38, 0) = drawn.H(0, 38) = 0.0;
  drawn.H.diagonal().array() -= 1e6;
  EXPECT_EQ(drawn.solve(programme), Status::kNotConvex);
}

}  // namespace
}  // namespace prospect::stage_programme_test
