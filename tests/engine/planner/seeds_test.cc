// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/seeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/clearance_field.h"
#include "engine/problem/admissible_inputs.h"
#include "engine/support/stopwatch.h"
#include "engine/terms/control_effort.h"
#include "engine/terms/rate_limit.h"
#include "engine/terms/speed_limit.h"
#include "models/make_model.h"
#include "models/multirotor.h"

namespace prospect::seeds_test {
namespace {

/// The cost-to-go to one point [s], as the crow flies.
CostToGo towards(const Eigen::Vector2d& goal, double v_max) {
  Grid<double> seconds(GridFrame{0.1, -80, -80, 160, 160}, 0.0);
  for (int i = 0; i < seconds.frame.size(); ++i) {
    const Cell c = seconds.frame.at(i);
    seconds[c] = (seconds.frame.center(c) - goal).norm() / v_max;
  }
  return CostToGo(seconds, Grid<std::uint8_t>(seconds.frame, 1), v_max);
}

class Seeds : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const MotionModel> model_ = make_model(GetParam());
  std::mt19937_64 random_{11};

  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random_);
  }

  Problem problem(const Pose& pose, const Twist& twist, int N, int M) const {
    const InputLimits& limits = model_->limits();
    ProblemDefinition d;
    d.model = model_;
    d.x0 = model_->state(pose, twist);
    d.u_previous = model_->input(twist).cwiseMax(limits.lower).cwiseMin(limits.upper);
    d.N = N;
    d.M = M;
    d.terms = {{std::make_shared<ControlEffort>(Eigen::VectorXd::Zero(model_->nu()), limits), 1.0}};
    if (limits.rate.array().isFinite().any()) {
      d.terms.push_back({std::make_shared<RateLimit>(limits, M), 1.0});
    }
    if (model_->num_state_constraints() > 0) {
      d.terms.push_back({std::make_shared<SpeedLimit>(*model_), 1.0});
    }
    return Problem(d);
  }
  /// A velocity the model can have: half of its largest speeds at most, so that it can also turn
  /// them into each other.
  Twist possible_twist() {
    Twist t;
    t.linear.x() = uniform(0.0, 0.5) * model_->max_speed();
    t.yaw_rate = uniform(-1.0, 1.0) * model_->max_yaw_rate();
    if (model_->nu() > 2) t.linear.y() = uniform(-0.3, 0.3) * model_->max_speed();
    return t;
  }
  Pose random_pose() { return {{uniform(-3, 3), uniform(-3, 3), 0.0}, uniform(-9, 9)}; }

  /// Bounds, rates and speeds, by the constraint terms themselves.
  void expect_admissible(const Problem& p, const Seed& seed) {
    ASSERT_EQ(seed.z.size(), p.num_variables()) << seed.name;
    ASSERT_TRUE(seed.z.allFinite()) << seed.name;
    ASSERT_TRUE((seed.z.array() >= p.lower().array()).all()) << seed.name;
    ASSERT_TRUE((seed.z.array() <= p.upper().array()).all()) << seed.name;
    Workspace workspace = p.make_workspace();
    Evaluation e;
    ASSERT_TRUE(p.evaluate(seed.z, Evaluate::kValue, workspace, e)) << seed.name;
    ASSERT_LE(violation(e.constraints.col(0)), 1e-12) << seed.name;
  }
};

TEST_P(Seeds, KeepBoundsRatesAndSpeedsForEveryModelAndBlocking) {
  const CostToGo cost_to_go = towards({2.0, 1.0}, model_->max_speed());
  for (int trial = 0; trial < 60; ++trial) {
    const int N = 1 + static_cast<int>(random_() % 24);
    const int M = 1 + static_cast<int>(random_() % static_cast<unsigned>(N));
    const Problem p = problem(random_pose(), possible_twist(), N, M);
    SeedContext context;
    context.cost_to_go = &cost_to_go;
    if (trial % 2 == 0) context.target = FrontierTarget{0, {2.0, 1.0}, {3.0, 1.0}, 0.0};
    context.backwards = trial % 4 < 2;
    if (trial % 3 != 0) {
      // Whatever a previous plan was: it may have been stopped on the path.
      context.previous.resize(model_->nu(), 1 + static_cast<int>(random_() % 30));
      for (double& u : context.previous.reshaped()) u = uniform(-2, 2);
    }
    bool stops = false, previous = false;
    for (const Seed& seed : make_seeds(p, context)) {
      expect_admissible(p, seed);
      stops = stops || seed.stops;
      previous = previous || seed.name == "previous";
    }
    EXPECT_TRUE(stops);
    EXPECT_EQ(previous, context.previous.cols() > 0);
    stops = false;
    for (const Seed& seed : make_approach_seeds(p, context)) {
      expect_admissible(p, seed);
      stops = stops || seed.stops;
    }
    EXPECT_TRUE(stops);
  }
}

