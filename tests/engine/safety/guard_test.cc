// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/guard.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "engine/safety/known_ground.h"
#include "models/limited_twist.h"
#include "models/make_model.h"
#include "tests/engine/obstacle_worlds.h"

namespace prospect::guard_test {
namespace {

using test::ObstacleWorld;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Certifier::Options certificate_options() {
  Certifier::Options options;
  options.slice = {0.1, 0.5};
  return options;
}

Guard make_guard(const std::shared_ptr<const MotionModel>& model) {
  return Guard(model, CylinderShape{}, certificate_options());
}

/// A certified plan that drives the inputs (one column a stage) from the belief.
Plan plan_of(const MotionModel& model, const Belief& belief, const Eigen::MatrixXd& inputs,
             double dt = 0.25) {
  Plan plan;
  plan.kind = PlanKind::kOptimised;
  plan.stamp = belief.stamp;
  plan.dt = dt;
  plan.certified = true;
  plan.committed = static_cast<int>(inputs.cols());
  Eigen::VectorXd x = model.state(belief.pose, belief.twist), next(model.nx());
  plan.states.push_back(x);
  for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
    model.step(x, inputs.col(k), dt, next);
    plan.inputs.emplace_back(inputs.col(k));
    plan.commands.push_back(model.twist(next, inputs.col(k)));
    plan.states.push_back(next);
    x = next;
  }
  return plan;
}

class GuardTest : public ::testing::Test {
 protected:
  std::shared_ptr<const MotionModel> model_ = make_model("unicycle");
  Guard guard_ = make_guard(model_);
  Belief belief_ = ObstacleWorld().belief();
  Twist before_;  // in force
  Plan plan_;
  double now_ = 10.0;

  void SetUp() override {
    before_.linear.x() = 0.4;
    before_.yaw_rate = 0.1;
    belief_.set_stamps(now_);
    belief_.twist = before_;
    plan_ = plan_of(*model_, belief_, (Eigen::MatrixXd(2, 2) << 0.5, 0.5, 0.3, 0.2).finished());
  }

  GuardVerdict check(int stage = 0) { return guard_.check(plan_, stage, before_, belief_, now_); }
  /// The hardest braking of the unicycle from `before_`: on the plan's circle, of 0.6 per metre, if
  /// the plan is sound, else straight.
  void expect_braking(const GuardVerdict& verdict) {
    EXPECT_NEAR(verdict.command.linear.x(), 0.4 - 0.8 * 0.25, 1e-12);
    EXPECT_NEAR(verdict.command.yaw_rate, follows_plan(verdict.reason) ? 0.6 * 0.2 : 0.0, 1e-9);
    EXPECT_FALSE(verdict.detail.empty());
    EXPECT_FALSE(verdict.passed());
  }
};

TEST_F(GuardTest, PassesACertifiedFreshCommand) {
  const GuardVerdict verdict = check();
  EXPECT_TRUE(verdict.passed()) << verdict.detail;
  EXPECT_EQ(verdict.command.linear.x(), 0.5);
  EXPECT_EQ(verdict.command.yaw_rate, 0.3);
  before_ = plan_.commands[0];
  EXPECT_TRUE(check(1).passed());
}

TEST_F(GuardTest, NonFiniteCommandsPosesAndVelocities) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    SetUp();
    plan_.commands[0].linear.x() = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    expect_braking(check());
    SetUp();
    plan_.commands[0].yaw_rate = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    SetUp();
    plan_.inputs[1][0] = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    SetUp();
    belief_.pose.position.y() = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    expect_braking(check());
    SetUp();
    belief_.pose.yaw = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    expect_braking(check());
    SetUp();
    belief_.twist.linear.x() = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    SetUp();
    before_.linear.x() = bad;  // nothing to brake from
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
    EXPECT_EQ(check().command.linear.norm(), 0.0);
    EXPECT_EQ(check().command.yaw_rate, 0.0);
    SetUp();
    plan_.dt = bad;
    EXPECT_EQ(check().reason, GuardReason::kNonFinite);
  }
}

TEST_F(GuardTest, CommandsBeyondTheLimits) {
  plan_.commands[0].linear.x() = 0.6 * (1.0 + 1e-5);
  before_.linear.x() = 0.6;
  EXPECT_EQ(check().reason, GuardReason::kLimit);
  SetUp();
  plan_.commands[0].linear = {0.5, 0.5, 0.0};  // 0.71 m/s
  EXPECT_EQ(check().reason, GuardReason::kLimit);
  SetUp();
  plan_.commands[0].yaw_rate = -1.01;
  EXPECT_EQ(check().reason, GuardReason::kLimit);
  expect_braking(check());
}

TEST_F(GuardTest, ChangesBeyondTheRates) {
  // 0.8 m/s^2 for 0.25 s is 0.2 m/s; 2.5 rad/s^2 is 0.625 rad/s.
  before_.linear.x() = 0.5 - 0.2001;
  EXPECT_EQ(check().reason, GuardReason::kRate);
  before_.linear.x() = 0.5 - 0.1999;
  EXPECT_TRUE(check().passed());
  before_.yaw_rate = 0.3 - 0.626;
  EXPECT_EQ(check().reason, GuardReason::kRate);
  SetUp();
  // What is driven ahead does not turn with the body: 0.2005 m/s, though 0.199 seen from W.
  before_ = {{-0.1, 0.0, 0.0}, 0.4};
  plan_.commands[0] = {{0.1005, 0.0, 0.0}, 1.0};
  EXPECT_EQ(check().reason, GuardReason::kRate);
}

