// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/planner_calls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"

namespace prospect::planner_calls_test {
namespace {

using ::testing::HasSubstr;

/// As a log keeps it.
PlannerCall through_bytes(const PlannerCall& call) {
  const std::string bytes = ros::to_cdr(call);
  return ros::from_cdr<PlannerCall>(bytes, "call");
}

Landmark landmark(std::uint64_t id, double x) {
  Landmark l;
  l.id = id;
  l.position = {x, 0.1 * x, 1.0 / 3.0};
  l.covariance(0, 1) = l.covariance(1, 0) = 1e-7 * x;
  l.creation_direction = {0.6, 0.0, 0.8};
  l.creation_range = 3.0 + x;
  l.survival = 0.7;
  l.multiplicity = 2.0;
  l.per_cell = 0.01 * x;
  return l;
}

Belief belief() {
  Belief b;
  b.stamp = 12.3;
  b.stamps = {12.1, 12.2, 12.15, 12.25};
  b.pose = {{1.0 / 7.0, -2.0, 0.05}, 0.4};
  b.covariance.diagonal() << 1e-4, 2e-4, 0.0, 3e-5;
  b.covariance(0, 3) = b.covariance(3, 0) = -1e-6;
  b.twist = {{0.3, -0.01, 0.0}, 0.2};
  b.localization = Localization::kDegraded;
  b.tracked_features = 57;
  VoxelGrid voxels({0.1, -3, -2, 20, 10}, 0.0, 0.5);
  voxels.set(1, 2, 3, CellState::kOccupied);
  b.voxels = std::make_shared<const VoxelGrid>(voxels);
  GroundMap ground({0.1, -3, -2, 20, 10});
  ground.set({1, 2}, CellState::kOccupied, true);
  ground.set({2, 2}, CellState::kFree);
  b.ground = std::make_shared<const GroundMap>(ground);
  LandmarkMap map;
  map.landmarks = {landmark(4, 1.0), landmark(9, 2.0), landmark(2, 3.0), landmark(7, 4.0)};
  map.feature_density = 3.5;
  map.odometry_noise = OdometryNoise{0.004, 0.005, 0.006, 0.007, 80.0, 9.0, 0.02};
  b.landmarks = std::make_shared<const LandmarkMap>(map);
  return b;
}

void expect_same(const Belief& a, const Belief& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.stamps.pose, b.stamps.pose);
  EXPECT_EQ(a.stamps.map, b.stamps.map);
  EXPECT_EQ(a.stamps.landmarks, b.stamps.landmarks);
  EXPECT_EQ(a.stamps.ranges, b.stamps.ranges);
  EXPECT_EQ(a.pose.position, b.pose.position);
  EXPECT_EQ(a.pose.yaw, b.pose.yaw);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.twist.linear, b.twist.linear);
  EXPECT_EQ(a.twist.yaw_rate, b.twist.yaw_rate);
  ASSERT_EQ(a.command.has_value(), b.command.has_value());
  if (a.command) {
    EXPECT_EQ(a.command->linear, b.command->linear);
    EXPECT_EQ(a.command->yaw_rate, b.command->yaw_rate);
  }
  EXPECT_EQ(a.localization, b.localization);
  EXPECT_EQ(a.localization_source, b.localization_source);
  EXPECT_EQ(a.tracked_features, b.tracked_features);
  ASSERT_EQ(a.movers == nullptr, b.movers == nullptr);
  if (a.movers) {
    EXPECT_EQ(a.movers->stamp, b.movers->stamp);
    ASSERT_EQ(a.movers->all.size(), b.movers->all.size());
    for (std::size_t n = 0; n < a.movers->all.size(); ++n) {
      const Mover &l = a.movers->all[n], &m = b.movers->all[n];
      EXPECT_EQ(l.position, m.position);
      EXPECT_EQ(l.velocity, m.velocity);
      EXPECT_EQ(l.radius, m.radius);
      EXPECT_EQ(l.spread, m.spread);
    }
  }
  EXPECT_TRUE(b.octree);
  EXPECT_EQ(a.voxels->frame(), b.voxels->frame());
  EXPECT_EQ(a.voxels->k0(), b.voxels->k0());
  EXPECT_EQ(a.voxels->depth(), b.voxels->depth());
  EXPECT_EQ(a.voxels->data(), b.voxels->data());
  EXPECT_EQ(a.ground->frame(), b.ground->frame());
  EXPECT_EQ(a.ground->cells().data, b.ground->cells().data);
  EXPECT_EQ(a.ground->sights().data, b.ground->sights().data);
  ASSERT_EQ(a.landmarks == nullptr, b.landmarks == nullptr);
  if (!a.landmarks) return;
  EXPECT_EQ(a.landmarks->feature_density, b.landmarks->feature_density);
  EXPECT_EQ(a.landmarks->image_cell, b.landmarks->image_cell);
  ASSERT_EQ(a.landmarks->odometry_noise.has_value(), b.landmarks->odometry_noise.has_value());
  if (a.landmarks->odometry_noise) {
    const OdometryNoise &m = *a.landmarks->odometry_noise, &n = *b.landmarks->odometry_noise;
    EXPECT_EQ(m.position_per_metre, n.position_per_metre);
    EXPECT_EQ(m.position_per_radian, n.position_per_radian);
    EXPECT_EQ(m.yaw_per_metre, n.yaw_per_metre);
    EXPECT_EQ(m.yaw_per_radian, n.yaw_per_radian);
    EXPECT_EQ(m.reference_count, n.reference_count);
    EXPECT_EQ(m.floor_count, n.floor_count);
    EXPECT_EQ(m.scale, n.scale);
  }
  ASSERT_EQ(a.landmarks->landmarks.size(), b.landmarks->landmarks.size());
  for (std::size_t n = 0; n < a.landmarks->landmarks.size(); ++n) {
    const Landmark &l = a.landmarks->landmarks[n], &m = b.landmarks->landmarks[n];
    EXPECT_EQ(l.id, m.id);
    EXPECT_EQ(l.position, m.position);
    EXPECT_EQ(l.covariance, m.covariance);
    EXPECT_EQ(l.creation_direction, m.creation_direction);
    EXPECT_EQ(l.creation_range, m.creation_range);
    EXPECT_EQ(l.survival, m.survival);
    EXPECT_EQ(l.multiplicity, m.multiplicity);
    EXPECT_EQ(l.per_cell, m.per_cell);
  }
}

