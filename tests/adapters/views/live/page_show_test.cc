// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/page_show.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/adapters/synthetic_run.h"

namespace prospect::page_show_test {
namespace {

using nlohmann::json;

class PageShowTest : public ::testing::Test {
 protected:
  static LiveFeed::News steps(int from, int to) {
    LiveFeed::News news;
    static const RunRecord run = synthetic_run(600);
    for (int k = from; k < to; ++k) {
      news.steps.push_back(std::make_shared<StepRecord>(run.steps[static_cast<std::size_t>(k)]));
    }
    return news;
  }
  static LiveFeed::News pose(double x) {
    LiveFeed::News news;
    LivePose pose;
    pose.pose.position.x() = x;
    news.pose = std::make_shared<LivePose>(pose);
    return news;
  }
  /// All that a viewer is told by now.
  static std::vector<json> told(Viewer& viewer) {
    std::vector<json> messages;
    while (const std::optional<LiveMessage> message = viewer.next()) {
      EXPECT_FALSE(message->binary);
      messages.push_back(json::parse(*message->bytes));
    }
    return messages;
  }
  static std::vector<json> of(const std::vector<json>& messages, const std::string& op) {
    std::vector<json> found;
    for (const json& message : messages) {
      if (message["op"] == op) found.push_back(message);
    }
    return found;
  }
  /// Why a command is not done; "" if it is.
  static std::string refused(Viewer& viewer, const std::string& command) {
    EXPECT_TRUE(viewer.message(command, true));
    const std::vector<json> answers = of(told(viewer), "answer");
    EXPECT_EQ(answers.size(), 1U);
    return answers.empty() ? "no answer" : answers[0]["refused"].get<std::string>();
  }

  DriveRequests requests_;
  DriveCommands commands_{requests_};
  PageShow show_{0.1, true, commands_};
};

TEST_F(PageShowTest, AViewerIsWelcomedAndGetsAllStepsOnce) {
  show_.add(steps(0, 5));
  const auto viewer = show_.viewer(false);
  const std::vector<json> first = told(*viewer);
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first[0]["op"], "welcome");
  EXPECT_EQ(first[0]["may_command"], false);
  ASSERT_EQ(of(first, "steps").size(), 1U);
  EXPECT_EQ(of(first, "steps")[0]["part"]["steps"], 5);
  EXPECT_EQ(of(first, "status").size(), 1U);
  EXPECT_TRUE(told(*viewer).empty());
  show_.add(steps(5, 6));
  EXPECT_EQ(of(told(*viewer), "steps")[0]["part"]["steps"], 1);
  EXPECT_EQ(viewer->dropped(), 0U);
}

TEST_F(PageShowTest, WhoComesLateGetsPortionsWithoutAGap) {
  show_.add(steps(0, 450));
  const auto viewer = show_.viewer(false);
  int count = 0;
  for (const json& message : of(told(*viewer), "steps")) {
    EXPECT_LE(message["part"]["steps"], 200);
    count += message["part"]["steps"].get<int>();
  }
  EXPECT_EQ(count, 450);
}

TEST_F(PageShowTest, ASlowViewerMissesWhatIsNotTheNewestAndThatIsCounted) {
  const auto slow = show_.viewer(false), quick = show_.viewer(false);
  show_.add(pose(0.0));
  told(*slow);
  for (int k = 1; k <= 100; ++k) {
    show_.add(pose(k));
    show_.add(steps(k - 1, k));
    told(*quick);
  }
  const std::vector<json> late = told(*slow);
  ASSERT_EQ(of(late, "pose").size(), 1U);
  EXPECT_EQ(of(late, "pose")[0]["x"], 100.0);
  EXPECT_EQ(slow->dropped(), 99U);
  EXPECT_EQ(quick->dropped(), 0U);
  ASSERT_EQ(of(late, "steps").size(), 1U) << "steps are all there, in one portion";
  EXPECT_EQ(of(late, "steps")[0]["part"]["steps"], 100);
}

TEST_F(PageShowTest, NoKindOfMessageStarvesAnother) {
  const auto viewer = show_.viewer(false);
  told(*viewer);
  std::vector<std::string> ops;
  for (int k = 0; k < 10; ++k) {
    show_.add(steps(k, k + 1));
    show_.add(pose(k));
    ops.push_back(json::parse(*viewer->next()->bytes)["op"]);
  }
  EXPECT_THAT(ops, testing::AllOf(testing::Contains("steps"), testing::Contains("pose")));
}

TEST_F(PageShowTest, CommandsReachTheRobot) {
  const auto viewer = show_.viewer(true);
  told(*viewer);
  EXPECT_EQ(refused(*viewer, R"({"op":"command","name":"hold"})"), "");
  EXPECT_FALSE(requests_.told_to_drive());
  EXPECT_EQ(refused(*viewer, R"({"op":"command","name":"resume"})"), "");
  EXPECT_TRUE(requests_.told_to_drive());
  EXPECT_EQ(refused(*viewer, R"({"op":"command","name":"go","x":1.5,"y":-2})"), "");
  const auto place = requests_.take_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->position, Eigen::Vector2d(1.5, -2.0));
  EXPECT_EQ(refused(*viewer, R"({"op":"command","name":"stop"})"), "");
  EXPECT_TRUE(requests_.take_emergency_stop());
  EXPECT_FALSE(requests_.told_to_drive()) << "an acknowledgement alone must not start it";
  EXPECT_EQ(refused(*viewer, R"({"op":"command","name":"acknowledge"})"), "");
  EXPECT_TRUE(requests_.take_acknowledgement());
}