TEST_F(GuardTest, StaleAndFutureBeliefsAndPlans) {
  now_ = 10.51;
  EXPECT_EQ(check().reason, GuardReason::kStale);  // a belief of 0.51 s
  expect_braking(check());
  now_ = 9.99;
  EXPECT_EQ(check().reason, GuardReason::kStale);  // from the future
  EXPECT_EQ(check().detail, "the newest belief is from the future, by 0.01 s");
  now_ = kNan;
  EXPECT_EQ(check().reason, GuardReason::kStale);

  now_ = 10.79;  // the plan may be 2 * 0.25 + 0.3 s old
  belief_.set_stamps(now_);
  EXPECT_TRUE(check().passed());
  belief_.set_stamps(now_ = 10.81);
  EXPECT_EQ(check().reason, GuardReason::kStale);
  belief_.set_stamps(now_ = 9.9);
  EXPECT_EQ(check().reason, GuardReason::kStale);  // a plan from the future
  SetUp();
  now_ = 10.0;
  plan_.stamp = kNan;
  EXPECT_EQ(check().reason, GuardReason::kStale);
  SetUp();
  belief_.stamp = kNan;
  EXPECT_EQ(check().reason, GuardReason::kStale);
}

TEST_F(GuardTest, WhatIsNotCommittedDoesNotPass) {
  EXPECT_EQ(check(2).reason, GuardReason::kUncommitted);  // no such stage
  EXPECT_EQ(check(-1).reason, GuardReason::kUncommitted);
  expect_braking(check(2));
  plan_.committed = 0;
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
  SetUp();
  plan_.certified = false;
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
  SetUp();
  plan_.committed = 3;  // more than there are inputs
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
  SetUp();
  plan_.inputs[1].resize(5);
  plan_.inputs[1].setZero();
  EXPECT_EQ(check().reason, GuardReason::kNonFinite);
  // A command that is not what the certified input gives is not certified.
  SetUp();
  plan_.commands[0].yaw_rate = 0.29;
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
  plan_ = Plan();
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
}

TEST_F(GuardTest, TheNewestMapForbidsWhatAnOlderOneAllowed) {
  ASSERT_TRUE(check().passed());
  ObstacleWorld world;
  for (int j = -10; j < 10; ++j) world.occupy_column(4, j);  // a wall at x = 0.4, body to 0.18
  Belief newest = world.belief();
  newest.set_stamps(now_);
  newest.twist = before_;
  GuardVerdict verdict = guard_.check(plan_, 0, before_, newest, now_);
  EXPECT_EQ(verdict.reason, GuardReason::kMap);
  expect_braking(verdict);
  // An obstacle behind does not matter.
  ObstacleWorld behind;
  for (int j = -10; j < 10; ++j) behind.occupy_column(-8, j);
  newest = behind.belief();
  newest.set_stamps(now_);
  EXPECT_TRUE(guard_.check(plan_, 0, before_, newest, now_).passed());
  // Nor may it enter what has become unknown.
  ObstacleWorld fog;
  for (int i = 3; i < 8; ++i) {
    for (int j = -10; j < 10; ++j) fog.forget_column(i, j);
  }
  newest = fog.belief();
  newest.set_stamps(now_);
  EXPECT_EQ(guard_.check(plan_, 0, before_, newest, now_).reason, GuardReason::kMap);
  newest.voxels = nullptr;
  EXPECT_EQ(guard_.check(plan_, 0, before_, newest, now_).reason, GuardReason::kMap);
}

/// The same maps with nothing known in them, or `cells` further along both axes, in voxels of
/// `resolution` [m].
void replace_maps(Belief& belief, bool known, int cells, double resolution = 0.1) {
  const ObstacleWorld world(resolution);
  const auto moved = [&](GridFrame frame) {
    frame.i0 += cells;
    frame.j0 += cells;
    return frame;
  };
  const VoxelGrid& voxels = world.voxels;
  auto ground = std::make_shared<GroundMap>(moved(world.ground.frame()));
  for (int n = 0; known && n < ground->frame().size(); ++n) {
    ground->set(ground->frame().at(n), CellState::kFree);
  }
  const CellState all = known ? CellState::kFree : CellState::kUnknown;
  belief.voxels =
      std::make_shared<const VoxelGrid>(moved(voxels.frame()), voxels.k0(), voxels.depth(),
                                        std::vector<CellState>(voxels.data().size(), all));
  belief.ground = std::move(ground);
}