TEST_P(Seeds, StopEndsAtRest) {
  const CostToGo cost_to_go;
  for (int trial = 0; trial < 20; ++trial) {
    const Problem p = problem(random_pose(), possible_twist(), 20, 10);
    SeedContext context;
    context.cost_to_go = &cost_to_go;
    const std::vector<Seed> seeds = make_seeds(p, context);
    ASSERT_TRUE(seeds.back().stops);
    const TrajectoryBatch t = p.rollout(seeds.back().z);
    const Eigen::VectorXd x = t.states.col(0).tail(model_->nx()).matrix();
    const Eigen::VectorXd u = t.inputs.col(0).tail(model_->nu()).matrix();
    EXPECT_LT(model_->twist(x, u).linear.norm(), 1e-9);
    EXPECT_NEAR(model_->twist(x, u).yaw_rate, 0.0, 1e-9);
  }
}

TEST_P(Seeds, LeadDownTheCostToGoAndFaceTheTarget) {
  const Eigen::Vector2d goal(2.5, 1.5), looks_at(-2.0, 2.0);
  const CostToGo cost_to_go = towards(goal, model_->max_speed());
  const Problem p = problem({Eigen::Vector3d::Zero(), 0.5}, {}, 20, 10);
  SeedContext context;
  context.cost_to_go = &cost_to_go;
  context.target = FrontierTarget{0, goal, looks_at, 0.0};
  std::set<std::string> names;
  for (const Seed& seed : make_seeds(p, context)) {
    names.insert(seed.name);
    EXPECT_EQ(seed.name.find_first_of(",;\""), std::string::npos) << "in lists: " << seed.name;
    const TrajectoryBatch t = p.rollout(seed.z);
    const Pose end = t.pose(20, 0);
    const Eigen::Vector2d at = end.position.head<2>();
    if (seed.name == "follow") {
      EXPECT_LT((at - goal).norm(), goal.norm() - 1.0);
    }
    if (seed.name == "follow slowly") {
      EXPECT_LT((at - goal).norm(), goal.norm() - 0.5);
    }
    if (seed.name == "face") {
      const double heading = std::atan2(looks_at.y() - at.y(), looks_at.x() - at.x());
      EXPECT_LT(std::abs(std::remainder(end.yaw - heading, 2.0 * M_PI)), 0.2);
      EXPECT_LT(at.norm(), 0.05);
    }
    if (seed.name == "turn") {
      EXPECT_LT(at.norm(), 0.05);
    }
  }
  for (const char* name :
       {"follow", "follow slowly", "follow and look left", "follow and look right", "arc", "turn",
        "face", "face and go", "turn and go", "stop"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
}

TEST(BackwardSeeds, BackOutOfWhereTheBodyCannotTurn) {
  const auto model = make_model("unicycle", {{"v_min", -0.3}});
  const Eigen::Vector2d goal(-2.0, 0.1);  // behind the robot
  const CostToGo cost_to_go = towards(goal, model->max_speed());
  ProblemDefinition d;
  d.model = model;
  d.x0 = model->state(Pose(), Twist());
  d.u_previous = model->input(Twist());
  d.N = 20;
  d.M = 10;
  d.terms = {{std::make_shared<ControlEffort>(Eigen::VectorXd::Zero(2), model->limits()), 1.0}};
  const Problem p(d);
  SeedContext context;
  context.cost_to_go = &cost_to_go;
  context.target = FrontierTarget{0, goal, {-3.0, 0.0}, M_PI};
  const auto names = [](const std::vector<Seed>& seeds) {
    std::set<std::string> all;
    for (const Seed& seed : seeds) all.insert(seed.name);
    return all;
  };
  EXPECT_FALSE(names(make_seeds(p, context)).contains("follow backwards"));
  EXPECT_FALSE(names(make_approach_seeds(p, context)).contains("approach: go backwards"));
  context.backwards = true;
  int backing = 0;
  std::vector<Seed> seeds = make_seeds(p, context);
  for (Seed& seed : make_approach_seeds(p, context)) seeds.push_back(std::move(seed));
  for (const Seed& seed : seeds) {
    if (seed.name != "back" && seed.name != "follow backwards" &&
        seed.name != "follow backwards slowly" && seed.name != "approach: go backwards") {
      continue;
    }
    ++backing;
    const TrajectoryBatch t = p.rollout(seed.z);
    const Pose end = t.pose(20, 0);
    EXPECT_LT(end.position.x(), -0.7) << seed.name;
    for (int k = 0; k <= 20; ++k) EXPECT_LT(std::abs(t.pose(k, 0).yaw), 0.3) << seed.name;
  }
  EXPECT_EQ(backing, 4);
}

TEST_P(Seeds, AreTheSameBitsTwice) {
  const CostToGo cost_to_go = towards({2.0, 1.0}, model_->max_speed());
  const Problem p = problem(random_pose(), possible_twist(), 20, 10);
  SeedContext context;
  context.cost_to_go = &cost_to_go;
  context.target = FrontierTarget{0, {2.0, 1.0}, {3.0, 1.0}, 0.0};
  const auto a = make_seeds(p, context), b = make_seeds(p, context);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].z, b[i].z);
  }
}

