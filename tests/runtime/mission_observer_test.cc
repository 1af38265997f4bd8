// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission_observer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "runtime/mission_progress.h"

namespace prospect::mission_observer_test {
namespace {

using Calls = std::vector<std::string>;

std::string text(const char* what, double value) {
  return std::string(what) + ' ' + std::to_string(static_cast<int>(value));
}

/// Notes what it is asked, and answers by what it was asked; cut short from 10 s on.
class Noted final : public Replanner {
 public:
  explicit Noted(Calls& calls) : calls_(calls) {}
  void prepare(const Belief& belief) override { calls_.push_back(text("prepare", belief.stamp)); }
  Plan plan(const Belief& belief) override {
    calls_.push_back(text("plan", belief.stamp));
    Plan plan;
    plan.committed = static_cast<int>(belief.stamp);
    if (belief.stamp >= 10.0) plan.stop = StopReason::kCancelled;
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return nullptr; }
  std::shared_ptr<const PlanningStep> step() const override { return made; }
  std::string set_task(const Task& task) override {
    calls_.push_back(text("task", task.goal.position.x()));
    return "not taken";
  }
  const std::shared_ptr<const PlanningStep> made = std::make_shared<const PlanningStep>();

 private:
  Calls& calls_;
};

class Listener final : public MissionObserver {
 public:
  explicit Listener(Calls& calls) : calls_(calls) {}
  void on_prepare(const Belief& b) override { calls_.push_back(text("heard prepare", b.stamp)); }
  void on_plan(const Belief& b) override { calls_.push_back(text("heard plan", b.stamp)); }
  void on_planned(const Plan& p) override { calls_.push_back(text("heard planned", p.committed)); }
  void on_task(const Task& t) override {
    calls_.push_back(text("heard task", t.goal.position.x()));
  }
  void on_step(const MissionStep& step) override {
    calls_.push_back(text("heard step", step.plan->committed));
    made = step.made;
    truth = step.truth;
  }
  std::shared_ptr<const PlanningStep> made;
  std::optional<TrueState> truth;

 private:
  Calls& calls_;
};

struct Known final : Truth {
  TrueState at(const Belief& belief) override {
    state.path_length = belief.stamp;
    return state;
  }
  TrueState newest() const override { return state; }
  TrueState state;
};

Belief at(double stamp) {
  Belief belief;
  belief.stamp = stamp;
  return belief;
}

// Whoever watches hears of a call before it is made, and of its plan after.
TEST(MissionObserver, EachCallIsToldAndMade) {
  Calls calls;
  Noted planner(calls);
  Listener first(calls), second(calls);
  Known truth;
  MissionOptions options;
  options.observers = {&first};
  options.truth = &truth;
  MissionProgress progress(options, planner, 0.0);
  progress.prepare(at(1.0));
  const auto plan = progress.plan(at(1.5), at(2.0), 1.5);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->stamp, 2.0);
  EXPECT_FALSE(progress.over_after(at(1.5), *plan, {}));
  DriveRequests requests;
  requests.go_to({3.0, 0.0});
  progress.take_detour(requests);
  EXPECT_EQ(requests.told(), "not taken");
  EXPECT_THAT(calls,
              testing::ElementsAre("heard prepare 1", "prepare 1", "heard plan 2", "plan 2",
                                   "heard planned 2", "heard step 2", "heard task 3", "task 3"));
  EXPECT_EQ(first.made, planner.made);
  ASSERT_TRUE(first.truth);
  EXPECT_EQ(first.truth->path_length, 1.5);
}

TEST(MissionObserver, AllAreToldAndNobodyHasToListen) {
  for (const int listeners : {0, 2}) {
    Calls calls;
    Noted planner(calls);
    Listener first(calls), second(calls);
    MissionOptions options;
    if (listeners > 0) options.observers = {&first, &second};
    MissionProgress progress(options, planner, 0.0);
    EXPECT_TRUE(progress.plan(at(1.0), at(2.0), 1.0));
    EXPECT_EQ(calls.size(), 1U + 2U * static_cast<std::size_t>(listeners));
  }
}

TEST(MissionObserver, APlanThatWasCancelledIsNotTold) {
  Calls calls;
  Noted planner(calls);
  Listener listener(calls);
  MissionOptions options;
  options.observers = {&listener};
  MissionProgress progress(options, planner, 0.0);
  EXPECT_FALSE(progress.plan(at(10.0), at(10.0), 10.0));
  EXPECT_EQ(progress.result.end, MissionEnd::kCancelled);
  EXPECT_THAT(calls, testing::ElementsAre("heard plan 10", "plan 10"));
}

}  // namespace
}  // namespace prospect::mission_observer_test