// Unknown space was taken for free, and what moves otherwise than it is told for what was told.
TEST_F(GuardTest, WhatHasNothingToDoWithThePlanIsNotTrusted) {
  Certifier::Options options = certificate_options();
  options.unknown = UnknownPolicy::kFree;
  options.known_ground = true;
  const Guard guard(model_, CylinderShape{}, options);
  struct Row {
    const char* what;
    std::function<void()> change;
    GuardReason reason;
  };
  const auto measured = [this](double v, double vy, double w) {
    return [=, this] { belief_.twist = {{v, vy, 0.0}, w}; };
  };
  const auto maps = [this](bool known, int cells) {
    return [=, this] { replace_maps(belief_, known, cells); };
  };
  // One of the belief's two maps is another's.
  const auto torn = [this](auto Belief::*map, bool known, int cells, double resolution = 0.1) {
    return [=, this] {
      Belief other;
      replace_maps(other, known, cells, resolution);
      belief_.*map = other.*map;
    };
  };
  const auto later = [this](double seconds) { return [=, this] { now_ += seconds; }; };
  const auto forgets = [this](double SourceStamps::*stamp, double value = 0.0) {
    return [=, this] { belief_.stamps.*stamp = value; };
  };
  const auto stands = [this](double v) {
    return [=, this] {
      plan_ = plan_of(*model_, belief_, Eigen::MatrixXd::Zero(2, 1));
      plan_.kind = PlanKind::kStoppingTail;
      plan_.certified = false;
      before_ = {};
      belief_.twist = {{v, 0.0, 0.0}, 0.0};
    };
  };
  using enum GuardReason;
  const Row rows[] = {
      {"as it should be", [] {}, kPassed},
      {"an empty map", maps(false, 0), kMap},
      {"a map of elsewhere", maps(true, 3000), kMap},
      {"a map that ends beside it", maps(true, 68), kMap},
      {"a map that is known here", maps(true, 20), kPassed},
      {"voxels that know nothing", torn(&Belief::voxels, false, 0), kMap},
      {"a ground map that knows nothing", torn(&Belief::ground, false, 0), kMap},
      {"voxels of elsewhere", torn(&Belief::voxels, true, 3000), kMap},
      {"a ground map of elsewhere", torn(&Belief::ground, true, 3000), kMap},
      {"voxels of another resolution", torn(&Belief::voxels, true, 0, 0.2), kMap},
      {"a ground map of another resolution", torn(&Belief::ground, true, 0, 0.05), kMap},
      {"no voxels", [this] { belief_.voxels = nullptr; }, kMap},
      {"no ground map", [this] { belief_.ground = nullptr; }, kMap},
      {"no octree", [this] { belief_.octree = nullptr; }, kMap},
      {"an octree of another resolution",
       [this] { belief_.octree = std::make_shared<const octomap::OcTree>(0.2); }, kMap},
      {"no stamp", [this] { belief_.stamp = 0.0; }, kStale},
      {"no stamp of any source", [this] { belief_.stamps = {}; }, kStale},
      {"no stamp of the pose", forgets(&SourceStamps::pose), kStale},
      {"no stamp of the map", forgets(&SourceStamps::map), kStale},
      {"no stamp of the landmarks", forgets(&SourceStamps::landmarks), kStale},
      {"no stamp of the ranges", forgets(&SourceStamps::ranges), kStale},
      {"a stamp that is none", forgets(&SourceStamps::map, kNan), kStale},
      {"no stamp of the plan", [this] { plan_.stamp = 0.0; }, kStale},
      {"a clock that has stopped", later(-0.5), kStale},
      {"a clock in milliseconds", later(9990.0), kStale},
      {"a clock that is none", later(kNan), kStale},
      {"a covariance that is none", [this] { belief_.covariance(1, 1) = kNan; }, kLost},
      {"a covariance without a sign", [this] { belief_.covariance(0, 0) = -0.04; }, kLost},
      {"lost and said to be exact", [this] { belief_.localization = Localization::kLost; }, kLost},
      {"no command in force", [this] { before_ = {}; }, kRate},
      {"a plan that is not certified", [this] { plan_.certified = false; }, kUncommitted},
      {"a plan without its inputs", [this] { plan_.inputs.clear(); }, kUncommitted},
      {"inputs of another robot", [this] { plan_.inputs[0].setZero(3); }, kNonFinite},
      {"commands of another plan", [this] { plan_.commands[0].linear.x() = 0.45; }, kUncommitted},
      {"slower than told", measured(0.0, 0.0, 0.0), kPassed},
      {"a little faster", measured(0.55, 0.0, 0.3), kPassed},
      {"much faster", measured(1.5, 0.0, 0.1), kVelocity},
      {"backwards", measured(-0.6, 0.0, 0.1), kVelocity},
      {"sideways", measured(0.4, -0.8, 0.1), kVelocity},
      {"turning", measured(0.4, 0.0, 1.5), kVelocity},
      {"stands, and stands", stands(0.0), kPassed},
      {"coasts to rest", stands(0.3), kPassed},
      {"told to stand, drives on", stands(0.6), kVelocity},
      {"told to stand, faster than it can", stands(1.5), kVelocity},
      {"told to stand, drives backwards", stands(-1.5), kVelocity},
  };
  for (const Row& row : rows) {
    now_ = 10.0;
    before_ = {};
    belief_ = ObstacleWorld().belief();
    belief_.octree = std::make_shared<const octomap::OcTree>(0.1);
    SetUp();
    row.change();
    const GuardVerdict verdict = guard.check(plan_, 0, before_, belief_, now_);
    EXPECT_EQ(verdict.reason, row.reason) << row.what << ": " << verdict.detail;
    EXPECT_LE(verdict.command.linear.norm(), row.reason == kPassed ? 0.5 : before_.linear.norm())
        << row.what;
  }
}

// It turns on the spot wherever the map begins beside it: that is how it looks about.
TEST(KnownGround, OfMotionsOnTheRimOfAMap) {
  ObstacleWorld world;
  const RobotShape shape = CylinderShape{};
  const auto knows = [&](bool planar, std::vector<Pose> poses) {
    Belief belief = world.belief();
    belief.octree = std::make_shared<const octomap::OcTree>(0.1);
    return unknown_ground(belief, shape, planar, poses).empty();
  };
  const auto at = [](double x, double yaw = 0.0) {
    Pose pose;
    pose.position = {x, 0.0, 0.0};
    pose.yaw = yaw;
    return pose;
  };
  for (const bool planar : {true, false}) {
    EXPECT_TRUE(knows(planar, {at(0.0), at(0.5), at(1.0)}));
    EXPECT_TRUE(knows(planar, {at(4.5), at(4.5, 1.0)})) << "turns where nothing is known";
    EXPECT_FALSE(knows(planar, {at(4.5), at(5.0)}));
    EXPECT_TRUE(knows(planar, {at(4.5), at(4.2), at(3.9), at(3.6)})) << "back to what is known";
    EXPECT_FALSE(knows(planar, {at(7.0), at(7.0, 1.0)})) << "nothing is known about it";
    EXPECT_TRUE(knows(planar, {at(3.7), at(3.9), at(4.0)})) << "a few cells beyond";
    EXPECT_FALSE(knows(planar, {at(3.9), at(4.3), at(4.8), at(5.3)}));
  }
  Pose high = at(0.0);
  high.position.z() = 3.0;
  EXPECT_FALSE(knows(false, {high}));
  EXPECT_TRUE(knows(true, {high}));
}

