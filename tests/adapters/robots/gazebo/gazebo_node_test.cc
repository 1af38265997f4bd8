// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/fake_gazebo.h"

namespace prospect::gazebo_node_test {
namespace {

using test::FakeGazebo;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const std::string kTopic = "/gazebo/room/thing";

/// Spins until `done`, at most 5 s.
bool spins_until(GazeboNode& node, const std::function<bool()>& done) {
  for (int n = 0; n < 1000 && !done(); ++n) node.spin(0.005);
  return done();
}

TEST(GazeboNode, KnowsTheWorldAndReceives) {
  FakeGazebo gazebo;
  GazeboNode node(gazebo.options().address);
  EXPECT_EQ(node.world(), "room");
  std::vector<std::string> came;
  node.subscribe(kTopic, "gazebo.msgs.Thing",
                 [&](std::string_view message) { came.emplace_back(message); });
  ASSERT_TRUE(spins_until(node, [&] { return gazebo.subscribers(kTopic) == 1; }));
  EXPECT_EQ(node.publishers(kTopic), 1);
  gazebo.publish(kTopic, std::string("first"));
  gazebo.publish(kTopic, std::string(300000, 'x'));
  ASSERT_TRUE(spins_until(node, [&] { return came.size() == 2; }));
  EXPECT_EQ(came.front(), "first");
  EXPECT_EQ(came.back(), std::string(300000, 'x'));
  EXPECT_TRUE(node.connected());
  EXPECT_THAT(node.faults(), IsEmpty());
}

TEST(GazeboNode, AHandlerThatThrowsIsAFault) {
  FakeGazebo gazebo;
  GazeboNode node(gazebo.options().address);
  int calls = 0;
  node.subscribe(kTopic, "gazebo.msgs.Thing", [&](std::string_view) {
    ++calls;
    throw std::runtime_error("call " + std::to_string(calls));
  });
  ASSERT_TRUE(spins_until(node, [&] { return gazebo.subscribers(kTopic) == 1; }));
  gazebo.publish(kTopic, std::string("a"));
  gazebo.publish(kTopic, std::string("b"));
  ASSERT_TRUE(spins_until(node, [&] { return calls == 2; }));
  EXPECT_THAT(node.faults(), ElementsAre(kTopic + ": call 2"));
  EXPECT_TRUE(node.connected());
}

TEST(GazeboNode, WhatClosesIsAFault) {
  FakeGazebo gazebo;
  GazeboNode node(gazebo.options().address);
  node.subscribe(kTopic, "gazebo.msgs.Thing", [](std::string_view) {});
  ASSERT_TRUE(spins_until(node, [&] { return gazebo.subscribers(kTopic) == 1; }));
  gazebo.end();
  ASSERT_TRUE(spins_until(node, [&] { return node.faults().size() == 2; }));
  EXPECT_FALSE(node.connected());
  EXPECT_THAT(node.faults(), UnorderedElementsAre(HasSubstr("master: "), HasSubstr(kTopic)));
}

TEST(GazeboNode, ATooLongMessageClosesItsTopic) {
  FakeGazebo gazebo;
  GazeboAddress address = gazebo.options().address;
  address.frame_limit = 1000;
  GazeboNode node(address);
  node.subscribe(kTopic, "gazebo.msgs.Thing", [](std::string_view) { FAIL(); });
  ASSERT_TRUE(spins_until(node, [&] { return gazebo.subscribers(kTopic) == 1; }));
  gazebo.publish(kTopic, std::string(1001, 'x'));
  ASSERT_TRUE(spins_until(node, [&] { return !node.faults().empty(); }));
  EXPECT_THAT(node.faults().front(), HasSubstr("1001 bytes; at most 1000"));
  EXPECT_FALSE(node.connected());
}

TEST(GazeboNode, RefusesWhatDoesNotGreetAsAMaster) {
  FakeGazebo gazebo;
  gazebo.end();  // it accepts, and closes
  GazeboAddress address = gazebo.options().address;
  address.timeout = 1.0;
  try {
    GazeboNode node(address);
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("expected a master of Gazebo 11"));
  }
}

}  // namespace
}  // namespace prospect::gazebo_node_test
