// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/pose_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/perception/graph/two_laps.h"

namespace prospect::pose_graph_test {
namespace {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using test::TwoLaps;

TEST(PoseGraph, LoopsBringOdometryBack) {
  for (const bool planar : {true, false}) {
    TwoLaps laps(1, planar);
    PoseGraph graph = laps.graph();
    const double before = laps.error(graph);
    ASSERT_TRUE(graph.optimise());
    EXPECT_EQ(laps.used(graph).first, std::ssize(laps.loops));
    EXPECT_LT(laps.error(graph), 0.5 * before);
    EXPECT_EQ(graph.pose(0)->matrix(), laps.truth[0].matrix());  // the gauge
    EXPECT_EQ(graph.scale(), 1.0);
    EXPECT_EQ(graph.pose(150)->translation().z() == 0.0, planar);
  }
}

TEST(PoseGraph, AMotionOfAllOfItChangesNothing) {
  TwoLaps laps(1, false);
  PoseGraph here = laps.graph();
  const Isometry3d moved = exp_se3((TwoLaps::Vector6d() << 30, -20, 5, 0.4, -0.3, 2.0).finished());
  for (Isometry3d& T : laps.truth) T = moved * T;
  PoseGraph there = laps.graph();
  here.optimise();
  there.optimise();
  for (const int k : {50, 120, 199}) {
    EXPECT_LT((moved * *here.pose(k) * there.pose(k)->inverse()).translation().norm(), 1e-4) << k;
  }
}

TEST(PoseGraph, NoWrongLoopIsUsedAndTheRightOnesAre) {
  for (const bool planar : {true, false}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      TwoLaps laps(seed, planar);
      const int right = static_cast<int>(laps.loops.size());
      PoseGraph clean = laps.graph();
      clean.optimise();
      laps.add_wrong(100);
      laps.add_wrong_stretch(5, 60, 8);
      laps.add_wrong_stretch(130, 170, 8);
      std::shuffle(laps.loops.begin(), laps.loops.end(), laps.generator);
      PoseGraph graph = laps.graph();
      ASSERT_TRUE(graph.optimise());
      EXPECT_EQ(laps.used(graph).second, 0) << seed;
      EXPECT_GE(laps.used(graph).first, right - 1) << seed;
      EXPECT_LT(laps.error(graph), 1.1 * laps.error(clean)) << seed;
    }
  }
}

TEST(PoseGraph, WrongLoopsAloneLeaveOdometryAsItIs) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    TwoLaps laps(seed);
    laps.loops.clear();
    PoseGraph odometry = laps.graph();
    laps.add_wrong(100);
    PoseGraph graph = laps.graph();
    graph.optimise();
    EXPECT_EQ(laps.used(graph).second, 0) << seed;
    EXPECT_NEAR(laps.error(graph), laps.error(odometry), 1e-9);
  }
}

TEST(PoseGraph, InformationThatIsTooSmallIsSeen) {
  TwoLaps laps(2);
  laps.add_wrong(40);
  for (RelativePose& step : laps.odometry) step.information /= 400.0;
  for (TwoLaps::Loop& loop : laps.loops) loop.measured.information /= 400.0;
  PoseGraph graph = laps.graph();
  graph.optimise();
  EXPECT_LT(graph.scale(), 0.3);
  EXPECT_EQ(laps.used(graph).second, 0);
  EXPECT_GE(laps.used(graph).first, 15);
}

TEST(PoseGraph, TheOrderOfLoopsDoesNotMatter) {
  TwoLaps laps(3);
  laps.add_wrong(60);
  PoseGraph one = laps.graph();
  one.optimise();
  const double error = laps.error(one);
  std::reverse(laps.loops.begin(), laps.loops.end());
  PoseGraph other = laps.graph();
  other.optimise();
  const std::vector<LoopState> states(other.loops().rbegin(), other.loops().rend());
  EXPECT_EQ(one.loops(), states);
  EXPECT_NEAR(laps.error(other), error, 1e-3);
}

TEST(PoseGraph, SameCallsGiveTheSameBits) {
  TwoLaps laps(4, false);
  laps.add_wrong(30);
  PoseGraph one = laps.graph(), other = laps.graph();
  one.optimise();
  while (!other.optimise({.iterations = 1})) {
  }
  PoseGraph again = laps.graph();
  again.optimise();
  for (int k = 0; k < 200; ++k) EXPECT_EQ(one.pose(k)->matrix(), again.pose(k)->matrix()) << k;
  // In pieces it is judged alike; the damping begins anew with each.
  EXPECT_EQ(one.loops(), other.loops());
  EXPECT_LT((one.pose(199)->translation() - other.pose(199)->translation()).norm(), 0.01);
}

TEST(PoseGraph, ABudgetEndsItAndTheNextCallGoesOn) {
  TwoLaps laps(5);
  laps.add_wrong(30);
  PoseGraph graph = laps.graph();
  const Isometry3d before = *graph.pose(199);
  EXPECT_FALSE(graph.optimise({.iterations = 1}));
  EXPECT_EQ(graph.pose(199)->matrix(), before.matrix());  // judged whole, or not at all
  EXPECT_EQ(laps.used(graph).first, 0);
  int calls = 1;
  while (!graph.optimise({.iterations = 1})) ASSERT_LT(++calls, 200);
  EXPECT_EQ(laps.used(graph).second, 0);
  EXPECT_GE(laps.used(graph).first, 15);
  EXPECT_TRUE(graph.optimise({.iterations = 1}));
  EXPECT_FALSE(laps.graph().optimise({.deadline = std::chrono::steady_clock::now()}));
}