TEST(PlannerCalls, BeliefsAreTheSameWhateverChanges) {
  PlannerCallWriter writer;
  PlannerCallReader reader;
  std::uint32_t calls = 0;
  const auto told = [&](const Belief& b) {
    const PlannerCall call = through_bytes(writer.plan(b));
    EXPECT_EQ(call.sequence, calls++);
    EXPECT_EQ(call.kind, PlannerCall::kPlan);
    const Belief read = reader.belief(call, "call");
    expect_same(b, read);
    return read;
  };
  Belief b = belief();
  const Belief first = told(b);

  // Nothing but the pose: maps are not told again, and stay the same objects.
  b.stamp = 12.8;
  b.command = Twist{{0.1, 0.0, 0.0}, -0.0};
  const PlannerCall same = writer.prepare(b);
  EXPECT_EQ(same.sequence, calls++);
  EXPECT_EQ(same.kind, PlannerCall::kPrepare);
  EXPECT_FALSE(same.voxels.changed || same.ground.changed || same.landmarks_changed);
  const Belief read = reader.belief(through_bytes(same), "call");
  expect_same(b, read);
  EXPECT_TRUE(std::signbit(read.command->yaw_rate)) << "every bit";
  EXPECT_EQ(read.voxels, first.voxels);
  EXPECT_EQ(read.ground, first.ground);
  EXPECT_EQ(read.landmarks, first.landmarks);

  // Cells that change, appear and are forgotten, within the frame and beyond it.
  VoxelGrid voxels = *b.voxels;
  voxels.set(1, 2, 3, CellState::kFree);
  voxels.set(1, 2, 4, CellState::kFree);
  voxels.set(5, 5, 0, CellState::kOccupied);
  b.voxels = std::make_shared<const VoxelGrid>(voxels);
  GroundMap ground = *b.ground;
  ground.set({1, 2}, CellState::kOccupied, false);
  ground.set({2, 2}, CellState::kUnknown);
  b.ground = std::make_shared<const GroundMap>(ground);
  told(b);
  voxels.set(400, 2, 3, CellState::kOccupied);
  b.voxels = std::make_shared<const VoxelGrid>(voxels);
  ground.set({-300, 2}, CellState::kFree);
  b.ground = std::make_shared<const GroundMap>(ground);
  told(b);

  // Every other place, and the same frame at another height or of another depth.
  for (int n = 0; n < voxels.frame().size(); n += 2) {
    const Cell cell = voxels.frame().at(n);
    voxels.set(cell.i, cell.j, n % 5, CellState::kFree);
  }
  b.voxels = std::make_shared<const VoxelGrid>(voxels);
  told(b);
  const auto same_data = [&](int k0, int depth) {
    const std::size_t size = static_cast<std::size_t>(voxels.frame().size() * depth);
    return std::make_shared<const VoxelGrid>(voxels.frame(), k0, depth,
                                             std::vector<CellState>(size, CellState::kFree));
  };
  for (const auto& [k0, depth] : {std::pair(0, 4), std::pair(1, 4), std::pair(1, 6)}) {
    b.voxels = same_data(k0, depth);
    told(b);
  }

  // Landmarks that change, come, go, and change places.
  LandmarkMap map = *b.landmarks;
  map.landmarks[1].position.x() += 1e-15;
  map.landmarks.push_back(landmark(11, 5.0));
  b.landmarks = std::make_shared<const LandmarkMap>(map);
  const PlannerCall few = writer.plan(b);
  EXPECT_EQ(few.landmark_ids.size(), 2U) << "what is the same is not told again";
  ++calls;
  expect_same(b, reader.belief(through_bytes(few), "call"));
  map.landmarks = {map.landmarks[4], map.landmarks[0], map.landmarks[3]};
  map.odometry_noise.reset();
  map.image_cell = 0.04;
  b.landmarks = std::make_shared<const LandmarkMap>(map);
  told(b);
  map.landmarks.clear();
  b.landmarks = std::make_shared<const LandmarkMap>(map);
  told(b);
  b.landmarks = nullptr;
  b.localization_source = LocalizationSource::kExternal;
  told(b);
  b.landmarks = std::make_shared<const LandmarkMap>(*belief().landmarks);
  told(b);

  // Somebody comes, two are there, nobody is.
  for (const std::size_t count : {1U, 2U, 0U}) {
    Movers movers{12.75, {}};
    movers.all.resize(count, {{1.0 / 3.0, -2.0}, {0.1, 1.2}, 0.25, 0.3});
    b.movers = std::make_shared<const Movers>(movers);
    told(b);
  }
  b.movers = nullptr;
  told(b);
}