// Tails passed that were to be held for twelve days; a step that is not positive never ends.
TEST_F(GuardTest, ATimeStepIsBounded) {
  for (const PlanKind kind : {PlanKind::kOptimised, PlanKind::kStoppingTail}) {
    for (const double dt : {-0.25, -1e-300, 0.0, 1e-300, 1e-9, 2.1, 1e6, 1e300}) {
      SetUp();
      plan_.kind = kind;
      plan_.commands[0] = before_;
      plan_.dt = dt;
      const GuardVerdict verdict = check();
      EXPECT_EQ(verdict.reason, GuardReason::kLimit) << dt;
      // What is sent instead brakes as over a usual step, and is held as long.
      expect_braking(verdict);
      EXPECT_EQ(verdict.duration, 0.25);
    }
  }
  SetUp();
  EXPECT_EQ(check().duration, plan_.dt);
  for (const double bound : {Guard::Options::kMinStep, Guard::Options().max_step}) {
    plan_.dt = bound;
    plan_.certified = false;
    EXPECT_EQ(check().duration, bound);
  }
}

TEST_F(GuardTest, TheCommandsOfAStopEndAtRest) {
  const auto stop = [&](double step) {
    return guard_.stop_commands(nullptr, belief_.pose, before_, belief_, step);
  };
  // From 0.4 m/s by 0.8 m/s^2.
  const std::vector<Twist> commands = stop(0.25);
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_NEAR(commands[0].linear.x(), 0.2, 1e-12);
  EXPECT_TRUE(is_at_rest(commands[1]));
  for (const double step : {0.0, 1e-9, 2.1, kNan}) EXPECT_EQ(stop(step).size(), 1U) << step;
  before_.yaw_rate = kNan;
  ASSERT_EQ(stop(0.25).size(), 1U);
  EXPECT_TRUE(is_at_rest(stop(0.25)[0]));
}

// One stamp stood for all: a map frozen for 50 s passed under the fresh stamp of the pose.
TEST_F(GuardTest, EachSourceHasItsOwnAge) {
  struct Source {
    const char* name;
    double SourceStamps::*stamp;
    double Guard::Options::*limit;
  };
  const Source sources[] = {
      {"pose", &SourceStamps::pose, &Guard::Options::max_pose_age},
      {"map", &SourceStamps::map, &Guard::Options::max_map_age},
      {"landmarks", &SourceStamps::landmarks, &Guard::Options::max_landmarks_age},
      {"ranges", &SourceStamps::ranges, &Guard::Options::max_ranges_age}};
  for (const Source& source : sources) {
    SetUp();
    const double limit = Guard::Options().*source.limit;
    ASSERT_TRUE(std::isfinite(limit)) << source.name;
    belief_.stamps.*source.stamp = now_ - limit + 0.01;
    EXPECT_TRUE(check().passed()) << source.name;
    belief_.stamps.*source.stamp = now_ - 7.5;
    const GuardVerdict verdict = check();
    EXPECT_EQ(verdict.reason, GuardReason::kStale);
    EXPECT_NE(verdict.detail.find(source.name), std::string::npos) << verdict.detail;
    EXPECT_NE(verdict.detail.find(" 7.5 s old"), std::string::npos) << verdict.detail;
    expect_braking(verdict);
    for (const double bad : {now_ + 0.1, kNan, kInfinity, -kInfinity}) {
      belief_.stamps.*source.stamp = bad;
      EXPECT_EQ(check().reason, GuardReason::kStale) << source.name << bad;
    }
    belief_.stamps = SourceStamps();  // forgotten
    EXPECT_EQ(check().reason, GuardReason::kStale);
    // A source that does not change may be of any age, but not from the future.
    Guard::Options options;
    options.*source.limit = kInfinity;
    const Guard patient(model_, CylinderShape{}, certificate_options(), options);
    SetUp();
    belief_.stamps.*source.stamp = 0.0;
    EXPECT_TRUE(patient.check(plan_, 0, before_, belief_, now_).passed()) << source.name;
    belief_.stamps.*source.stamp = now_ + 0.1;
    EXPECT_EQ(patient.check(plan_, 0, before_, belief_, now_).reason, GuardReason::kStale);
    belief_.stamps.*source.stamp = kNan;
    EXPECT_EQ(patient.check(plan_, 0, before_, belief_, now_).reason, GuardReason::kStale);
    for (const double bad : {-0.1, kNan, -kInfinity}) {
      options.*source.limit = bad;
      EXPECT_THROW(Guard(model_, CylinderShape{}, certificate_options(), options),
                   std::invalid_argument);
    }
  }
}

TEST_F(GuardTest, RefusesOptionsOutOfRange) {
  const auto refuses = [&](auto change) {
    Guard::Options options;
    change(options);
    EXPECT_THROW(Guard(model_, CylinderShape{}, certificate_options(), options),
                 std::invalid_argument);
  };
  refuses([](auto& o) { o.max_belief_age = -1.0; });
  refuses([](auto& o) { o.plan_slack = kNan; });
  refuses([](auto& o) { o.max_step = 0.0; });
  refuses([](auto& o) { o.max_step = kInfinity; });
  refuses([](auto& o) { o.tolerance = -1e-6; });
  refuses([](auto& o) { o.mismatch = 1.0; });
  refuses([](auto& o) { o.mismatch = kNan; });
}

