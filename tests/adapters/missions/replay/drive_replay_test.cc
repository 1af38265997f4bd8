// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/drive_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/bags/mcap_writer.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/missions/log/planner_calls.h"
#include "adapters/missions/log/step_messages.h"
#include "engine/maps/correction.h"
#include "engine/planner/planner.h"
#include "tests/engine/room_belief.h"

namespace prospect::drive_replay_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kSteps = 4;

/// A drive's log made by hand: a planner that was asked four times for a plan, with a map that
/// grows, and told a task before the third.
class DriveReplayTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    calls_ = new std::vector<PlannerCall>;
    const Configuration c = configuration();
    Planner planner(c.robot, c.planner, Registries().solvers.make(c.solver));
    PlannerCallWriter writer;
    Belief belief;
    for (int n = 0; n < kSteps; ++n) {
      belief = test::Room{.seen = 2.0 + 0.5 * n, .landmarks_per_wall = 10}.belief();
      belief.set_stamps(0.5 * n);
      calls_->push_back(writer.prepare(belief));
      planner.prepare(belief);
      belief = test::Room{.seen = 2.25 + 0.5 * n, .landmarks_per_wall = 10}.belief();
      belief.set_stamps(0.5 * n + 0.25);
      if (n == 2) {
        const Task task = Task::go_to({0.5, -1.0});
        calls_->push_back(writer.task(task));
        EXPECT_EQ(planner.set_task(task), "");
      }
      calls_->push_back(writer.plan(belief));
      calls_->push_back(writer.planned(planner.plan(belief)));
    }
  }
  static void TearDownTestSuite() { delete std::exchange(calls_, nullptr); }

  void SetUp() override {
    folder_ = testing::TempDir() + "drive_replay_" + std::to_string(getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Configuration configuration() {
    return configuration_from_text(
        "planner: {N: 12, M: 6, max_landmarks: 20, max_targets: 30, solver: sampling}\n", "test");
  }
  std::string log() const { return folder_ + "/mission.mcap"; }

  /// `calls` in the log of a drive of so many steps.
  void write(const std::vector<PlannerCall>& calls, int steps = kSteps, std::uint64_t dropped = 0,
             const char* type = PlannerCall::kType) const {
    McapWriter writer(log());
    const std::uint16_t step = writer.add_channel(topic::kStep, ros::DiagnosticArray::kType, "");
    const std::uint16_t call = writer.add_channel(topic::kPlannerCalls, type, "");
    for (int n = 0; n < steps; ++n) {
      StepRecord record;
      record.step = n;
      record.time = 0.5 * n + 0.1234;
      const std::int64_t ns = 1'000'000'000LL + n;
      writer.message(step, static_cast<std::uint64_t>(ns), ros::to_cdr(step_values(record, ns)));
    }
    // Times of calls do not tell their order.
    std::uint64_t time = 2'000'000'000;
    for (const PlannerCall& c : calls) writer.message(call, time -= 5, ros::to_cdr(c));
    if (dropped > 0) {
      writer.metadata(topic::kDropped, {{topic::kPlannerCalls, std::to_string(dropped)}});
    }
    writer.close();
  }
  DriveReplay replay(const ReplayOptions& options = {}) const {
    RecordedRun run;
    run.source = log();
    run.log = BagFile::open(log());
    return replay_calls(run, configuration(), {}, options);
  }
  static std::vector<PlannerCall> without(std::size_t first, std::size_t last) {
    std::vector<PlannerCall> calls = *calls_;
    calls.erase(calls.begin() + static_cast<std::ptrdiff_t>(first),
                calls.begin() + static_cast<std::ptrdiff_t>(last));
    return calls;
  }
  static void expect_refused(const std::function<void()>& made, const std::string& what) {
    try {
      made();
      ADD_FAILURE() << "expected: " << what;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  }

  static std::vector<PlannerCall>* calls_;  // prepare, plan, planned; the eighth is the task
  std::string folder_;
};

std::vector<PlannerCall>* DriveReplayTest::calls_ = nullptr;

TEST_F(DriveReplayTest, TheSameCallsMakeTheSamePlans) {
  write(*calls_);
  const DriveReplay made = replay();
  EXPECT_EQ(made.plans, kSteps);
  EXPECT_EQ(made.steps, kSteps);
  EXPECT_EQ(made.difference.step, -1) << made.difference.what;
  EXPECT_EQ(made.missing, "");
  ASSERT_EQ(made.replay.steps.size(), std::size_t{kSteps});
  EXPECT_EQ(made.replay.steps[1].other.task, TaskKind::kExplore);
  EXPECT_EQ(made.replay.steps[2].other.task, TaskKind::kGoTo);
}

TEST_F(DriveReplayTest, WhereWLiesInTheMapIsToldWhenItMoves) {
  PlannerCallWriter writer;
  PlannerCallReader reader;
  Belief belief = test::Room{.seen = 2.0, .landmarks_per_wall = 10}.belief();
  EXPECT_FALSE(writer.map_frame(belief));
  EXPECT_EQ(reader.belief(writer.plan(belief), "").map_frame, nullptr);
  auto frame = std::make_shared<MapFrame>();
  frame->origin = {{3.0, -1.0 / 3.0, 0.0}, 0.1};
  belief.map_frame = frame;
  const auto moved = writer.map_frame(belief);
  ASSERT_TRUE(moved);
  reader.take_map_frame(ros::from_cdr<PlannerCall>(ros::to_cdr(*moved), "call"), "call");
  const Belief read = reader.belief(writer.plan(belief), "");
  EXPECT_EQ(read.map_frame->origin.position, frame->origin.position);
  EXPECT_EQ(read.map_frame->origin.yaw, 0.1);
  EXPECT_FALSE(writer.map_frame(belief));

  // What was measured has moved, twice, and the frame has not.
  auto again = std::make_shared<MapFrame>(*frame);
  const PlanarMove some{{0.1, -0.2}, 0.3};
  for (int n = 0; n < 2; ++n) {
    std::vector<PlaceMoves::Known> known(static_cast<std::size_t>(1 + n),
                                         {{1.0, n + 0.5}, some, 0.04});
    again->moved_places.push_back(
        {++again->taken, std::make_shared<const PlaceMoves>(std::move(known))});
  }
  belief.map_frame = again;
  const auto places = writer.map_frame(belief);
  ASSERT_TRUE(places);
  PlannerCall call = ros::from_cdr<PlannerCall>(ros::to_cdr(*places), "call");
  reader.take_map_frame(call, "call");
  const auto after = reader.belief(writer.plan(belief), "").map_frame;
  ASSERT_EQ(after->moved_places.size(), 2U);
  ASSERT_EQ(after->moved_places[1].how->known().size(), 2U);
  const PlaceMoves::Known& last = after->moved_places[1].how->known()[1];
  EXPECT_EQ(last.before, Eigen::Vector2d(1.0, 1.5));
  EXPECT_EQ(last.move.shift, some.shift);
  EXPECT_EQ(last.move.yaw, some.yaw);
  EXPECT_EQ(last.variance, 0.04);
  EXPECT_GT(after->taken, read.map_frame->taken);
  EXPECT_FALSE(writer.map_frame(belief));
  call.area.pop_back();
  EXPECT_THROW(reader.take_map_frame(call, "call"), InputError);
}

TEST_F(DriveReplayTest, APlanThatRestsOnOtherThingsDiffers) {
  const auto differs_at = [&](const std::function<void(std::vector<PlannerCall>&)>& change) {
    std::vector<PlannerCall> calls = *calls_;
    change(calls);
    write(calls);
    const DriveReplay made = replay();
    EXPECT_NE(made.difference.what, "");
    return made.difference.step;
  };
  using Calls = std::vector<PlannerCall>;
  EXPECT_EQ(differs_at([](Calls& calls) { calls[5].plan_hash ^= 1; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { calls[5].cost += 1e-9; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { ++calls[5].cost_evaluations; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { ++calls[5].gradient_evaluations; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { calls[3].voxels = calls[3].ground = {}; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { calls[4].pose[0] += 1e-6; }), 1);
  EXPECT_EQ(differs_at([](Calls& calls) { calls[7].task = 0; }), 2);
  EXPECT_EQ(differs_at([](Calls& calls) { calls[7].goal[1] += 1e-6; }), 2);
}

TEST_F(DriveReplayTest, CallsThatAreNotInTheLogAreTold) {
  ASSERT_EQ(calls_->size(), std::size_t{3 * kSteps + 1});
  const std::string eighth = "call 8 of the planner, after step 1 at 0.623 s";
  const auto expect_two = [&](const DriveReplay& made, const std::string& missing) {
    EXPECT_EQ(made.missing, missing);
    EXPECT_EQ(made.plans, 2);
    EXPECT_EQ(made.steps, kSteps);
    EXPECT_EQ(made.difference.step, -1) << made.difference.what;
  };
  write(without(8, 9));
  expect_two(replay(), eighth);
  write(without(8, calls_->size()));  // an end that is cut, and steps after it
  expect_two(replay(), eighth);
  write(without(7, 8), 1);
  EXPECT_EQ(replay().missing, "call 7 of the planner, after step 0 at 0.123 s")
      << "last that is told";

  // The last one: nothing after it tells.
  write(*calls_, kSteps, 1);
  EXPECT_EQ(replay().missing, "call 13 of the planner, after step 3 at 1.623 s");

  // Before what is asked for.
  write(without(8, 9));
  ReplayOptions options;
  options.to = 1;
  const DriveReplay first = replay(options);
  EXPECT_EQ(first.missing, "");
  EXPECT_EQ(first.replay.steps.size(), 2U);
  options.to = 2;
  EXPECT_EQ(replay(options).missing, eighth);
  options.from = 2;
  expect_refused([&] { replay(options); },
                 log() + ": " + eighth + ", is not in it; expected the calls up to step 2");
  write(without(0, 1));
  expect_refused([&] { replay(); }, "call 0 of the planner, before the first step, is not in it");
  write(without(2, calls_->size()));  // a plan was asked for, and what came of it is not told
  expect_refused([&] { replay(); }, "call 2 of the planner, after step 0 at 0.123 s, is not in it");
}

TEST_F(DriveReplayTest, AFolderKnowsOfStepsThatItsLogLacks) {
  write(without(3, calls_->size()), 1);
  RecordedRun run;
  run.source = folder_;
  run.rows.assign(kSteps, "a row");
  const DriveReplay made = replay_calls(run, configuration(), {}, {});
  EXPECT_EQ(made.missing, "call 3 of the planner, after step 0 at 0.123 s");
  EXPECT_EQ(made.steps, kSteps);
  run.rows.resize(1);
  EXPECT_EQ(replay_calls(run, configuration(), {}, {}).missing, "");
}

TEST_F(DriveReplayTest, TheFirstDifferenceIsTold) {
  std::vector<PlannerCall> calls = *calls_;
  calls[5].cost = 17.0;
  ++calls[5].cost_evaluations;
  calls[9].plan_hash ^= 1;
  write(calls);
  const DriveReplay made = replay();
  EXPECT_EQ(made.difference.step, 1);
  EXPECT_THAT(made.difference.what, testing::StartsWith("cost: 17 recorded, "));
  EXPECT_EQ(made.plans, kSteps);
  EXPECT_EQ(made.missing, "");
}

TEST_F(DriveReplayTest, StepsAreReportedFromAndToThoseThatAreAskedFor) {
  write(*calls_);
  ReplayOptions options;
  options.from = 1;
  options.to = 2;
  std::vector<int> shown;
  options.progress = [&](const StepRecord& step) { shown.push_back(step.step); };
  const DriveReplay made = replay(options);
  EXPECT_THAT(shown, testing::ElementsAre(0, 1, 2));
  ASSERT_EQ(made.replay.steps.size(), 2U);
  for (int n = 0; n < 2; ++n) {
    const ReplayedStep& step = made.replay.steps[static_cast<std::size_t>(n)];
    EXPECT_EQ(step.recorded.step, n + 1);
    EXPECT_EQ(step.other.step, n + 1);
    // Of one time: that at which the plan was driven, not that of its belief.
    EXPECT_EQ(step.other.time, step.recorded.time);
    EXPECT_EQ(step.other.time, 0.5 * (n + 1) + 0.1234);
  }
  EXPECT_THAT(made.notes, testing::Contains(HasSubstr("no summary; made of the 4 steps")));
}

// A log may lack messages of steps; the calls are there.
TEST_F(DriveReplayTest, APlanWithoutARecordedStepIsMadeAndNotReported) {
  write(*calls_, 2);
  std::vector<double> times;
  ReplayOptions options;
  options.progress = [&](const StepRecord& step) { times.push_back(step.time); };
  const DriveReplay made = replay(options);
  EXPECT_EQ(made.plans, kSteps);
  EXPECT_EQ(made.steps, 2);
  EXPECT_EQ(made.replay.steps.size(), 2U);
  EXPECT_THAT(times, testing::ElementsAre(0.1234, 0.6234, 1.25, 1.75));
}

// Nothing is recorded of a step before the first map, but it counts.
TEST_F(DriveReplayTest, APlanWithoutAMapIsAStep) {
  const Configuration c = configuration();
  Planner planner(c.robot, c.planner, Registries().solvers.make(c.solver));
  PlannerCallWriter writer;
  std::vector<PlannerCall> calls;
  for (const Belief& belief :
       {Belief(), test::Room{.seen = 2.0, .landmarks_per_wall = 10}.belief()}) {
    calls.push_back(writer.plan(belief));
    calls.push_back(writer.planned(planner.plan(belief)));
  }
  write(calls, 2);
  const DriveReplay made = replay();
  EXPECT_EQ(made.plans, 2);
  EXPECT_EQ(made.difference.step, -1) << made.difference.what;
  EXPECT_EQ(made.missing, "");
  ASSERT_EQ(made.replay.steps.size(), 1U);
  EXPECT_EQ(made.replay.steps[0].recorded.step, 1);
}

TEST_F(DriveReplayTest, WhatIsCancelledLacksNothing) {
  write(*calls_);
  ReplayOptions options;
  int shown = 0;
  options.progress = [&](const StepRecord&) { ++shown; };
  options.cancelled = [&] { return shown == 2; };
  const DriveReplay made = replay(options);
  EXPECT_EQ(shown, 2);
  EXPECT_EQ(made.replay.steps.size(), 2U);
  EXPECT_EQ(made.missing, "");
}

TEST_F(DriveReplayTest, WhatDriveDoesNotWriteIsRefused) {
  write({});
  expect_refused([&] { replay(); }, log() + ": no /planner/calls");
  write(*calls_, kSteps, 0, ros::DiagnosticArray::kType);
  expect_refused([&] { replay(); }, std::string("expected ") + PlannerCall::kType);
  std::vector<PlannerCall> calls = *calls_;
  calls[7].kind = 5;
  write(calls);
  expect_refused([&] { replay(); },
                 log() + ": call 7 of the planner: is of kind 5; expected 0 to 4");
  calls = without(1, 2);
  for (std::size_t n = 0; n < calls.size(); ++n) calls[n].sequence = static_cast<std::uint32_t>(n);
  write(calls);
  expect_refused([&] { replay(); }, "call 1 of the planner: a plan that nobody asked for");
  {
    McapWriter writer(log());
    const std::uint16_t call = writer.add_channel(topic::kPlannerCalls, PlannerCall::kType, "");
    writer.message(call, 1, ros::to_cdr(calls_->front()));
    writer.message(call, 2, "cut");
    writer.close();
  }
  expect_refused([&] { replay(); }, log() + ": message 2 of /planner/calls");
  RecordedRun run;
  run.source = folder_ + "/none";
  expect_refused([&] { replay_calls(run, configuration(), {}, {}); },
                 "none/mission.mcap: no such file");
}

}  // namespace
}  // namespace prospect::drive_replay_test