TEST(PlannerCalls, TasksAndPlansAreTold) {
  PlannerCallWriter writer;
  Task task = Task::go_to({1.5, -2.5}, 0.25);
  task.goal.position_tolerance = 0.3;
  task.goal.yaw_tolerance = 0.4;
  const Task read = task_of(through_bytes(writer.task(task)), "call");
  EXPECT_EQ(read.kind, TaskKind::kGoTo);
  EXPECT_EQ(read.goal.position, task.goal.position);
  EXPECT_EQ(read.goal.yaw, task.goal.yaw);
  EXPECT_EQ(read.goal.position_tolerance, 0.3);
  EXPECT_EQ(read.goal.yaw_tolerance, 0.4);
  EXPECT_FALSE(read.area);
  const Task area =
      task_of(through_bytes(writer.task(Task::explore(Polygon{{0, 0}, {4, 0}, {4, 3}}))), "call");
  ASSERT_TRUE(area.area);
  EXPECT_EQ(area.area->at(2), Eigen::Vector2d(4, 3));
  EXPECT_FALSE(area.goal.yaw);

  Plan plan;
  plan.states = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0)};
  plan.inputs = {Eigen::Vector2d(0.4, 0.1)};
  plan.commands = {{{0.4, 0, 0}, 0.1}};
  plan.tail = {{{0.2, 0, 0}, 0.0}};
  plan.committed = 1;
  plan.explanation.cost = -1.0 / 3.0;
  plan.counters.cost_evaluations = 48;
  plan.counters.gradient_evaluations = 12;
  const PlannerCall planned = through_bytes(writer.planned(plan));
  EXPECT_EQ(planned.kind, PlannerCall::kPlanned);
  EXPECT_EQ(planned.plan_hash, plan_hash(plan));
  EXPECT_EQ(planned.cost, -1.0 / 3.0);
  EXPECT_EQ(planned.cost_evaluations, 48);
  EXPECT_EQ(planned.gradient_evaluations, 12);
  std::vector<std::uint64_t> hashes = {plan_hash(plan)};
  const auto changed = [&](const std::function<void(Plan&)>& change) {
    Plan other = plan;
    change(other);
    hashes.push_back(plan_hash(other));
  };
  changed([](Plan& p) { p.states[1].x() = std::nextafter(0.1, 1.0); });
  changed([](Plan& p) { p.inputs[0].y() = std::nextafter(0.1, 1.0); });
  changed([](Plan& p) { p.commands[0].yaw_rate = std::nextafter(0.1, 1.0); });
  changed([](Plan& p) { p.commands[0].linear.z() = 0.1; });
  changed([](Plan& p) { p.tail[0].linear.x() = std::nextafter(0.2, 1.0); });
  changed([](Plan& p) { p.committed = 2; });
  EXPECT_EQ(std::set(hashes.begin(), hashes.end()).size(), hashes.size());
}