// The stop is certified as the hardest that the model can: one that brakes less ends in the wall.
TEST_F(GuardTest, AStoppingTailBrakesAsHardAsItCan) {
  const auto passes = [&](double v, double vy, double w) {
    plan_.commands[0].linear = {v, vy, 0.0};
    plan_.commands[0].yaw_rate = w;
    return check().passed();
  };
  plan_.kind = PlanKind::kStoppingTail;
  plan_.certified = false;
  // From 0.4 m/s and 0.1 rad/s, in 0.25 s: 0.2 m/s, 0 rad/s.
  EXPECT_TRUE(passes(0.2, 0.0, 0.0));
  EXPECT_FALSE(passes(0.4, 0.0, 0.1)) << "as before";
  EXPECT_FALSE(passes(0.4, 0.0, 0.0)) << "only the turning stops";
  EXPECT_FALSE(passes(0.4 - 1e-9, 0.0, 0.0));
  EXPECT_FALSE(passes(0.39, 0.0, 0.09));
  EXPECT_FALSE(passes(0.21, 0.0, 0.0));
  EXPECT_FALSE(passes(0.2, 0.0, 0.1)) << "turns on";
  EXPECT_FALSE(passes(0.2, 0.0, -0.1)) << "turns back";
  EXPECT_FALSE(passes(0.2, 0.05, 0.0)) << "slips away sideways";
  EXPECT_FALSE(passes(-0.2, 0.0, 0.0));
  expect_braking(check());
  // At rest what stays as it is passes.
  before_ = Twist();
  EXPECT_TRUE(passes(0.0, 0.0, 0.0));
  EXPECT_FALSE(passes(0.01, 0.0, 0.0));
  EXPECT_FALSE(passes(0.0, 0.0, 0.01));
}

TEST_F(GuardTest, AToleranceIsAShareOfTheLargestSpeed) {
  Guard::Options options;
  options.tolerance = 0.1;  // 0.06 m/s of 0.6
  const Guard tolerant(model_, CylinderShape{}, certificate_options(), options);
  for (const double v : {0.2, 0.25, 0.28, 0.35}) {
    plan_ =
        plan_of(*model_, belief_, (Eigen::MatrixXd(2, 3) << v, 0.1, 0.0, 0.0, 0.0, 0.0).finished());
    plan_.kind = PlanKind::kStoppingTail;
    EXPECT_EQ(tolerant.check(plan_, 0, before_, belief_, now_).passed(), v <= 0.26) << v;
  }
}

TEST_F(GuardTest, StoppingTailsPassWithoutCertificate) {
  ObstacleWorld world;
  for (int j = -10; j < 10; ++j) world.occupy_column(2, j);  // touching, straight ahead
  Belief newest = world.belief();
  newest.set_stamps(now_);
  newest.twist = before_;
  plan_ = plan_of(*model_, newest, (Eigen::MatrixXd(2, 2) << 0.2, 0.0, 0.0, 0.0).finished());
  EXPECT_EQ(guard_.check(plan_, 0, before_, newest, now_).reason, GuardReason::kMap);
  plan_.kind = PlanKind::kStoppingTail;
  plan_.certified = false;
  EXPECT_TRUE(guard_.check(plan_, 0, before_, newest, now_).passed());
  before_ = plan_.commands[0];
  EXPECT_TRUE(guard_.check(plan_, 1, before_, newest, now_).passed());
  // One that speeds up is none.
  SetUp();
  plan_.kind = PlanKind::kStoppingTail;
  EXPECT_EQ(check().reason, GuardReason::kUncommitted);
}

TEST_F(GuardTest, RefusesToBeMadeWithoutAModel) {
  EXPECT_THROW(Guard(nullptr, CylinderShape{}, certificate_options()), std::invalid_argument);
}

class GuardOfEveryModel : public ::testing::TestWithParam<std::string> {};

/// Whatever a model can do within its limits from a state within its limits is let through.
TEST_P(GuardOfEveryModel, PassesEveryAdmissibleMotionInTheOpen) {
  const auto model = make_model(GetParam());
  Certifier::Options options = certificate_options();
  options.unknown = UnknownPolicy::kFree;
  const Guard guard(model, CylinderShape{}, options);
  std::mt19937_64 random(5);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const InputLimits& limits = model->limits();
  Eigen::VectorXd c(model->num_state_constraints());
  int checked = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Belief belief = ObstacleWorld(0.2, 0.4).belief();
    belief.pose.yaw = uniform(-10, 10);
    belief.twist.linear = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    belief.twist.yaw_rate = uniform(-1, 1);
    // What the model can hold of this velocity.
    Eigen::VectorXd x = model->state(belief.pose, belief.twist);
    Eigen::VectorXd before =
        model->input(belief.twist).cwiseMax(limits.lower).cwiseMin(limits.upper);
    belief.twist = model->twist(x, before);
    Eigen::VectorXd u(model->nu());
    for (int j = 0; j < model->nu(); ++j) {
      const double reach = std::min(limits.rate[j] * 0.25, 100.0);
      u[j] = std::clamp(before[j] + uniform(-reach, reach), limits.lower[j], limits.upper[j]);
    }
    Eigen::VectorXd next(model->nx());
    model->step(x, u, 0.25, next);
    if (c.size() > 0) {
      model->state_constraints(x, c, nullptr);
      if ((c.array() < 0.0).any()) continue;
      model->state_constraints(next, c, nullptr);
      if ((c.array() < 0.0).any()) continue;
    }
    ++checked;
    const Plan plan = plan_of(*model, belief, u);
    const GuardVerdict verdict = guard.check(plan, 0, belief.twist, belief, 0.0);
    ASSERT_TRUE(verdict.passed()) << to_string(verdict.reason) << ": " << verdict.detail;
  }
  EXPECT_GT(checked, 100);
}

