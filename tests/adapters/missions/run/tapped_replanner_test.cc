#include "adapters/missions/run/tapped_replanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace prospect::tapped_replanner_test {
namespace {

/// Notes what it is asked, and answers by what it was asked.
class Noted final : public Replanner {
 public:
  explicit Noted(std::vector<std::string>& calls) : calls_(calls) {}

  void prepare(const Belief& belief) override { note("prepare", belief.stamp); }
  Plan plan(const Belief& belief) override {
    note("plan", belief.stamp);
    Plan plan;
    plan.committed = static_cast<int>(belief.stamp);
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return global_plan_; }
  std::string set_task(const Task& task) override {
    note("task", task.goal.position.x());
    return "not taken";
  }

  const std::shared_ptr<const GlobalPlan> global_plan_ = std::make_shared<const GlobalPlan>();

 private:
  void note(const char* what, double value) {
    calls_.push_back(std::string(what) + ' ' + std::to_string(static_cast<int>(value)));
  }

  std::vector<std::string>& calls_;
};

Belief at(double stamp) {
  Belief belief;
  belief.stamp = stamp;
  return belief;
}

// Whoever listens hears of a call before it is made, and of its plan after.
TEST(TappedReplanner, EachCallIsToldAndMade) {
  std::vector<std::string> calls;
  Noted planner(calls);
  const auto heard = [&](const char* what, double value) {
    calls.push_back(std::string("heard ") + what + ' ' + std::to_string(static_cast<int>(value)));
  };
  const PlannerTap tap{[&](const Belief& b) { heard("prepare", b.stamp); },
                       [&](const Belief& b) { heard("plan", b.stamp); },
                       [&](const Plan& p) { heard("planned", p.committed); },
                       [&](const Task& t) { heard("task", t.goal.position.x()); }};
  TappedReplanner tapped(planner, tap);
  tapped.prepare(at(1.0));
  EXPECT_EQ(tapped.plan(at(2.0)).committed, 2);
  EXPECT_EQ(tapped.set_task(Task::go_to({3.0, 0.0})), "not taken");
  EXPECT_EQ(tapped.global_plan(), planner.global_plan_);
  EXPECT_THAT(calls, testing::ElementsAre("heard prepare 1", "prepare 1", "heard plan 2", "plan 2",
                                          "heard planned 2", "heard task 3", "task 3"));
}

TEST(TappedReplanner, NobodyHasToListen) {
  std::vector<std::string> calls;
  Noted planner(calls);
  const PlannerTap tap;
  TappedReplanner tapped(planner, tap);
  tapped.prepare(at(1.0));
  EXPECT_EQ(tapped.plan(at(2.0)).committed, 2);
  EXPECT_EQ(tapped.set_task(Task::go_to({3.0, 0.0})), "not taken");
  EXPECT_THAT(calls, testing::ElementsAre("prepare 1", "plan 2", "task 3"));
}

}  // namespace
}  // namespace prospect::tapped_replanner_test