TEST(PlannerCalls, WhatDoesNotFitIsRefused) {
  PlannerCallWriter writer;
  const PlannerCall first = writer.plan(belief());
  Belief other = belief();
  VoxelGrid voxels = *other.voxels;
  voxels.set(1, 2, 3, CellState::kFree);
  other.voxels = std::make_shared<const VoxelGrid>(voxels);
  const PlannerCall second = writer.plan(other);
  const auto refused = [&](bool after_first, PlannerCall call, const char* what) {
    PlannerCallReader reader;
    if (after_first) reader.belief(first, "first");
    try {
      reader.belief(call, "log: call 2");
      ADD_FAILURE() << "expected a refusal: " << what;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("log: call 2: " + std::string(what)));
    }
  };
  refused(false, second, "changes of no voxels");
  PlannerCall call = second;
  call.voxels.runs[0] = 1U << 31;
  refused(true, call, "map changes outside the map");
  call = second;
  call.voxels.runs.back() = 1000;
  refused(true, call, "map changes outside the map");
  call = second;
  call.voxels.runs.pop_back();
  refused(true, call, "half a run");
  call = second;
  call.voxels.values[0] = 3;
  refused(true, call, "no state of a cell");
  call = first;
  call.voxels.frame[2] = std::numeric_limits<std::int32_t>::max();
  refused(false, call, "no frame of a map");
  call = first;
  call.ground.frame[0] = std::numeric_limits<std::int32_t>::min();
  refused(false, call, "no frame of a map");
  call = first;
  call.ground.frame[2] = 1 << 30;
  call.ground.frame[5] = 0;  // as many places as there are values: none
  call.ground.values.clear();
  refused(false, call, "no frame of a map");
  call = first;
  call.voxels.frame[5] = 0;
  call.voxels.values.clear();
  refused(false, call, "no frame of a map");
  call = first;
  call.landmark_runs = {0, 3, 0, 0, 3, 0};  // of four
  refused(true, call, "landmarks more than once");
  call = first;
  call.landmark_runs[1] = 7;
  refused(false, call, "landmarks that are not there");
  call = first;
  call.landmark_values.pop_back();
  refused(false, call, "landmarks that are cut off");
  call = first;
  call.area = {12.0, 1.0};
  refused(false, call, "movers that are cut off");
  call = first;
  call.localization = 9;
  refused(false, call, "no localization");
  call = writer.task(Task::hold());
  call.task = 17;
  EXPECT_THROW(task_of(call, "log"), InputError);
}

}  // namespace
}  // namespace prospect::planner_calls_test