/// Every tail that brakes as hard as the model can is let through to its end, at whatever yaw and
/// with an estimate of it that is a bit off; none that the same base drives on with is.
TEST_P(GuardOfEveryModel, PassesTheHardestBrakingAndNothingSofter) {
  const auto model = make_model(GetParam());
  const Guard guard = make_guard(model);
  std::mt19937_64 random(8);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const InputLimits& limits = model->limits();
  const Belief world = ObstacleWorld().belief();
  int stages = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Belief belief = world;
    belief.pose.yaw = uniform(-10, 10);
    Twist twist;
    twist.linear = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    twist.yaw_rate = uniform(-1, 1);
    twist = limited_twist(*model, twist);
    twist = model->twist(model->state(belief.pose, twist),
                         model->input(twist).cwiseMax(limits.lower).cwiseMin(limits.upper));
    twist = limited_twist(*model, twist);
    Plan plan;
    plan.kind = PlanKind::kStoppingTail;
    plan.dt = uniform(0.05, 0.5);
    Eigen::VectorXd x = model->state(belief.pose, twist), next(model->nx());
    const Eigen::MatrixXd tail = stopping_tail(*model, x, model->input(twist), plan.dt);
    plan.committed = static_cast<int>(tail.cols());
    std::vector<Pose> poses{belief.pose};
    for (Eigen::Index k = 0; k < tail.cols(); ++k) {
      model->step(x, tail.col(k), plan.dt, next);
      x = next;
      poses.push_back(model->pose(x));
      plan.inputs.emplace_back(tail.col(k));
      plan.commands.push_back(limited_twist(*model, model->twist(x, tail.col(k))));
    }
    Twist before = twist;
    for (int k = 0; k < plan.committed; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double now = k * plan.dt;
      belief.set_stamps(now);
      belief.pose = poses[at];
      belief.pose.yaw += uniform(-0.01, 0.01);
      const GuardVerdict verdict = guard.check(plan, k, before, belief, now);
      ASSERT_TRUE(verdict.passed()) << to_string(verdict.reason) << ": " << verdict.detail;
      EXPECT_EQ(verdict.duration, plan.dt);
      ++stages;
      // Moving on, all of it or a part of the axes, is no braking.
      Plan lazy = plan;
      lazy.commands[at] = before;
      const bool moves = before.linear.norm() > 1e-3 || std::abs(before.yaw_rate) > 1e-3;
      EXPECT_EQ(guard.check(lazy, k, before, belief, now).passed(), !moves);
      if (moves) {
        lazy.commands[at].linear = (1.0 - 1e-9) * before.linear;
        EXPECT_FALSE(guard.check(lazy, k, before, belief, now).passed());
        lazy.commands[at].linear = 0.5 * (before.linear + plan.commands[at].linear);
        lazy.commands[at].yaw_rate = 0.5 * (before.yaw_rate + plan.commands[at].yaw_rate);
        EXPECT_FALSE(guard.check(lazy, k, before, belief, now).passed());
        lazy.commands[at].linear = -before.linear;
        lazy.commands[at].yaw_rate = -before.yaw_rate;
        EXPECT_FALSE(guard.check(lazy, k, before, belief, now).passed());
      }
      before = plan.commands[at];
    }
    EXPECT_LE(before.linear.norm(), 1e-3);
  }
  EXPECT_GT(stages, 300);
}

/// Whatever may call itself a stopping tail: what passes, held as long as it says, takes the robot
/// no farther than the stop that was certified.
TEST_P(GuardOfEveryModel, NoStoppingTailGoesFarther) {
  const auto model = make_model(GetParam());
  const Guard guard = make_guard(model);
  std::mt19937_64 random(9);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Belief belief = ObstacleWorld().belief();
  int passed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Twist command;
    command.linear.x() = uniform(0.1, 0.6);
    command.yaw_rate = uniform(-1, 1);
    const double speed = command.linear.norm();
    double path = 0.0;
    for (int n = 0; n < 200; ++n) {
      Plan plan;
      plan.kind = PlanKind::kStoppingTail;
      plan.stamp = belief.stamp;
      plan.dt = trial % 5 == 0 ? std::pow(10.0, uniform(-6, 7)) : 0.25;
      Twist asked = command;
      switch (trial % 4) {
        case 0:
          break;
        case 1:
          asked.linear *= 1.0 - 1e-9;
          break;
        case 2:
          asked.linear = Eigen::AngleAxisd(uniform(-0.3, 0.3), Eigen::Vector3d::UnitZ()) *
                         (uniform(0.9, 1.0) * asked.linear);
          break;
        default:
          asked.linear *= uniform(0.0, 1.0);
          asked.yaw_rate *= uniform(0.0, 1.0);
      }
      plan.commands = {asked};
      const GuardVerdict verdict = guard.check(plan, 0, command, belief, belief.stamp);
      passed += verdict.passed();
      command = verdict.command;
      path += command.linear.norm() * verdict.duration;
    }
    EXPECT_LT(path, speed * speed / (2.0 * 0.9 * model->max_deceleration()) + 1e-3) << trial;
  }
  EXPECT_GT(passed, 0);
}