TEST(PoseGraph, WhatComesLaterIsJudgedInTheGraphThatIsThere) {
  TwoLaps laps(6);
  laps.add_wrong(40);
  std::stable_sort(laps.loops.begin(), laps.loops.end(), [](const auto& a, const auto& b) {
    return std::max(a.from, a.to) < std::max(b.from, b.to);
  });
  PoseGraph graph;
  ASSERT_EQ(graph.begin(0, laps.truth[0]), GraphInput::kTaken);
  std::size_t next = 0;
  for (int k = 1; k < 200; ++k) {
    ASSERT_EQ(graph.add_keyframe(k, k - 1, laps.odometry[static_cast<std::size_t>(k - 1)]),
              GraphInput::kTaken);
    const auto there = [&](const TwoLaps::Loop& loop) { return std::max(loop.from, loop.to) <= k; };
    for (; next < laps.loops.size() && there(laps.loops[next]); ++next) {
      const TwoLaps::Loop& loop = laps.loops[next];
      ASSERT_EQ(graph.add_loop(loop.from, loop.to, loop.measured), GraphInput::kTaken);
    }
    if (k % 3 == 0) graph.optimise({.iterations = 4});
  }
  while (!graph.optimise({.iterations = 4})) {
  }
  EXPECT_EQ(laps.used(graph).second, 0);
  EXPECT_GE(laps.used(graph).first, 15);
}

TEST(PoseGraph, AWrongLoopThatWasUsedFirstIsGivenUp) {
  // It fits the odometry of a lap; the right ones come later and contradict it.
  TwoLaps laps(11);
  const std::vector<TwoLaps::Loop> right = laps.loops;
  const Isometry3d off = exp_se3((TwoLaps::Vector6d() << 1.0, -1.0, 0, 0, 0, 0.02).finished());
  laps.loops = {{140, 40, laps.measure(laps.between(140, 40) * off, laps.loop_sigma), false}};
  PoseGraph graph = laps.graph();
  graph.optimise();
  ASSERT_EQ(laps.used(graph).second, 1);
  for (const TwoLaps::Loop& loop : right) {
    ASSERT_EQ(graph.add_loop(loop.from, loop.to, loop.measured), GraphInput::kTaken);
    laps.loops.push_back(loop);
  }
  graph.optimise();
  EXPECT_EQ(laps.used(graph).second, 0);
  EXPECT_GE(laps.used(graph).first, 15);
}

TEST(PoseGraph, LoopsMakeFarKeyframesSurer) {
  TwoLaps laps(8);
  PoseGraph graph = laps.graph();
  const Matrix6d before = *graph.covariance(0, 150);
  graph.optimise();
  const Matrix6d after = *graph.covariance(0, 150);
  EXPECT_LT(after(0, 0), 0.2 * before(0, 0));
  EXPECT_LT(after(5, 5), 0.5 * before(5, 5));
  EXPECT_EQ(*graph.covariance(20, 20), Matrix6d::Zero());
  EXPECT_FALSE(graph.covariance(0, 999));
}

TEST(PoseGraph, WhatIsNoneOfItIsRefusedAndChangesNothing) {
  TwoLaps laps(9);
  PoseGraph graph = laps.graph();
  graph.optimise();
  const RelativePose good = laps.odometry[0];
  RelativePose nan = good, far = good, bent = good, unsure = good;
  nan.T.translation().x() = std::nan("");
  far.T.translation().x() = 1e7;
  bent.T.linear() *= 1.1;
  unsure.information(0, 0) = -1.0;
  EXPECT_EQ(graph.begin(7, laps.truth[0]), GraphInput::kKnownKeyframe);
  EXPECT_EQ(PoseGraph().begin(0, far.T), GraphInput::kNotAPose);
  EXPECT_EQ(PoseGraph().add_keyframe(1, 0, good), GraphInput::kUnknownKeyframe);
  EXPECT_EQ(graph.add_keyframe(200, 500, good), GraphInput::kUnknownKeyframe);
  EXPECT_EQ(graph.add_keyframe(100, 50, good), GraphInput::kKnownKeyframe);
  EXPECT_EQ(graph.add_loop(3, 500, good), GraphInput::kUnknownKeyframe);
  EXPECT_EQ(graph.add_loop(3, 3, good), GraphInput::kSameKeyframe);
  for (const RelativePose& bad : {nan, far, bent}) {
    EXPECT_EQ(graph.add_keyframe(200, 199, bad), GraphInput::kNotAPose);
    EXPECT_EQ(graph.add_loop(3, 103, bad), GraphInput::kNotAPose);
  }
  EXPECT_EQ(graph.add_keyframe(200, 199, unsure), GraphInput::kNotAnInformation);
  EXPECT_EQ(graph.add_loop(3, 103, unsure), GraphInput::kNotAnInformation);
  EXPECT_FALSE(reason(GraphInput::kNotAnInformation).empty());
  EXPECT_EQ(graph.keyframes(), 200u);
  EXPECT_EQ(graph.loops().size(), laps.loops.size());
  EXPECT_TRUE(graph.optimise({.iterations = 0}));  // nothing is left to do
  EXPECT_TRUE(PoseGraph().optimise());
}

}  // namespace
}  // namespace prospect::pose_graph_test
