// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/shared_results.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/terms/exploration_gain.h"
#include "tests/engine/planning_scene.h"

namespace prospect::shared_results_test {
namespace {

/// Sum of the final x and y, worth sharing.
class Destination {
 public:
  struct Results : TermScratch {
    std::uint64_t stamp = 0;
    std::vector<double> sum;
  };
  const std::vector<double>& get(const TrajectoryBatch& t) const {
    SharedResults* shared = t.shared.get();
    if (!shared) throw std::logic_error("not shared");
    auto& r = shared->get<Results>(this, [] { return std::make_unique<Results>(); });
    if (r.stamp != shared->stamp()) {
      r.stamp = shared->stamp();
      ++computed;
      r.sum.clear();
      for (int b = 0; b < t.batch(); ++b) {
        r.sum.push_back(t.px(t.horizon.N, b) + t.py(t.horizon.N, b));
      }
    }
    return r.sum;
  }
  mutable int computed = 0;  // for the test
};

class DestinationCost final : public Term {
 public:
  explicit DestinationCost(std::shared_ptr<const Destination> destination)
      : destination_(std::move(destination)) {}
  std::string_view name() const override { return "destination"; }
  TermTraits traits() const override { return {}; }
  void evaluate(const TrajectoryBatch& t, const TermRequest&, TermScratch*,
                TermOutput& out) const override {
    const TrajectoryBatch copy = t;
    EXPECT_EQ(copy.shared.get(), nullptr);
    const std::vector<double>& sum = destination_->get(t);
    for (int b = 0; b < t.batch(); ++b) {
      EXPECT_EQ(sum[static_cast<std::size_t>(b)], t.px(t.horizon.N, b) + t.py(t.horizon.N, b));
      out.value(0, b) = sum[static_cast<std::size_t>(b)];
    }
  }

 private:
  std::shared_ptr<const Destination> destination_;
};

TEST(SharedResults, ComputedOncePerEvaluationAndWorkspaceAndNeverStale) {
  const auto destination = std::make_shared<const Destination>();
  ProblemDefinition d;
  d.model = make_model("unicycle");
  d.x0 = Eigen::VectorXd::Zero(3);
  d.u_previous = Eigen::VectorXd::Zero(2);
  for (int i = 0; i < 3; ++i) d.terms.push_back({std::make_shared<DestinationCost>(destination)});
  const Problem problem(std::move(d));
  Workspace one = problem.make_workspace(), two = problem.make_workspace();
  Evaluation e;
  int expected = 0;
  for (int round = 0; round < 20; ++round) {
    for (Workspace* w : {&one, &two}) {
      problem.evaluate(Eigen::MatrixXd::Random(problem.num_variables(), 1 + round % 3),
                       Evaluate::kValue, *w, e);
      EXPECT_EQ(destination->computed, ++expected);
    }
  }
  const Workspace moved = std::move(one);
  EXPECT_EQ(problem.rollout(Eigen::VectorXd::Zero(problem.num_variables())).shared.get(), nullptr);
}

TEST(SharedResults, SharedViewsGiveTheBitsOfSeparateOnes) {
  // The gain is both a cost and the prior of the features; with two gains of equal content nothing
  // is shared between them.
  const test::PlanningScene scene("unicycle_accel", {}, 150);
  const Problem& shared = *scene.problem;
  std::vector<Eigen::Vector3d> points;
  ExplorationTargets targets;
  std::mt19937_64 random(3);
  for (int i = 0; i < 150; ++i) {
    targets.targets.push_back(
        {{test::uniform(random, -4, 4), test::uniform(random, -4, 4), 0.45}, 0.1});
  }
  targets.reference_area = 2.0;
  const RobotDescription& robot = scene.planner->robot();
  const auto table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0.0, 0.0, 0.45}, 3.0, 0.3), targets.positions(), *scene.belief.voxels,
      OcclusionTable::Options());
  const auto prediction = std::make_shared<const VisibilityPrediction>(
      scene.planner->specification()->landmarks, robot.stereo, robot.stereo_mount, nullptr,
      VisibilityParameters());
  const auto gain = [&] {
    return std::make_shared<const ExplorationGain>(targets, robot.depth, robot.depth_mount, table);
  };
  VisibleFeaturesParameters features;
  features.rho = 5.0;
  const auto make = [&](std::shared_ptr<const ExplorationGain> prior,
                        std::shared_ptr<const ExplorationGain> cost) {
    ProblemDefinition d = shared.definition();
    d.terms = {{std::make_shared<VisibleFeatures>(prediction, features, prior), 1.0}, {cost, -1.0}};
    return Problem(std::move(d));
  };
  const auto both = gain();
  const Problem together = make(both, both), apart = make(gain(), gain());
  Workspace w = together.make_workspace(), v = together.make_workspace(),
            u = apart.make_workspace();
  const Eigen::MatrixXd X = scene.points(12, random);
  Evaluation a, b, c;
  for (int round = 0; round < 12; ++round) {
    const bool gradient = round % 3 == 0;
    const int B = gradient ? 1 : (round % 2 ? 1 + round % 5 : 12);
    const auto columns = X.middleCols(B == 12 ? 0 : round % 6, B);
    const Evaluate what = gradient ? Evaluate::kGradient : Evaluate::kValue;
    together.evaluate(columns, what, w, a);
    apart.evaluate(columns, what, u, c);
    // Another workspace in between, elsewhere.
    together.evaluate(X.rightCols(1), what, v, b);
    ASSERT_TRUE((a.cost == c.cost).all());
    if (gradient) {
      ASSERT_TRUE((a.gradient.array() == c.gradient.array()).all());
      EXPECT_GT(a.gradient.norm(), 0.0);
    }
    // Terms on their own, outside of a problem.
    for (int i = 0; i < B; ++i) {
      TrajectoryBatch t = together.rollout(columns.col(i));
      TermOutput out;
      out.value.setZero(1, 1);
      double cost = 0.0;
      for (const auto& [term, weight] : together.definition().terms) {
        const auto scratch = term->make_scratch(t.horizon, 1);
        term->evaluate(t, {false}, scratch.get(), out);
        cost += weight * out.value(0, 0);
      }
      ASSERT_EQ(cost, a.cost[i]);
    }
  }
}

}  // namespace
}  // namespace prospect::shared_results_test