/// Whatever it is given, the verdict is finite and within limits.
TEST_P(GuardOfEveryModel, TheVerdictIsAlwaysFiniteAndWithinLimits) {
  const auto model = make_model(GetParam());
  const Guard guard = make_guard(model);
  std::mt19937_64 random(6);
  const auto number = [&]() -> double {
    switch (random() % 16) {
      case 0:
        return kNan;
      case 1:
        return kInfinity;
      case 2:
        return -1e300;
      case 3:
        return std::uniform_real_distribution<double>(-100, 100)(random);
      default:
        return std::uniform_real_distribution<double>(-1, 1)(random);
    }
  };
  const Belief worlds[] = {test::random_world(1).belief(), ObstacleWorld().belief(), Belief()};
  int passed = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Belief belief = worlds[random() % 3];
    if (random() % 4 == 0) belief.stamp = number();
    if (random() % 16 == 0) belief.stamps.map = number();
    if (random() % 8 == 0) belief.covariance(0, 0) = number();
    if (random() % 8 == 0) belief.localization = Localization::kLost;
    belief.pose.position = {0.1 * number(), 0.1 * number(), random() % 2 ? 0.0 : number()};
    belief.pose.yaw = number();
    belief.twist.linear.x() = number();
    Plan plan;
    plan.kind = random() % 3 ? PlanKind::kOptimised : PlanKind::kStoppingTail;
    plan.certified = random() % 8 != 0;
    plan.dt = random() % 8 ? 0.25 : number();
    plan.committed = static_cast<int>(random() % 4);
    for (std::size_t n = random() % 4; n > 0; --n) {
      Twist command;
      command.linear.x() = number();
      if (random() % 3 == 0) command.linear.y() = number();
      command.yaw_rate = number();
      plan.commands.push_back(command);
      Eigen::VectorXd u = model->input(command);
      if (random() % 4 == 0) {
        for (double& entry : u) entry = number();
      }
      if (random() % 16 == 0) u.conservativeResize(1);
      plan.inputs.push_back(u);
    }
    Twist before;
    before.linear = {number(), random() % 2 ? 0.0 : number(), random() % 2 ? 0.0 : number()};
    before.yaw_rate = number();
    if (random() % 8 == 0) {  // at rest
      before = Twist();
      plan.commands.assign(plan.commands.size(), Twist());
    }
    const GuardVerdict verdict =
        guard.check(plan, static_cast<int>(random() % 4) - 1, before, belief, 0.0);
    passed += verdict.passed();
    ASSERT_TRUE(verdict.duration >= Guard::Options::kMinStep && verdict.duration <= 2.0);
    ASSERT_TRUE(verdict.command.linear.allFinite());
    ASSERT_TRUE(std::isfinite(verdict.command.yaw_rate));
    ASSERT_LE(verdict.command.linear.norm(), model->max_speed() * (1.0 + 1e-6));
    ASSERT_LE(std::abs(verdict.command.yaw_rate), model->max_yaw_rate() * (1.0 + 1e-6));
  }
  EXPECT_GT(passed, 0);
}

INSTANTIATE_TEST_SUITE_P(Models, GuardOfEveryModel, ::testing::ValuesIn(model_names()),
                         [](const auto& info) { return info.param; });

/// The command in force is the plan's first; sent now, at any time within the plan.
class TimedCommandTest : public GuardTest {
 protected:
  TimedCommand asked_;

  void SetUp() override {
    GuardTest::SetUp();
    before_ = plan_.commands[0];
    belief_.twist = before_;
    asked_ = TimedCommand();
    asked_.pose = belief_.pose;
    ask(0.5, 0.3);
    at(0.0);
  }
  void ask(double speed, double yaw_rate) { asked_.input = Eigen::Vector2d(speed, yaw_rate); }
  void at(double since_start) {
    now_ = 10.0 + since_start;
    belief_.set_stamps(now_);
  }
  GuardVerdict check_timed() { return guard_.check(plan_, asked_, before_, belief_, now_); }
};

TEST_F(TimedCommandTest, PassesWithinAStage) {
  at(0.1);
  const GuardVerdict verdict = check_timed();
  EXPECT_TRUE(verdict.passed()) << verdict.detail;
  EXPECT_EQ(verdict.command.linear.x(), 0.5);
  EXPECT_EQ(verdict.command.yaw_rate, 0.3);
  EXPECT_EQ(verdict.duration, asked_.step);
  // On the path to the second stage, which turns less.
  at(0.25);
  ask(0.5, 0.25);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
}

TEST_F(TimedCommandTest, ASpeedIsHeldAndThenBrakedBeforeAnObstacle) {
  // From 0.5 m/s held for 0.1 s, the stop takes 0.2 m; the wall is nearer or farther than that.
  const auto with_wall_at = [&](double gap) {
    ObstacleWorld world;
    const int wall = static_cast<int>(std::ceil(10.0 * (CylinderShape{}.radius + gap)));
    for (int j = -20; j < 20; ++j) world.occupy_column(wall, j);
    const Belief mapped = world.belief();
    belief_.voxels = mapped.voxels;
    belief_.ground = mapped.ground;
    return check_timed();
  };
  EXPECT_TRUE(with_wall_at(0.4).passed()) << with_wall_at(0.4).detail;
  const GuardVerdict verdict = with_wall_at(0.1);
  EXPECT_EQ(verdict.reason, GuardReason::kMap) << verdict.detail;
  // The hardest braking over a step, not over a stage, on the plan's circle.
  EXPECT_NEAR(verdict.command.linear.x(), 0.5 - 0.8 * 0.05, 1e-12);
  EXPECT_NEAR(verdict.command.yaw_rate, 0.6 * verdict.command.linear.x(), 1e-9);
  // Held for longer, it needs more way.
  asked_.hold = 1.0;
  EXPECT_EQ(with_wall_at(0.4).reason, GuardReason::kMap);
}

TEST_F(TimedCommandTest, LeadsToTheCommandOfThePlanAndNotBeyond) {
  ask(0.53, 0.3);
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
  ask(0.5, 0.4);
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
  before_.linear.x() = 0.47;
  ask(0.5, 0.3);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  ask(0.44, 0.3);  // away from it
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
  // A share of the plan's velocities.
  SetUp();
  asked_.share = 0.5;
  ask(0.47, 0.2);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  ask(0.5, 0.3);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  before_.linear.x() = 0.25;
  ask(0.28, 0.3);
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
}

