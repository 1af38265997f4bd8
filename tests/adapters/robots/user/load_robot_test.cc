// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/load_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/robots/user/joined_robots.h"
#include "adapters/robots/user/make_robot.h"
#include "models/unicycle.h"
#include "solvers/load_plugin.h"

namespace prospect::load_robot_test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class PluginRobotTest : public testing::Test {
 protected:
  ~PluginRobotTest() override { unsetenv("PROSPECT_TEST_FAULT"); }
  static void set_fault(const std::string& fault) {
    setenv("PROSPECT_TEST_FAULT", fault.c_str(), 1);
  }
  static UserRobot load() {
    SolverRegistry solvers;
    TermRegistry terms;
    ProblemRegistry problems;
    const PluginRobot* robot = nullptr;
    load_plugin(PROSPECT_PLUGIN_ROBOT, {solvers, terms, problems, &robot});
    if (!robot) throw std::invalid_argument("none");
    return load_robot(*robot, PROSPECT_PLUGIN_ROBOT);
  }
  static std::string refusal(const std::string& fault) {
    set_fault(fault);
    try {
      load();
      return "accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_THAT(e.what(), AllOf(StartsWith("plug-in '"), Not(HasSubstr("\n"))));
      return e.what();
    }
  }
  static UserRobotConfiguration configuration(const UserRobot& user) {
    UserRobotConfiguration options{.user = user, .robot = {}};
    options.robot.model = std::make_shared<const Unicycle>();
    options.inbox.poses_in_runtime_clock = true;
    for (const OptionInfo& option : user.options) options.options[option.name] = option.fallback;
    return options;
  }
};

TEST_F(PluginRobotTest, IsTheRobotThatAProgramWouldGive) {
  set_fault("");
  const UserRobot user = load();
  EXPECT_EQ(user.name, "odd");
  ASSERT_EQ(user.options.size(), 2u);
  EXPECT_EQ(std::get<int>(user.options[1].fallback), 5);
  const Robot robot = make_robot(configuration(user));
  EXPECT_EQ(robot.base->dead_man(), 0.4);
  EXPECT_EQ(robot.base->name(), "odd base");
  ASSERT_TRUE(robot.frames->wait(20.0, {}));
  EXPECT_TRUE(std::holds_alternative<ExternalPose>(*robot.frames->take()));
}

TEST_F(PluginRobotTest, OneThatDoesNotFitIsRefusedInALine) {
  for (const auto& [fault, words] : std::vector<std::pair<std::string, std::string>>{
           {"report", "other sizes of drivers, frames or reports"},
           {"frame", "other sizes of drivers, frames or reports"},
           {"no describe", "no describe()"},
           {"no robot", "offers nothing"},
           {"describe throws", "its robot failed: no licence"},
           {"describe throws a number", "not a std::exception"},
           {"name", "the robot's name is 'my robot'"},
           {"option", "an option is named 'a port'"},
           {"option twice", "two options are named 'rate'"},
           {"no make", "no make()"}}) {
    EXPECT_THAT(refusal(fault), HasSubstr(words)) << fault;
  }
  set_fault("");
  const UserRobot user = load();
  for (const auto& [fault, words] : std::vector<std::pair<std::string, std::string>>{
           {"make throws", "no robot at nowhere"},
           {"dead_man throws", "its base failed in dead_man(): no dead-man today"}}) {
    set_fault(fault);
    try {
      make_robot(configuration(user));
      ADD_FAILURE() << fault;
    } catch (const std::invalid_argument& e) {
      EXPECT_THAT(e.what(), EndsWith(words));
    }
  }
}

/// What its base and sensors tell, once one of them tells anything.
std::vector<std::string> faults_of(const Robot& robot) {
  const SteadyClock clock;
  for (const double end = clock.now() + 20.0; clock.now() < end;) {
    robot.base->send({{0.3, 0.0, 0.0}, 0.0}, clock.now() + 0.2);
    std::vector<std::string> all = robot.base->report().faults;
    for (const std::string& fault : robot.link_faults()) all.push_back(fault);
    if (!all.empty()) return all;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {};
}

TEST_F(PluginRobotTest, WhatItsDriversThrowIsAFault) {
  set_fault("");
  const UserRobot user = load();
  for (const auto& [fault, told] : std::vector<std::pair<std::string, std::string>>{
           {"send throws", "its driver failed in send(): no motors today"},
           {"report throws a number",
            "its driver failed in report(): an exception that is not a std::exception"},
           {"fault without words", "a fault without words"},
           {"sensors throw a number",
            "the sensors have failed: an exception that is not a std::exception"}}) {
    set_fault(fault);
    EXPECT_EQ(faults_of(make_robot(configuration(user))), std::vector{told}) << fault;
  }
}

TEST_F(PluginRobotTest, FramesOfNothingAreNoFrames) {
  set_fault("frames of nothing");
  const Robot robot = make_robot(configuration(load()));
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(robot.frames->wait(20.0, {}));
    EXPECT_TRUE(std::holds_alternative<ExternalPose>(*robot.frames->take()));
  }
}

}  // namespace
}  // namespace prospect::load_robot_test
