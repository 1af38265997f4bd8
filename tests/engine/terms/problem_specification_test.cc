// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/problem_specification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/engine/problem_specifications.h"
#include "tests/engine/room_belief.h"
#include "tests/engine/same_problem.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::test::problem_specification_test {
namespace {

std::set<std::string> terms(const Problem& problem) {
  std::set<std::string> names;
  for (const auto& t : problem.definition().terms) names.insert(std::string(t.term->name()));
  return names;
}

TEST(ProblemSpecification, MakesTheProblemThatThePlannerSolvedBitForBitAlsoWithItsMapsCut) {
  NOT_UNDER_SANITIZERS("the release build compares bits");
  std::set<std::string> met;
  for (const NamedSpecification& named : specifications_of_every_kind()) {
    SCOPED_TRACE(named.name);
    ASSERT_NE(named.specification, nullptr);
    ASSERT_NE(named.problem, nullptr);
    expect_same_problem(*named.problem, *make_problem(*named.specification));
    const ProblemSpecification cut = with_maps_cut(*named.specification);
    EXPECT_LT(cut.voxels->data().size(), named.specification->voxels->data().size());
    EXPECT_LE(cut.ground->frame().size(), named.specification->ground->frame().size());
    expect_same_problem(*named.problem, *make_problem(cut), 2);
    met.merge(terms(*named.problem));
  }
  for (const char* term : {"control_effort", "input_rate", "obstacles", "visible_features",
                           "exploration_gain", "cost_to_go", "heading_alignment", "clearance",
                           "braking", "known_space", "rate_limit", "speed_limit"}) {
    EXPECT_EQ(met.count(term), 1u) << term;
  }
}

TEST(ProblemSpecification, CuttingTwiceCutsNoMore) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  for (const char* model : {"unicycle", "multirotor"}) {
    PlannerParameters parameters;
    parameters.N = parameters.M = 6;
    parameters.visibility.r_max = 2.0;
    const ProblemSpecification once =
        with_maps_cut(*specification_of(model, model, parameters).specification);
    const ProblemSpecification twice = with_maps_cut(once);
    EXPECT_EQ(once.voxels->frame(), twice.voxels->frame());
    EXPECT_EQ(once.voxels->k0(), twice.voxels->k0());
    EXPECT_EQ(once.voxels->data(), twice.voxels->data());
    EXPECT_EQ(once.ground->frame(), twice.ground->frame());
    EXPECT_EQ(once.ground->cells().data, twice.ground->cells().data);
  }
}

// A world whose every voxel is drawn at random: nothing that a ray or a distance meets may change.
TEST(ProblemSpecification, CutsNothingThatIsLookedAtInAWorldOfNoise) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  for (const char* model : {"holonomic", "multirotor"}) {
    SCOPED_TRACE(model);
    PlannerParameters parameters;
    parameters.N = parameters.M = 5;
    parameters.visibility.r_max = 2.0;
    parameters.max_targets = 30;
    ProblemSpecification specification = *specification_of(model, model, parameters).specification;
    std::mt19937_64 random(7);
    auto voxels = std::make_shared<VoxelGrid>(*specification.voxels);
    const GridFrame frame = voxels->frame();
    auto ground = std::make_shared<GroundMap>(frame);
    for (int n = 0; n < frame.size(); ++n) {
      const Cell c = frame.at(n);
      for (int k = voxels->k0(); k < voxels->k0() + voxels->depth(); ++k) {
        const double p = uniform(random, 0, 1);
        voxels->set(c.i, c.j, k,
                    p < 0.02   ? CellState::kOccupied
                    : p < 0.15 ? CellState::kUnknown
                               : CellState::kFree);
      }
      ground->set(c, uniform(random, 0, 1) < 0.05 ? CellState::kUnknown : CellState::kFree);
    }
    specification.voxels = voxels;
    specification.ground = ground;
    const ProblemSpecification cut = with_maps_cut(specification);
    EXPECT_LT(cut.voxels->data().size(), voxels->data().size());
    expect_same_problem(*make_problem(specification), *make_problem(cut), 3, 60);
  }
}

TEST(ProblemSpecification, ARobotBesideItsMapHasAProblemToo) {
  const PlanningScene scene("unicycle", {}, 20);
  Planner planner(scene.planner->robot(), {}, std::make_shared<IdleSolver>());
  for (Belief belief : {empty_belief(), Room().belief()}) {
    for (const double x : {0.0, 30.0, -30.0}) {
      belief.pose.position.x() = x;
      planner.plan(belief);
      ASSERT_NE(planner.specification(), nullptr);
      expect_same_problem(*planner.problem(),
                          *make_problem(with_maps_cut(*planner.specification())));
    }
  }
}

TEST(ProblemSpecification, IsOfTheLastStepAndThereIsNoneWhereNoneWasMet) {
  PlanningScene scene("unicycle", {}, 20);
  Planner& planner = *scene.planner;
  ASSERT_NE(planner.specification(), nullptr);
  EXPECT_FALSE(planner.seeds().empty());
  const auto cost = [&](const Seed& seed) { return planner.problem()->explain(seed.z); };
  EXPECT_LE(cost(planner.seeds().front()).violation, cost(planner.seeds().back()).violation);
  Belief belief = scene.belief;
  belief.pose.yaw = std::numeric_limits<double>::quiet_NaN();
  planner.plan(belief);
  EXPECT_EQ(planner.specification(), nullptr);
  EXPECT_EQ(planner.problem(), nullptr);
  EXPECT_TRUE(planner.seeds().empty());
  belief.pose.yaw = 0.1;
  planner.plan(belief);
  ASSERT_NE(planner.specification(), nullptr);
  EXPECT_EQ(planner.specification()->x0[2], 0.1);
}

TEST(ProblemSpecification, SaysWhatIsMissing) {
  const ProblemSpecification sound = *specification_of("unicycle", "unicycle", {}).specification;
  const auto refused = [](const ProblemSpecification& specification) -> std::string {
    try {
      make_problem(specification);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refused(sound), "");
  ProblemSpecification r = sound;
  r.voxels = nullptr;
  EXPECT_EQ(refused(r), "problem: no voxels; expected one");
  r = sound;
  r.ground = nullptr;
  EXPECT_EQ(refused(r), "problem: no ground map; expected one");
  r = sound;
  r.cost_to_go = nullptr;
  EXPECT_EQ(refused(r), "problem: no cost-to-go; expected one");
  r = sound;
  r.robot.model = nullptr;
  EXPECT_EQ(refused(r), "problem: no motion model; expected one");
  CachedEvaluators none;
  EXPECT_THROW(assemble_problem(sound, none), std::invalid_argument);
  EXPECT_THROW(VoxelGrid(GridFrame{0.1, 0, 0, 2, 2}, 0, 2, std::vector<CellState>(7)),
               std::invalid_argument);
  EXPECT_THROW(VoxelGrid(GridFrame{0.1, 0, 0, -2, -2}, 0, 2, std::vector<CellState>(8)),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::test::problem_specification_test