TEST_P(Seeds, AdmissibleInputsLeaveAdmissibleOnesAlone) {
  const CostToGo cost_to_go = towards({2.0, 1.0}, model_->max_speed());
  for (int trial = 0; trial < 20; ++trial) {
    const Problem p = problem(random_pose(), possible_twist(), 20, 10);
    SeedContext context;
    context.cost_to_go = &cost_to_go;
    for (const Seed& seed : make_seeds(p, context)) {
      EXPECT_EQ(admissible_inputs(p, seed.z), seed.z) << seed.name;
    }
    Eigen::VectorXd wild(p.num_variables());
    for (double& u : wild) u = uniform(-1, 1) * (trial % 2 == 0 ? 1e9 : 1.0);
    const Eigen::VectorXd tamed = admissible_inputs(p, wild);
    expect_admissible(p, {"tamed", tamed});
    EXPECT_EQ(admissible_inputs(p, tamed), tamed);
  }
}

/// [ms of the processor] for the seeds of a multirotor where nothing is known.
double time_of_seeds_in_the_unknown(double v_max, double a_max) {
  Multirotor::Parameters parameters;
  parameters.v_max = v_max;
  parameters.a_max = a_max;
  const auto model = std::make_shared<const Multirotor>(parameters);
  const GridFrame frame{0.1, -20, -20, 40, 40};
  ClearanceField::Options options;
  options.vertical = true;
  options.reach = 1e4;
  options.obstacles = ClearanceField::Obstacles::kOccupiedAndUnknown;
  const BodyClearance known(
      std::make_shared<const ClearanceField>(Eigen::Vector3d(0.0, 0.0, 3.0),
                                             VoxelGrid(frame, 0.0, 0.6), GroundMap(frame), options),
      CylinderShape{});
  const CostToGo cost_to_go = towards({2.0, 1.0}, v_max);
  ProblemDefinition d;
  d.model = model;
  d.x0 = model->state({{0.0, 0.0, 3.0}, 0.0}, {});
  d.u_previous = model->input({});
  d.N = d.M = 20;
  d.terms = {{std::make_shared<ControlEffort>(Eigen::VectorXd::Zero(4), model->limits()), 1.0}};
  SeedContext context;
  context.cost_to_go = &cost_to_go;
  context.known = &known;
  context.known_margin = -1.0;  // it starts as deep in it
  const Problem p(d);
  ProcessorStopwatch watch;
  EXPECT_GT(make_seeds(p, context).size(), 10U);
  return watch.lap();
}

// Where nothing is known no place seems worse than another: each speed of a fast base was asked for
// as far as it takes to stop, 5 km.
TEST(SeedsOfAFastBase, AreMadeInTimeWhereNothingIsKnown) {
  for (const double a_max : {1.0, 1e-2}) {
    // Of one that stops within 25 m.
    const double slow = time_of_seeds_in_the_unknown(7.0 * std::sqrt(a_max), a_max);
    const double fast = time_of_seeds_in_the_unknown(100.0, a_max);
    EXPECT_LT(fast, 4.0 * slow) << a_max << ": " << fast << " and " << slow;
  }
}

