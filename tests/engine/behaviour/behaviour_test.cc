// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/behaviour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "engine/behaviour/mode_policy.h"

namespace prospect::behaviour_test {
namespace {

using enum ModeKind;
using enum Localization;

const BehaviourOptions kOptions;

Facts facts(double stamp, Localization localization = kOk, bool enough = true,
            double lost_for = 0.0) {
  Facts f;
  f.stamp = stamp;
  f.localization = localization;
  f.enough_features = localization == kOk && enough;
  f.tracked = f.enough_features ? 100 : 5;
  f.lost_for = lost_for;
  f.frontiers =
      FrontierFacts{.target = true, .target_length = 1.4, .target_area = 2.5, .path_left = 3.2};
  return f;
}

Facts with(Facts f, const FrontierFacts& frontiers) {
  f.frontiers = frontiers;
  return f;
}

Facts not_following(Facts f, double at) {
  f.not_following_at = at;
  return f;
}

Behaviour in(ModeKind kind, double since = 0.0) {
  Behaviour b;
  b.mode = {kind, Cause::kStart, since};
  return b;
}

Behaviour after_retreat(double ended, bool failed, bool enough_since = true) {
  Behaviour b;
  b.retreat_ended = ended;
  b.retreat_failed = failed;
  b.enough_since_retreat = enough_since;
  return b;
}

Facts told(TaskKind task, Facts f, const GoalFacts& goal = {}) {
  f.task = task;
  f.frontiers.reset();
  if (has_goal(task)) f.goal = goal;
  return f;
}

Facts given_at(double stamp, Facts f) {
  f.task_given_at = stamp;
  return f;
}

/// The rows in their order, each with a case that it decides.
struct RowCase {
  Behaviour before;
  Facts facts;
  ModeKind to;
  Cause cause;
};

std::vector<RowCase> row_cases() {
  const FrontierFacts gone{.exhausted = true, .exhausted_for = 8.0};
  FrontierFacts cut = gone, low = gone, looking = gone, stalled{.target = true, .stalled = true};
  cut.cut_off = true;
  FrontierFacts unseen = gone;
  unseen.area_unseen = true;
  Facts refused = with(facts(9), gone);
  refused.refused = "the body would enter unknown space after 0.50 s";
  low.low_yield = {3, 0.9};
  looking.exhausted_for = 7.5;
  const GoalFacts there{.reached = true, .near = true, .distance = 0.1};
  const GoalFacts near{.near = true, .distance = 0.4, .path_left = 0.4};
  const GoalFacts slow{.path_left = 3.0, .stalled_for = 4.0, .stalled = true};
  GoalFacts none{.unreachable = true, .unreachable_for = 8.0, .why = "it is in a wall"};
  GoalFacts seeking = none;
  seeking.unreachable_for = 7.5;
  return {
      {in(kExplore), told(TaskKind::kHold, facts(9, kLost)), kHold, Cause::kTaskGiven},
      {in(kArrive), told(TaskKind::kGoTo, facts(9), there), kDone, Cause::kGoalReached},
      {in(kArrive), told(TaskKind::kReturn, facts(9), there), kDone, Cause::kReturned},
      {in(kExplore), told(TaskKind::kGoTo, facts(9), none), kDone, Cause::kGoalUnreachable},
      {in(kExplore), with(facts(9), unseen), kDone, Cause::kUnreachable},
      {in(kExplore), refused, kDone, Cause::kUnreachable},
      {in(kExplore), with(facts(9), cut), kDone, Cause::kUnreachable},
      {in(kExplore), with(facts(9), low), kDone, Cause::kYieldTooLow},
      {in(kExplore), with(facts(9), gone), kDone, Cause::kExplored},
      {in(kRetreat), facts(6.0, kLost), kRetreat, Cause::kStart},
      {in(kExplore), facts(9, kLost), kRetreat, Cause::kLocalizationLost},
      {in(kExplore), facts(9, kDegraded), kRetreat, Cause::kFeaturesScarce},
      {after_retreat(9, true, false), facts(15.5, kLost), kTurnOnTheSpot, Cause::kStillLost},
      {in(kExplore), not_following(facts(9), 6.5), kTurnOnTheSpot, Cause::kNotFollowing},
      {in(kExplore), with(facts(9), looking), kLookAround, Cause::kNothingReachable},
      {in(kExplore), with(facts(9), stalled), kApproach, Cause::kNoProgress},
      {in(kGoToGoal), told(TaskKind::kGoTo, facts(9), seeking), kLookAround,
       Cause::kNothingReachable},
      {in(kGoToGoal), told(TaskKind::kGoTo, facts(9), near), kArrive, Cause::kGoalNear},
      {in(kGoToGoal), told(TaskKind::kGoTo, facts(9), slow), kApproach, Cause::kNoProgress},
      {in(kRetreat), told(TaskKind::kGoTo, facts(9)), kGoToGoal, Cause::kTaskGiven},
      {in(kExplore), told(TaskKind::kReturn, facts(9)), kReturn, Cause::kTaskGiven},
      {in(kRetreat), facts(1.0), kExplore, Cause::kLocalizationRegained},
      {in(kRetreat), facts(6.5, kDegraded), kExplore, Cause::kRetreatTimedOut},
      {in(kTurnOnTheSpot), facts(9), kExplore, Cause::kTurned},
      {in(kApproach), facts(9), kExplore, Cause::kProgress},
      {in(kLookAround), facts(9), kExplore, Cause::kReachableAgain},
      {in(kDone), given_at(9, facts(9)), kExplore, Cause::kTaskGiven},
      {in(kDone), facts(9), kExplore, Cause::kReachableAgain},
      {in(kGoToGoal), facts(9), kExplore, Cause::kTaskGiven},
      {in(kReturn), facts(9), kExplore, Cause::kTaskGiven},
      {in(kArrive), facts(9), kExplore, Cause::kTaskGiven},
      {in(kHold), facts(9), kExplore, Cause::kTaskGiven},
      {in(kExplore), facts(9), kExplore, Cause::kStart},
  };
}

// A robot that never got out of the nook it began in has explored nothing.
TEST(Behaviour, MuchThatIsLeftIsNotExplored) {
  struct Case {
    double seen;
    FrontiersLeft low_yield, unreachable, failed;
    Cause cause;
    FrontiersLeft given_up{}, barred{};
  };
  for (const Case& c : {Case{7.4, {}, {4, 5.6}, {2, 1.5}, Cause::kUnreachable},
                        Case{7.4, {1, 0.3}, {4, 5.6}, {}, Cause::kUnreachable},
                        Case{7.4, {}, {}, {4, 5.6}, Cause::kYieldTooLow},
                        Case{97.0, {}, {17, 19.0}, {}, Cause::kExplored},
                        Case{97.0, {3, 0.7}, {12, 19.1}, {}, Cause::kYieldTooLow},
                        Case{163.0, {}, {}, {1, 0.3}, Cause::kExplored},
                        // Given up on the path is no evidence; barred by a zone is as told.
                        Case{7.4, {}, {}, {}, Cause::kUnreachable, {4, 5.6}},
                        Case{7.4, {}, {2, 1.0}, {}, Cause::kUnreachable, {1, 1.0}},
                        Case{7.4, {}, {}, {}, Cause::kExplored, {}, {4, 5.6}}}) {
    const FrontierFacts f{.exhausted = true,
                          .exhausted_for = 8.0,
                          .explored_area = c.seen,
                          .low_yield = c.low_yield,
                          .unreachable = c.unreachable,
                          .failed = c.failed,
                          .given_up = c.given_up,
                          .barred = c.barred};
    const Mode mode = decide(in(kExplore), with(facts(90.0), f), {}).mode;
    EXPECT_EQ(mode.kind, kDone);
    EXPECT_EQ(mode.cause, c.cause)
        << c.seen << " m2 seen, " << c.unreachable.area << " out of reach";
  }
}

// Done needs evidence: a robot that never moved has it only where nothing held it fast.
TEST(Behaviour, WhatARobotThatNeverMovedMayClaim) {
  struct Case {
    double strayed;
    const char* refused;
    bool hemmed_in;
    Cause cause;
  };
  for (const Case& c : {Case{0.0, "", false, Cause::kExplored},
                        Case{0.0, "it would hit something", false, Cause::kUnreachable},
                        Case{0.0, "", true, Cause::kUnreachable},
                        Case{3.0, "it would hit something", false, Cause::kExplored},
                        Case{3.0, "", true, Cause::kExplored}}) {
    Facts f =
        with(facts(90.0), {.exhausted = true, .exhausted_for = 8.0, .hemmed_in = c.hemmed_in});
    f.strayed = c.strayed;
    f.refused = c.refused;
    const Mode mode = decide(in(kExplore), f, {}).mode;
    EXPECT_EQ(mode.kind, kDone);
    EXPECT_EQ(mode.cause, c.cause) << c.strayed << c.refused << c.hemmed_in;
    if (c.cause == Cause::kUnreachable) {
      EXPECT_NE(describe(mode, f).find(c.hemmed_in ? "passable" : c.refused), std::string::npos)
          << describe(mode, f);
    }
  }
}

TEST(Behaviour, EveryRowOfTheTableDecides) {
  const std::vector<RowCase> cases = row_cases();
  ASSERT_EQ(cases.size(), mode_table().size()) << "a case for each row, in order";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const RowCase& c = cases[i];
    SCOPED_TRACE(std::to_string(i) + ": " + std::string(mode_table()[i].condition));
    EXPECT_EQ(&deciding_row(c.before, c.facts, kOptions), &mode_table()[i]);
    const Behaviour now = decide(c.before, c.facts, kOptions);
    EXPECT_EQ(now.mode.kind, c.to);
    EXPECT_EQ(now.mode.cause, c.cause);
    const bool changed = c.to != c.before.mode.kind || c.cause != c.before.mode.cause;
    EXPECT_EQ(now.mode.since, changed ? c.facts.stamp : c.before.mode.since);
  }
}

TEST(Behaviour, EveryModeHasARowThatLeavesIt) {
  for (const ModeKind kind : kModeKinds) {
    const Behaviour now = decide(in(kind), facts(9), kOptions);
    EXPECT_EQ(now.mode.kind, kExplore) << to_string(kind);
    EXPECT_EQ(policy(kind).mode, kind);
  }
}

// Which rows come first where several hold.
TEST(Behaviour, Precedence) {
  const FrontierFacts gone{.exhausted = true, .exhausted_for = 8.0};
  FrontierFacts looking = gone, stalled{.target = true, .stalled = true};
  looking.exhausted_for = 0.0;
  EXPECT_EQ(decide(in(kRetreat), with(facts(1, kLost), gone), kOptions).mode.kind, kDone);
  EXPECT_EQ(decide(in(kExplore), with(facts(1, kLost), looking), kOptions).mode.kind, kRetreat);
  EXPECT_EQ(decide(after_retreat(0.5, false), with(facts(1, kLost, false, 1.0), looking), kOptions)
                .mode.kind,
            kLookAround);
  EXPECT_EQ(decide(in(kExplore), with(not_following(facts(1), 1), stalled), kOptions).mode.kind,
            kTurnOnTheSpot);
  EXPECT_EQ(decide(in(kExplore), not_following(facts(1, kLost), 1), kOptions).mode.kind, kRetreat);
}

// A robot that is lost neither knows that it is there nor goes on: it finds its path back first.
TEST(Behaviour, LostOnTheWayToAGoal) {
  const GoalFacts there{.reached = true, .near = true};
  EXPECT_EQ(
      decide(in(kGoToGoal), told(TaskKind::kGoTo, facts(9, kLost), there), kOptions).mode.kind,
      kRetreat);
  const Behaviour paused = after_retreat(8.5, false);
  EXPECT_EQ(decide(paused, told(TaskKind::kReturn, facts(9, kLost, false, 0.5), there), kOptions)
                .mode.kind,
            kReturn);
}

// What was known of frontiers does not end another task, nor the goal of one the exploration.
TEST(Behaviour, OnlyTheTaskCounts) {
  Facts f = facts(9);
  f.goal = GoalFacts{.reached = true};
  EXPECT_EQ(decide(in(kExplore), f, kOptions).mode.kind, kExplore);
}

// Its map does not follow where the drift takes it, so it takes no path step by step.
TEST(Behaviour, ALostRobotDoesNotApproach) {
  const FrontierFacts stalled{.target = true, .stalled = true};
  const Behaviour paused = after_retreat(0.5, false);
  EXPECT_EQ(decide(paused, with(facts(1, kLost, false, 0.5), stalled), kOptions).mode.kind,
            kExplore);
  EXPECT_EQ(decide(paused, with(facts(1, kDegraded), stalled), kOptions).mode.kind, kApproach);
}

TEST(Behaviour, WithoutTheFrontiersItIsTheSameWhatTheyAreNotAskedAbout) {
  for (const RowCase& c : row_cases()) {
    const ModeKind all = decide(c.before, c.facts, kOptions).mode.kind;
    if (all == kDone) continue;
    Facts without = c.facts;
    without.frontiers.reset();
    without.goal.reset();
    const ModeKind some = decide(c.before, without, kOptions).mode.kind;
    EXPECT_EQ(policy(all).pursues, policy(some).pursues) << to_string(all);
  }
}

/// A robot that is asked every half second.
class Told {
 public:
  Mode operator()(Localization localization, bool enough = true) {
    stamp_ += 0.5;
    lost_for_ = localization == kLost ? lost_for_ + 0.5 : 0.0;
    behaviour_ = decide(behaviour_, facts(stamp_, localization, enough, lost_for_), kOptions);
    return behaviour_.mode;
  }
  double stamp() const { return stamp_; }