TEST_F(TimedCommandTest, PastTheCommittedPartItBrakes) {
  at(0.55);
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
  EXPECT_NEAR(check_timed().command.linear.x(), 0.5 - 0.8 * 0.05, 1e-12);
  ask(0.5 - 0.8 * 0.05, 0.3 - 2.5 * 0.05);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  at(100.0);  // however old the plan is
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  at(-0.1);  // before it begins
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  belief_.twist = before_ = Twist{};
  ask(0.0, 0.0);
  EXPECT_TRUE(check_timed().passed()) << check_timed().detail;
  ask(0.01, 0.0);
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
}

TEST_F(TimedCommandTest, WhatIsWrongWithItIsSaid) {
  asked_.input[0] = kNan;
  EXPECT_EQ(check_timed().reason, GuardReason::kNonFinite);
  SetUp();
  asked_.pose->yaw = kInfinity;
  EXPECT_EQ(check_timed().reason, GuardReason::kNonFinite);
  SetUp();
  asked_.input.resize(1);
  EXPECT_EQ(check_timed().reason, GuardReason::kNonFinite);
  for (double TimedCommand::*time : {&TimedCommand::step, &TimedCommand::hold}) {
    for (const double bad : {0.0, -1.0, 1e-4, 1e9}) {
      SetUp();
      asked_.*time = bad;
      EXPECT_EQ(check_timed().reason, GuardReason::kLimit) << bad;
    }
  }
  SetUp();
  asked_.share = 1.1;
  EXPECT_EQ(check_timed().reason, GuardReason::kLimit);
  SetUp();
  before_.linear.x() = 0.4;  // 0.1 m/s in 0.05 s
  EXPECT_EQ(check_timed().reason, GuardReason::kRate);
  SetUp();
  belief_.stamps.map = now_ - 2.0;
  EXPECT_EQ(check_timed().reason, GuardReason::kStale);
  SetUp();
  plan_.certified = false;
  EXPECT_EQ(check_timed().reason, GuardReason::kUncommitted);
}

// A pose that was left out was the origin: 36 commands passed, into a wall.
TEST_F(TimedCommandTest, ThePoseIsToldAndOneThatTheRobotGetsTo) {
  const auto reason_at = [this](double x, double yaw) {
    asked_.pose->position.x() = x;
    asked_.pose->yaw = yaw;
    return check_timed().reason;
  };
  EXPECT_EQ(reason_at(0.1, 0.1), GuardReason::kPassed) << check_timed().detail;
  EXPECT_EQ(reason_at(-2.0, 0.0), GuardReason::kMap);
  EXPECT_EQ(reason_at(0.0, 3.0), GuardReason::kMap);
  EXPECT_EQ(reason_at(0.0, 2.0 * M_PI), GuardReason::kPassed) << check_timed().detail;
  asked_.pose.reset();
  const GuardVerdict verdict = check_timed();
  EXPECT_EQ(verdict.reason, GuardReason::kNonFinite);
  EXPECT_LT(verdict.command.linear.x(), before_.linear.x());
}

// As far as it drives and turns in the age of the belief, while it is held and in the lag, and a
// bit.
TEST_F(TimedCommandTest, ThePoseIsNoFartherThanTheRobotGets) {
  asked_.hold = 0.2;
  for (const double age : {0.0, 0.2}) {
    now_ = 10.0 + age;
    const double time = age + 0.2 + Guard::Options::kLag;
    for (const double off : {-0.01, 0.01}) {
      const GuardReason reason = off < 0.0 ? GuardReason::kPassed : GuardReason::kMap;
      *asked_.pose = belief_.pose;
      asked_.pose->position.x() += 0.6 * time + Guard::Options::kPoseSlack + off;
      EXPECT_EQ(check_timed().reason, reason) << age << ": " << check_timed().detail;
      *asked_.pose = belief_.pose;
      asked_.pose->yaw -= time + Guard::Options::kPoseSlack + off;
      EXPECT_EQ(check_timed().reason, reason) << age << ": " << check_timed().detail;
    }
  }
}

// Held for three steps, it is certified for three.
TEST_F(TimedCommandTest, IsCertifiedForAsLongAsItIsHeld) {
  Certifier::Options options = certificate_options();
  for (const int most : {2, 3}) {
    options.max_checks = 800 * most;
    asked_.hold = 3 * asked_.step;
    const Guard guard(model_, CylinderShape{}, options);
    const std::string detail = guard.check(plan_, asked_, before_, belief_, now_).detail;
    EXPECT_EQ(detail == "the command is held for too many steps", most < 3) << detail;
  }
}

TEST_F(TimedCommandTest, OfABaseThatIsControlledByAcceleration) {
  const std::shared_ptr<const MotionModel> model = make_model("unicycle_accel");
  const Guard guard = make_guard(model);
  before_ = {{0.2, 0.0, 0.0}, 0.0};
  belief_.twist = before_;
  plan_ = plan_of(*model, belief_, (Eigen::MatrixXd(2, 2) << 0.4, 0.4, 0.0, 0.0).finished());
  plan_.ramp_from = before_;
  asked_.input = Eigen::Vector2d(0.4, 0.0);
  const GuardVerdict verdict = guard.check(plan_, asked_, before_, belief_, now_);
  EXPECT_TRUE(verdict.passed()) << verdict.detail;
  EXPECT_NEAR(verdict.command.linear.x(), 0.22, 1e-12);
  asked_.input = Eigen::Vector2d(0.9, 0.0);  // of 0.8 m/s^2
  EXPECT_EQ(guard.check(plan_, asked_, before_, belief_, now_).reason, GuardReason::kRate);
}

}  // namespace
}  // namespace prospect::guard_test