TEST_F(PageShowTest, AStopIsAcknowledgedBeforeAnythingElse) {
  const auto viewer = show_.viewer(true);
  told(*viewer);
  requests_.hold();
  requests_.set_stopped(true);
  EXPECT_NE(refused(*viewer, R"({"op":"command","name":"resume"})"), "");
  EXPECT_NE(refused(*viewer, R"({"op":"command","name":"go","x":1,"y":1})"), "");
  EXPECT_FALSE(requests_.told_to_drive());
  EXPECT_FALSE(requests_.take_place());
}

TEST_F(PageShowTest, WhoOnlyWatchesCommandsNothing) {
  const auto viewer = show_.viewer(false);
  told(*viewer);
  for (const char* name : {"hold", "stop", "acknowledge", "resume", "go"}) {
    EXPECT_THAT(
        refused(*viewer, std::string(R"({"op":"command","name":")") + name + R"(","x":1,"y":1})"),
        testing::HasSubstr("token"));
  }
  EXPECT_TRUE(requests_.told_to_drive());
  EXPECT_FALSE(requests_.take_emergency_stop());
  EXPECT_FALSE(requests_.take_acknowledgement());
  EXPECT_FALSE(requests_.take_place());
}

TEST_F(PageShowTest, WhatIsNoCommandIsRefused) {
  const auto viewer = show_.viewer(true);
  told(*viewer);
  for (const char* bad : {"", "hold", "[]", "{}", R"({"op":1})", R"({"op":"command"})",
                          R"({"op":"command","name":7})", R"({"op":"other","name":"hold"})",
                          "\xff\xfe", "[[[[[[[["}) {
    EXPECT_FALSE(viewer->message(bad, true)) << bad;
  }
  EXPECT_FALSE(viewer->message(R"({"op":"command","name":"hold"})", false)) << "binary";
  for (const char* bad : {R"({"op":"command","name":"dance"})", R"({"op":"command","name":"go"})",
                          R"({"op":"command","name":"go","x":"1","y":2})",
                          R"({"op":"command","name":"go","x":1e9,"y":2})",
                          R"({"op":"command","name":"go","x":1e999,"y":2})"}) {
    if (viewer->message(bad, true)) {
      EXPECT_NE(of(told(*viewer), "answer").at(0)["refused"], "") << bad;
    }
  }
  EXPECT_TRUE(requests_.told_to_drive());
  EXPECT_FALSE(requests_.take_place());
}

TEST_F(PageShowTest, AnswersToOneWhoDoesNotReadAreBounded) {
  const auto viewer = show_.viewer(true);
  int taken = 0;
  while (taken < 10000 && viewer->message(R"({"op":"command","name":"hold"})", true)) ++taken;
  EXPECT_LT(taken, 1000);
}

TEST_F(PageShowTest, StatusTellsWhatWasAskedAndWhatBecameOfThePlace) {
  const auto viewer = show_.viewer(false);
  told(*viewer);
  requests_.hold();
  requests_.tell({0, DetourState::kThere, "It is there."});
  show_.add({});
  const std::vector<json> status = of(told(*viewer), "status");
  ASSERT_EQ(status.size(), 1U);
  EXPECT_EQ(status[0]["told_to_drive"], false);
  EXPECT_EQ(status[0]["told"], "It is there.");
  EXPECT_TRUE(status[0]["drive"].is_null());
}

}  // namespace
}  // namespace prospect::page_show_test