 private:
  double stamp_ = 0.0, lost_for_ = 0.0;
  Behaviour behaviour_;
};

// Turning back at once, each time, kept robots for six minutes before a blank stretch without a
// path round; exploring on for the whole pause, they were metres off behind it.
TEST(Behaviour, ALossSoonAfterARetreatIsAnsweredOnceItLasts) {
  Told told;
  EXPECT_EQ(told(kLost).kind, kRetreat);
  for (int loss = 0; loss < 3; ++loss) {
    EXPECT_EQ(told(kOk).kind, kExplore) << loss;
    double lost_for = 0.0;
    while (told(kLost).kind != kRetreat) {
      lost_for += 0.5;
      ASSERT_LE(lost_for, kOptions.lost_patience) << loss;
    }
    EXPECT_EQ(lost_for, kOptions.lost_patience) << loss;
  }
  // The pause over, a loss is answered at once.
  while (told.stamp() < 3.0 * kOptions.retreat_pause) told(kOk);
  EXPECT_EQ(told(kLost).kind, kRetreat);
}

TEST(Behaviour, ARetreatThatDoesNotHelpEndsWithATurnAndPauses) {
  Told told;
  double retreated = 0.0, turned = 0.0, explored = 0.0;
  while (told.stamp() < 26.0) {
    const Mode mode = told(kLost);
    retreated += mode.kind == kRetreat ? 0.5 : 0.0;
    turned += mode.kind == kTurnOnTheSpot ? 0.5 : 0.0;
    explored += mode.kind == kExplore ? 0.5 : 0.0;
    EXPECT_EQ(mode.kind == kTurnOnTheSpot, mode.cause == Cause::kStillLost);
  }
  EXPECT_EQ(retreated, kOptions.retreat_time + 0.5);
  EXPECT_EQ(turned, kOptions.turn_time);
  EXPECT_EQ(explored, 26.0 - retreated - turned) << "it explores all the same";
  while (told(kLost).kind != kRetreat) ASSERT_LT(told.stamp(), 28.0);
}

// Turning back was of no use, but since then the robot knew where it was: a new loss is a new case.
TEST(Behaviour, PatienceWithALossBeginsWhenLocalizationCameBackByItself) {
  Told told;
  while (told.stamp() < 6.5) EXPECT_EQ(told(kDegraded).kind, kRetreat);
  while (told.stamp() < 12.0) EXPECT_EQ(told(kDegraded).kind, kExplore) << "it pauses";
  EXPECT_EQ(told(kOk).kind, kExplore);
  while (told.stamp() < 14.0) EXPECT_EQ(told(kDegraded).kind, kExplore) << "it still pauses";
  for (int n = 0; n < 6; ++n) EXPECT_EQ(told(kLost).kind, kExplore) << "it is patient";
  EXPECT_EQ(told(kLost).kind, kRetreat);
}

// Localization is back, but on so few features that it would be lost at the next corner.
TEST(Behaviour, ARetreatGoesOnUntilEnoughFeaturesAreTracked) {
  Told told;
  EXPECT_EQ(told(kLost).kind, kRetreat);
  EXPECT_EQ(told(kOk, false).kind, kRetreat);
  EXPECT_EQ(told(kOk, false).kind, kRetreat);
  const Mode mode = told(kOk, true);
  EXPECT_EQ(mode.kind, kExplore);
  EXPECT_EQ(mode.cause, Cause::kLocalizationRegained);
  EXPECT_EQ(mode.since, 2.0);
}

TEST(Behaviour, NoPauseMeansOneStepBetweenTwoRetreats) {
  BehaviourOptions options;
  options.retreat_pause = 0.0;
  options.turn_time = 0.0;
  Behaviour b = in(kRetreat, 0.0);
  b = decide(b, facts(6.5, kLost), options);
  EXPECT_EQ(b.mode.kind, kExplore);
  b = decide(b, facts(7.0, kLost), options);
  EXPECT_EQ(b.mode.kind, kRetreat);
}

TEST(Behaviour, APauseIsOverOnTime) {
  const double end = 10.0 + kOptions.retreat_pause;
  for (const double stamp : {end - 0.5, end, end + 0.5}) {
    EXPECT_EQ(decide(after_retreat(10.0, false), facts(stamp, kDegraded), kOptions).mode.kind,
              stamp < end ? kExplore : kRetreat)
        << stamp;
  }
}

TEST(Behaviour, TheSentenceSaysWhatTheFactsHaveAndNoMore) {
  const Facts plain = facts(12.0);
  const auto changed = [&](auto change) {
    Facts f = plain;
    change(f);
    return f;
  };
  const auto to_goal = [&](TaskKind task, const GoalFacts& goal) {
    return told(task, plain, goal);
  };
  const GoalFacts shut{.unreachable = true, .unreachable_for = 2.0, .why = "a wall is round it"};
  const struct {
    Mode mode;
    Facts facts;
    const char* sentence;
  } rows[] = {
      {{kExplore, Cause::kStart, 0.0},
       with(plain, {}),
       "Explores: no frontier can be reached from here just now."},
      {{kApproach, Cause::kNoProgress, 8.0},
       plain,
       "Approaches step by step for 4.0 s now, for want of progress: drives 3.2 m to look at a "
       "frontier 1.4 m long, which promises 2.5 m2."},
      {{kApproach, Cause::kNoProgress, 8.0},
       to_goal(TaskKind::kGoTo, {.path_left = 3.0}),
       "Approaches step by step for 4.0 s now, for want of progress: 3.0 m to the goal."},
      {{kGoToGoal, Cause::kTaskGiven, 0.0},
       to_goal(TaskKind::kGoTo, {.path_left = 3.0}),
       "Goes where it is told: 3.0 m to the goal."},
      {{kReturn, Cause::kTaskGiven, 0.0},
       to_goal(TaskKind::kReturn, {.path_left = 3.0, .unknown_left = 1.1}),
       "Returns: 3.0 m to where it began, 1.1 m of them through unknown space."},
      {{kLookAround, Cause::kNothingReachable, 0.0},
       to_goal(TaskKind::kGoTo, shut),
       "Looks around: for 2.0 s no way has led to the goal: a wall is round it."},
      {{kLookAround, Cause::kNothingReachable, 0.0},
       with(plain, {.exhausted = true, .exhausted_for = 3.0}),
       "Looks around: for 3.0 s no frontier that can be reached was worth its way."},
      {{kRetreat, Cause::kFeaturesScarce, 0.0},
       facts(12.0, kDegraded),
       "Turns back: 5 features in view, localization is degraded."},
      {{kDone, Cause::kGoalReached, 0.0},
       to_goal(TaskKind::kGoTo, {.reached = true, .distance = 0.12}),
       "Done: 0.12 m from the goal."},
      {{kDone, Cause::kGoalReached, 0.0},
       to_goal(
           TaskKind::kGoTo,
           {.distance = 0.12, .heading_missed = M_PI / 6.0, .heading_why = "it cannot turn there"}),
       "Done: 0.12 m from the goal, 30 degrees off the heading there: it cannot turn there."},
      {{kDone, Cause::kGoalUnreachable, 0.0},
       changed([&](Facts& f) { f = to_goal(TaskKind::kGoTo, shut), f.refused = "a wall"; }),
       "Done: the goal cannot be reached: a wall is round it. It has not moved: a wall."},
      {{kDone, Cause::kGoalUnreachable, 0.0},
       changed([&](Facts& f) {
         f = to_goal(TaskKind::kGoTo, shut), f.refused = "a wall", f.strayed = 2.0;
       }),
       "Done: the goal cannot be reached: a wall is round it."},
      {{kDone, Cause::kExplored, 0.0},
       changed([](Facts& f) { f.refused = "a wall"; }),
       "Done: no frontier is left that can be reached and promises anything."},
      {{kDone, Cause::kExplored, 0.0},
       with(plain, {.area_why = "it is walled in"}),
       "Done: no frontier is left that can be reached and promises anything; the rest of the area "
       "is not reached: it is walled in."},
      {{kDone, Cause::kUnreachable, 0.0},
       with(plain, {.area_unseen = true, .area_why = "it is walled in"}),
       "Ended: nothing of the area that is to be explored can be reached: it is walled in."},
      {{kDone, Cause::kUnreachable, 0.0},
       changed([](Facts& f) { f.strayed = 2.0, f.frontiers->cut_off = true; }),
       "Ended: walls as drawn cut it off from most places it came through."},
  };
  for (const auto& row : rows) EXPECT_EQ(describe(row.mode, row.facts), row.sentence);
}

TEST(Behaviour, TheSentenceHasTheNumbersOfTheFacts) {
  Facts f = facts(10, kDegraded);
  f.tracked = 8;
  f.tracked_at_retreat = 41;
  f.retreat_distance = 1.24;
  EXPECT_EQ(describe({kRetreat, Cause::kFeaturesScarce, 7.0}, f),
            "Turns back: 8 features in view, localization is degraded; 41 were tracked 1.2 m from "
            "here.");
  EXPECT_EQ(describe({kExplore, Cause::kStart, 0.0}, facts(3)),
            "Explores: drives 3.2 m to look at a frontier 1.4 m long, which promises 2.5 m2.");
  f = facts(12.0);
  f.stuck = true;
  const std::string text = describe({kExplore, Cause::kLocalizationRegained, 8.0}, f);
  EXPECT_NE(text.find("regained 4 s ago"), std::string::npos) << text;
  EXPECT_NE(text.find("stuck"), std::string::npos) << text;
  EXPECT_EQ(describe({kExplore, Cause::kLocalizationRegained, 8.0}, facts(12.0, kLost, false, 1.5)),
            "Explores: drives 3.2 m to look at a frontier 1.4 m long, which promises 2.5 m2; "
            "localization is lost for 1.5 "
            "s, and it goes on for a while before it turns back.");
  f = facts(90.0);
  f.frontiers = FrontierFacts{
      .exhausted = true, .low_yield = {3, 0.94}, .unreachable = {1, 2.1}, .failed = {2, 1.0}};
  EXPECT_EQ(describe({kDone, Cause::kYieldTooLow, 90.0}, f),
            "Done: what is left shows too little for the way; left: 3 (0.9 m2) too little for the "
            "way, 2 (1.0 m2) where looks showed nothing, 1 (2.1 m2) out of reach.");
  f = facts(12.0);
  f.frontiers->narrow = f.stuck = true;
  EXPECT_NE(describe({kExplore, Cause::kStart, 0.0}, f).find("2.5 m2. The way ahead is narrow."),
            std::string::npos);
  EXPECT_EQ(describe({kDone, Cause::kUnreachable, 90.0}, f),
            "Ended: no way is found to most of what is left.");
  // One for each mode and cause, all different, none with a number that is not one.
  std::set<std::string> seen;
  for (const RowCase& c : row_cases()) {
    const Mode mode{c.to, c.cause, 0.0};
    const std::string sentence = describe(mode, c.facts);
    EXPECT_EQ(sentence.find("nan"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find("inf"), std::string::npos) << sentence;
    EXPECT_GT(sentence.size(), 10u);
    if (c.to == kExplore || c.to == kRetreat) continue;
    EXPECT_EQ(sentence.find(".."), std::string::npos) << sentence;
    EXPECT_TRUE(seen.insert(sentence).second) << sentence;
  }
}

TEST(Behaviour, TheTablesArePrintedRowByRow) {
  const std::string text = behaviour_tables();
  for (const ModeRow& row : mode_table()) {
    EXPECT_NE(text.find(row.condition), std::string::npos) << row.condition;
  }
}

TEST(Behaviour, TheReferencePageIsThatText) {
  std::ifstream file(std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/behaviour.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find("<!-- prospect list modes -->\n" + behaviour_tables() + "<!-- end -->"),
            std::string::npos)
      << "docs/reference/behaviour.md: put the output of `prospect list modes` between the marks";
}

}  // namespace
}  // namespace prospect::behaviour_test
