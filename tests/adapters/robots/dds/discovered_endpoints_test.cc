// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/discovered_endpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace prospect::discovered_endpoints_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

TEST(DiscoveredEndpoints, TellsWhoPublishesByTheBestNameThereIs) {
  DiscoveredEndpoints all;
  all.add("a", {"rt/cmd_vel", "Twist", "P", true});
  all.add("b", {"rt/cmd_vel", "TwistStamped", "Q", true});
  all.add("c", {"rt/cmd_vel", "TwistStamped", "P", false});
  all.add("d", {"rt/odom", "Odometry", "P", true});
  EXPECT_THAT(all.writers("rt/cmd_vel", ""), UnorderedElementsAre("61", "62")) << "nameless";
  all.set_participant("P", "the process rviz2 (123 on robot)");
  all.set_nodes("Q", {{"b", "/teleop"}, {"x", "/other"}});
  EXPECT_THAT(all.writers("rt/cmd_vel", ""),
              UnorderedElementsAre("the process rviz2 (123 on robot)", "/teleop"));
  EXPECT_THAT(all.writers("rt/cmd_vel", "TwistStamped"), ElementsAre("/teleop"));
  EXPECT_THAT(all.writers("rt/scan", ""), IsEmpty());
  EXPECT_EQ(all.other_type("rt/cmd_vel", "TwistStamped", true), "Twist");
  EXPECT_EQ(all.other_type("rt/cmd_vel", "TwistStamped", false), "");
  all.remove("b");
  all.set_participant("P", "");
  EXPECT_THAT(all.writers("rt/cmd_vel", ""), ElementsAre("the process rviz2 (123 on robot)"));
  all.remove_participant("P");
  EXPECT_THAT(all.writers("rt/cmd_vel", ""), ElementsAre("61"));
}

TEST(DiscoveredEndpoints, AreBounded) {
  DiscoveredEndpoints all;
  for (int k = 0; k < 5000; ++k) {
    const std::string key = std::to_string(k);
    all.add(key, {"rt/cmd_vel", "Twist", key, true});
    all.set_participant(key, "name");
    all.set_nodes(key, {{key, "/node"}});
  }
  EXPECT_THAT(all.writers("rt/cmd_vel", ""), SizeIs(1000));
}

}  // namespace
}  // namespace prospect::discovered_endpoints_test
