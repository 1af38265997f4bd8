// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "engine/problem/problem.h"
#include "models/unicycle.h"
#include "tests/engine/problem_specifications.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::test::residual_form_test {
namespace {

Eigen::VectorXd random_point(const Problem& problem, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Eigen::VectorXd z(problem.num_variables());
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    z[i] = problem.lower()[i] + unit(random) * (problem.upper()[i] - problem.lower()[i]);
  }
  return z;
}

/// The cost is what the residuals say, bit for bit the cost of any other evaluation, and their
/// Jacobian is that of differences.
void expect_sum_of_squares(const Problem& problem, const Eigen::VectorXd& z, bool differences) {
  Workspace workspace = problem.make_workspace(), other = problem.make_workspace();
  Evaluation e, value, gradient;
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kResiduals, workspace, e));
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kValue, other, value));
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kGradient, other, gradient));
  EXPECT_EQ(e.cost[0], value.cost[0]);
  EXPECT_EQ(e.constraints, value.constraints);
  EXPECT_EQ(e.jacobian, gradient.jacobian);
  const double scale = 1.0 + std::abs(e.residual_offset);
  EXPECT_NEAR(e.residual_offset + 0.5 * e.residuals.squaredNorm(), e.cost[0], 1e-11 * scale);
  EXPECT_LE((e.gradient - gradient.gradient).cwiseAbs().maxCoeff(),
            1e-9 * (1.0 + gradient.gradient.cwiseAbs().maxCoeff()));
  if (!differences) return;
  constexpr double kStep = 1e-6;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    Eigen::VectorXd low = z, high = z;
    low[i] -= kStep;
    high[i] += kStep;
    Evaluation a, b;
    ASSERT_TRUE(problem.evaluate(low, Evaluate::kResiduals, workspace, a));
    ASSERT_TRUE(problem.evaluate(high, Evaluate::kResiduals, workspace, b));
    const Eigen::VectorXd slope = (b.residuals - a.residuals) / (2.0 * kStep);
    for (Eigen::Index r = 0; r < slope.size(); ++r) {
      ASSERT_NEAR(e.residual_jacobian(r, i), slope[r], 2e-5 * std::max(1.0, std::abs(slope[r])))
          << "row " << r << ", variable " << i;
    }
  }
}

TEST(ResidualForm, OfEveryTermIsItsCost) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(3);
  std::set<std::string> met;
  for (const NamedSpecification& named : specifications_of_every_kind()) {
    for (const auto& weighted : named.problem->definition().terms) {
      if (weighted.term->traits().kind != TermKind::kCost) continue;
      SCOPED_TRACE(named.name + ", " + std::string(weighted.term->name()));
      ProblemDefinition d = named.problem->definition();
      d.terms = {weighted};
      const Problem alone(d);
      ASSERT_EQ(alone.terms_without_residuals(), "");
      if (weighted.weight != 0.0) met.insert(std::string(weighted.term->name()));
      for (int trial = 0; trial < 4; ++trial) {
        expect_sum_of_squares(alone, random_point(alone, random), trial == 0);
      }
    }
  }
  EXPECT_THAT(met, ::testing::UnorderedElementsAre("control_effort", "input_rate", "obstacles",
                                                   "visible_features", "exploration_gain",
                                                   "cost_to_go", "heading_alignment"));
}

TEST(ResidualForm, OfAWholeProblemIsItsCost) {
  std::mt19937_64 random(4);
  for (const NamedSpecification& named : specifications_of_every_kind()) {
    SCOPED_TRACE(named.name);
    for (int trial = 0; trial < 4; ++trial) {
      expect_sum_of_squares(*named.problem, random_point(*named.problem, random), false);
    }
  }
}

/// x_N: a cost that is no sum of squares unless it is told its bound.
class LastX final : public Term {
 public:
  explicit LastX(std::optional<double> bound) : bound_(bound) {}
  std::string_view name() const override { return "last x"; }
  TermTraits traits() const override { return {.unit = "m", .normalisation = "none"}; }
  std::optional<ResidualForm> residual_form(const Horizon&, int sign) const override {
    if (!bound_ || sign < 0) return std::nullopt;
    return ResidualForm{*bound_, 0, {}};
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      out.value(0, b) = t.px(t.horizon.N, b);
      if (request.gradient) out.add_pose_gradient(t, t.horizon.N, b, 1, 0, 0, 0);
    }
  }

 private:
  std::optional<double> bound_;
};

Problem last_x(std::optional<double> bound, double weight) {
  ProblemDefinition d;
  d.model = std::make_shared<Unicycle>(Unicycle::Parameters{});
  d.x0 = Eigen::Vector3d::Zero();
  d.u_previous = Eigen::Vector2d::Zero();
  d.N = 4;
  d.M = 2;
  d.terms.push_back({std::make_shared<LastX>(bound), weight});
  return Problem(d);
}

TEST(ResidualForm, MayBeNoMoreThanABound) {
  std::mt19937_64 random(5);
  const Problem problem = last_x(-3.0, 0.7);
  for (int trial = 0; trial < 5; ++trial) {
    expect_sum_of_squares(problem, random_point(problem, random), true);
  }
}

TEST(ResidualForm, IsAskedForInVainOfATermThatHasNone) {
  const Problem none = last_x(std::nullopt, 1.0), wrong_sign = last_x(-3.0, -1.0);
  for (const Problem* problem : {&none, &wrong_sign}) {
    EXPECT_EQ(problem->terms_without_residuals(), "'last x'");
    Workspace workspace = problem->make_workspace();
    Evaluation e;
    try {
      problem->evaluate(Eigen::VectorXd::Zero(4), Evaluate::kResiduals, workspace, e);
      FAIL() << "nothing thrown";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("'last x'"));
    }
  }
  // What has no weight needs no form.
  EXPECT_EQ(last_x(std::nullopt, 0.0).terms_without_residuals(), "");
}

TEST(ResidualForm, SaysSoIfACostIsBelowItsBound) {
  const Problem problem = last_x(0.5, 1.0);
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  EXPECT_THROW(problem.evaluate(Eigen::VectorXd::Zero(4), Evaluate::kResiduals, workspace, e),
               std::domain_error);
}

}  // namespace
}  // namespace prospect::test::residual_form_test
