// SPDX-License-Identifier: Apache-2.0
#include "engine/task/task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace prospect::task_test {
namespace {

TEST(Task, EveryFaultIsALine) {
  Zones zones;
  zones.bound = Polygon{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
  zones.keep_out = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}};
  const ZoneMap map(zones);
  const double inf = std::numeric_limits<double>::infinity();
  const auto with = [](Task task, double position, double yaw) {
    task.goal.position_tolerance = position;
    task.goal.yaw_tolerance = yaw;
    return task;
  };
  const std::vector<std::pair<Task, std::string>> table = {
      {Task::go_to({1.5, 1.5}), "goal: is in zones.keep_out[0]"},
      {Task::go_to({0.9, 1.5}), "goal: is 0.10 m from zones.keep_out[0]"},
      {Task::go_to({6.0, 0.0}), "goal: is beyond zones.bound"},
      {Task::go_to({4.9, 0.0}), "goal: is 0.10 m from zones.bound"},
      {Task::go_to({inf, 0.0}), "goal: is not finite"},
      {Task::go_to({2e6, 0.0}), "goal: is not finite or beyond"},
      {Task::go_to({0.0, 0.0}, std::nan("")), "the yaw is not finite"},
      {with(Task::go_to({0, 0}), 0.01, 0.1), "position_tolerance is 0.01"},
      {with(Task::return_to_start(), 0.1, 4.0), "yaw_tolerance is 4"},
      {Task::explore(Polygon{{0, 0}, {2, 2}, {2, 0}, {0, 2}}), "area: sides 1 and 3 meet"},
  };
  for (const auto& [task, expected] : table) {
    const std::vector<std::string> list = faults(task, &map, 0.2);
    ASSERT_EQ(list.size(), 1u) << expected;
    EXPECT_NE(list[0].find(expected), std::string::npos) << list[0];
    EXPECT_NE(list[0].find("expected"), std::string::npos) << list[0];
  }
  EXPECT_TRUE(faults(Task::go_to({0.79, 1.5}), &map, 0.2).empty());
  EXPECT_TRUE(faults(Task::go_to({1.5, 1.5}), nullptr, 0.2).empty());
  EXPECT_TRUE(faults(Task::explore(), &map, 0.2).empty());
  EXPECT_TRUE(faults(Task::return_to_start(), &map, 0.2).empty());
  // What a task does not use does not matter.
  Task hold = Task::hold();
  hold.goal.position.x() = inf;
  hold.area = Polygon();
  EXPECT_TRUE(faults(hold, &map, 0.2).empty());
}

}  // namespace
}  // namespace prospect::task_test