// A mission of 14 minutes stood in such a place for six of them: half a metre wide, for a body of
// 0.4 m, the gap begins to one side of the robot. '#' is occupied, '?' unknown.
TEST(ApproachManoeuvre, LeadIntoAGapThatBeginsBesideTheRobot) {
  const std::vector<std::string> rows{"####################",  // north
                                      "######.........#####",  //
                                      "######.........#####",  //
                                      "######.........#####",  //
                                      "######.........#####",  //
                                      "#######........#####",  //
                                      "#######...@...######",  // the robot
                                      "######.......#######",  //
                                      "######.....#########",  //
                                      "######.....#########",  //
                                      "######.....#########",  //
                                      "######......########",  //
                                      "######........######",  //
                                      "######........######",  //
                                      "######........######",  //
                                      "######........######",  //
                                      "######????????######"};
  const int height = static_cast<int>(rows.size());
  const GridFrame frame{0.1, 0, 0, 20, height};
  VoxelGrid voxels(frame, 0.0, 0.6);
  GroundMap ground(frame);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    const char mark =
        rows[static_cast<std::size_t>(height - 1 - c.j)][static_cast<std::size_t>(c.i)];
    if (mark == '?') continue;
    const CellState state = mark == '#' ? CellState::kOccupied : CellState::kFree;
    ground.set(c, state);
    for (int k = 0; k < 6; ++k) voxels.set(c.i, c.j, k, state);
  }
  const Pose pose{{1.041, 1.089, 0.0}, -1.47};
  const auto model = make_model("unicycle");
  FrontierPlannerOptions options;
  options.traversability.hard_radius = 0.2;
  options.traversability.narrow_slack = 0.0;
  options.frontiers.sensor_range = options.utility.sensor_range = 0.6;
  options.frontiers.range_margin = 0.1;
  options.least_area = options.least_rate = 0.0;
  FrontierPlanner frontier_planner(options);
  const auto global_plan = frontier_planner.update(ground, pose, 0.0);
  ASSERT_TRUE(global_plan->target);
  const ClearanceField clearance(pose.position, voxels, ground, {});

  ProblemDefinition d;
  d.model = model;
  d.x0 = model->state(pose, {});
  d.u_previous = model->input({});
  d.N = 40;
  d.M = 40;
  d.terms = {{std::make_shared<ControlEffort>(Eigen::VectorXd::Zero(2), model->limits()), 1.0}};
  const Problem p(d);
  SeedContext context;
  context.cost_to_go = global_plan->cost_to_go.get();
  context.target = global_plan->target;
  context.clearance = &clearance;
  // The exact distance to the squares of the occupied cells: the field understates it in a gap.
  const auto clear = [&](const Eigen::Vector3d& at) {
    double least = 1e9;
    for (int n = 0; n < frame.size(); ++n) {
      const Cell c = frame.at(n);
      if (ground.state(c) != CellState::kOccupied) continue;
      const Eigen::Vector2d off =
          ((at.head<2>() - frame.center(c)).cwiseAbs().array() - 0.05).cwiseMax(0.0);
      least = std::min(least, off.norm());
    }
    return least;
  };
  // The least distance on the path and how far south it leads, by name.
  const auto drive = [&] {
    std::map<std::string, std::pair<double, double>> driven;
    for (const Seed& seed : make_approach_seeds(p, context)) {
      const TrajectoryBatch t = p.rollout(seed.z);
      double least = 1e9;
      for (int k = 0; k <= d.N; ++k) least = std::min(least, clear(t.pose(k, 0).position));
      driven[seed.name] = {least, t.pose(d.N, 0).position.y()};
    }
    return driven;
  };
  constexpr double kBody = 0.18;
  auto driven = drive();
  EXPECT_GT(driven.at("approach: turn and go").first, kBody + 0.01);
  EXPECT_LT(driven.at("approach: turn and go").second, 0.6) << "through the gap";
  for (const char* name : {"approach: go", "approach: go closely", "approach: go slowly"}) {
    EXPECT_LT(driven.at(name).first, kBody) << name << ": the gap is no test";
  }
  context.clearance = nullptr;
  driven = drive();
  EXPECT_LT(driven.at("approach: turn and go").first, kBody) << "along the cells themselves";
}

INSTANTIATE_TEST_SUITE_P(Models, Seeds, ::testing::ValuesIn(model_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace prospect::seeds_test
