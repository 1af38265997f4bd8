// SPDX-License-Identifier: Apache-2.0
#include "runtime/drive_mode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace prospect::drive_mode_test {
namespace {

using enum DriveMode;

const DriveModeOptions kOptions;

/// All is well, and the robot is told to drive and stands.
DriveFacts well(double stamp = 10.0) {
  DriveFacts f;
  f.stamp = stamp;
  f.told_to_drive = true;
  f.live_for = 5.0;
  f.failed_preflight.clear();
  f.silent_emergency_stop.clear();
  f.yaw_checked = true;
  f.rest_for = 5.0;
  f.base_silent = false;
  f.plan_from_rest = stamp - 0.2;
  f.plan_left = 1.0;
  f.localization = Localization::kOk;
  f.localized_for = 5.0;
  return f;
}

/// The same, in motion.
DriveFacts moving(double stamp = 10.0) {
  DriveFacts f = well(stamp);
  f.rest_for = 0.0;
  return f;
}

template <typename Value>
DriveFacts with(DriveFacts facts, Value DriveFacts::*fact, const Value& value) {
  facts.*fact = value;
  return facts;
}
DriveFacts with(DriveFacts facts, std::string DriveFacts::*fact, const char* name = "it") {
  facts.*fact = name;
  return facts;
}

DriveState in(DriveMode mode, DriveCause cause = DriveCause::kStart, double since = 8.0) {
  return {mode, cause, since};
}

/// The rows in their order, each with a case that it decides.
struct RowCase {
  DriveState before;
  DriveFacts facts;
  DriveMode to;
  DriveCause cause;
};

std::vector<RowCase> row_cases() {
  using F = DriveFacts;
  using C = DriveCause;
  const DriveFacts button = with(moving(), &F::emergency_stop, true);
  return {
      {in(kStopped, C::kBaseFault), with(well(), &F::acknowledged, true), kIdle, C::kAcknowledged},
      {in(kStopped, C::kBaseFault), well(), kStopped, C::kBaseFault},
      {in(kActive), button, kStopping, C::kEmergencyStop},
      {in(kActive), with(moving(), &F::silent_emergency_stop), kStopping, C::kEmergencyStopSilent},
      {in(kActive), with(moving(), &F::base_fault), kStopping, C::kBaseFault},
      {in(kActive), with(moving(), &F::base_silent, true), kStopping, C::kBaseSilent},
      {in(kDegraded), with(moving(), &F::ended_thread), kStopping, C::kThreadEnded},
      {in(kReady), with(moving(), &F::uncommanded_motion, true), kStopping, C::kUncommandedMotion},
      {in(kReady), with(moving(), &F::not_following), kStopping, C::kDoesNotFollow},
      {in(kStopping, C::kEmergencyStop), well(), kStopped, C::kEmergencyStop},
      {in(kStopping, C::kEmergencyStop), with(moving(), &F::obstacle), kStopping,
       C::kEmergencyStop},
      {in(kStopping, C::kSourceStale), with(well(), &F::stale_source), kIdle, C::kSourceStale},
      {in(kStopping, C::kSourceStale, 5.9), moving(), kStopping, C::kDoesNotStop},
      {in(kStopping, C::kSourceStale), with(moving(), &F::obstacle), kStopping, C::kObstacle},
      {in(kActive), with(moving(), &F::late_thread), kStopping, C::kThreadLate},
      {in(kActive), with(moving(), &F::failed_preflight), kStopping, C::kPreflight},
      {in(kActive), with(moving(), &F::jumped_clock), kStopping, C::kClockJumped},
      {in(kActive), with(moving(), &F::jumped_pose), kStopping, C::kPoseJumped},
      {in(kDegraded), with(moving(), &F::stale_source), kStopping, C::kSourceStale},
      {in(kActive), with(moving(), &F::plan_left, 0.0), kStopping, C::kPlanOver},
      {in(kActive), with(moving(), &F::told_to_drive, false), kStopping, C::kToldToStand},
      {in(kActive), with(moving(), &F::task_over, true), kStopping, C::kTaskOver},
      {in(kStopping, C::kTaskOver, 6.0), moving(), kStopping, C::kTaskOver},
      {in(kReady), with(well(), &F::silent_emergency_stop), kIdle, C::kEmergencyStopSilent},
      {in(kReady), with(well(), &F::base_fault), kIdle, C::kBaseFault},
      {in(kIdle), with(well(), &F::base_silent, true), kIdle, C::kBaseSilent},
      {in(kReady), with(well(), &F::ended_thread), kIdle, C::kThreadEnded},
      {in(kReady), with(well(), &F::late_thread), kIdle, C::kThreadLate},
      {in(kIdle), with(well(), &F::failed_preflight), kIdle, C::kPreflight},
      {in(kReady), with(well(), &F::live_for, 0.9), kIdle, C::kSourceStale},
      {in(kIdle), with(well(), &F::live_for, 1.0), kReady, C::kSourcesLive},
      {in(kReady), with(well(), &F::obstacle), kReady, C::kObstacle},
      {in(kReady), well(), kActive, C::kNewPlan},
      {in(kReady, C::kObstacle, 9.9), well(), kReady, C::kSourcesLive},
      {in(kActive),
       with(with(moving(), &F::localization, Localization::kLost), &F::yaw_checked, false),
       kDegraded, C::kLocalizationLost},
      {in(kActive), with(moving(), &F::yaw_checked, false), kDegraded, C::kYawUnchecked},
      {in(kActive), with(moving(), &F::localization, Localization::kDegraded), kDegraded,
       C::kLocalizationDegraded},
      {in(kDegraded, C::kLocalizationLost), with(moving(), &F::localized_for, 1.0), kActive,
       C::kLocalizationRegained},
      {in(kDegraded, C::kLocalizationLost), with(moving(), &F::localized_for, 0.9), kDegraded,
       C::kLocalizationLost},
      {in(kActive, C::kNewPlan), moving(), kActive, C::kNewPlan},
  };
}

TEST(DriveMode, EveryRowDecidesItsCase) {
  const std::vector<RowCase> cases = row_cases();
  const auto table = drive_mode_table();
  ASSERT_EQ(cases.size(), table.size());
  for (std::size_t n = 0; n < cases.size(); ++n) {
    const RowCase& c = cases[n];
    const DriveModeRow& row = deciding_row(c.before, c.facts, kOptions);
    EXPECT_EQ(&row - table.data(), static_cast<std::ptrdiff_t>(n)) << table[n].condition;
    const DriveState state = decide(c.before, c.facts, kOptions);
    EXPECT_EQ(state.mode, c.to) << table[n].condition;
    EXPECT_EQ(to_string(state.cause), to_string(c.cause)) << table[n].condition;
    EXPECT_EQ(state.since, c.to == c.before.mode ? c.before.since : 10.0) << table[n].condition;
  }
}

TEST(DriveMode, FactsThatNobodyHasSetKeepItIdle) {
  DriveFacts facts;
  DriveState state;
  for (int n = 0; n < 100; ++n) {
    facts.stamp = n;
    state = decide(state, facts, kOptions);
    EXPECT_EQ(state.mode, kIdle);
  }
  facts.told_to_drive = true;
  EXPECT_EQ(decide(state, facts, kOptions).mode, kIdle);
}

// Each fact alone keeps a robot that stands from driving.
TEST(DriveMode, EntryNeedsEverything) {
  using F = DriveFacts;
  const double nan = std::nan("");
  const DriveFacts f = well();
  for (const DriveFacts& facts : {with(f, &F::live_for, 0.99),
                                  with(f, &F::live_for, nan),
                                  with(f, &F::stale_source),
                                  with(f, &F::silent_emergency_stop),
                                  with(f, &F::not_following),
                                  with(f, &F::failed_preflight),
                                  with(f, &F::base_fault),
                                  with(f, &F::base_silent, true),
                                  with(f, &F::ended_thread),
                                  with(f, &F::late_thread),
                                  with(f, &F::obstacle),
                                  with(f, &F::told_to_drive, false),
                                  with(f, &F::task_over, true),
                                  with(f, &F::plan_left, 0.0),
                                  with(f, &F::plan_left, nan),
                                  with(f, &F::plan_from_rest, std::optional<double>()),
                                  with(f, &F::plan_from_rest, std::optional(8.0)),
                                  with(f, &F::plan_from_rest, std::optional(nan)),
                                  with(f, &F::emergency_stop, true),
                                  with(f, &F::uncommanded_motion, true)}) {
    EXPECT_NE(decide(in(kReady), facts, kOptions).mode, kActive);
  }
  EXPECT_EQ(decide(in(kReady), f, kOptions).mode, kActive);
}

// A stop that does not latch: the robot goes on by itself, with a plan that was made since.
TEST(DriveMode, ResumingNeedsLiveSourcesForATimeAndANewPlanFromRest) {
  DriveState state = decide(in(kActive), with(moving(10.0), &DriveFacts::stale_source), kOptions);
  EXPECT_EQ(state.mode, kStopping);
  EXPECT_EQ(drive_speed(state, kOptions).response, DriveResponse::kComfortStop);
  DriveFacts facts = moving(10.5);  // back again: it brakes to the end all the same
  facts.live_for = 0.2;
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kStopping);
  facts = well(11.0);
  facts.live_for = 0.7;
  facts.plan_from_rest = 10.9;
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kIdle);
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kIdle);
  facts.stamp = 11.3;
  facts.live_for = 1.0;
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kReady);
  facts.stamp = 11.4;
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kReady);  // the plan is one of before
  facts.plan_from_rest = 11.35;
  state = decide(state, facts, kOptions);
  EXPECT_EQ(state.mode, kActive);
  EXPECT_EQ(drive_speed(state, kOptions).share, 1.0);
}

TEST(DriveMode, AnEmergencyStopLatchesFromAnyModeUntilItIsAcknowledgedAtRest) {
  for (const DriveMode mode : kDriveModes) {
    DriveState state = in(mode, mode == kStopped ? DriveCause::kBaseFault : DriveCause::kStart);
    DriveFacts facts = with(moving(), &DriveFacts::emergency_stop, true);
    state = decide(state, facts, kOptions);
    EXPECT_EQ(state.mode, mode == kStopped ? kStopped : kStopping) << to_string(mode);
    const DriveResponse response = drive_speed(state, kOptions).response;
    EXPECT_EQ(response, DriveResponse::kEmergencyStop);
    // Taken back at once, and acknowledged in motion: it makes no difference.
    facts = with(moving(10.1), &DriveFacts::acknowledged, true);
    state = decide(state, facts, kOptions);
    EXPECT_TRUE(state.mode == kStopping || state.mode == kStopped);
    for (int n = 0; n < 100; ++n) state = decide(state, well(11.0 + n), kOptions);
    EXPECT_EQ(state.mode, kStopped) << to_string(mode);
    // Acknowledged while it is still pressed.
    facts = with(well(120.0), &DriveFacts::acknowledged, true);
    EXPECT_EQ(decide(state, with(facts, &DriveFacts::emergency_stop, true), kOptions).mode,
              kStopped);
    state = decide(state, facts, kOptions);
    EXPECT_EQ(state.mode, kIdle);
    EXPECT_EQ(state.cause, DriveCause::kAcknowledged);
  }
}

TEST(DriveMode, AStopIsOnlyEverMadeHarder) {
  using F = DriveFacts;
  DriveState state = in(kStopping, DriveCause::kTaskOver);
  state = decide(state, with(moving(), &F::stale_source), kOptions);
  EXPECT_EQ(state.cause, DriveCause::kTaskOver);
  state = decide(state, with(moving(), &F::obstacle), kOptions);
  EXPECT_EQ(state.cause, DriveCause::kObstacle);
  state = decide(state, moving(), kOptions);
  EXPECT_EQ(state.cause, DriveCause::kObstacle);
  state = decide(state, with(moving(), &F::base_fault), kOptions);
  EXPECT_EQ(state.cause, DriveCause::kBaseFault);
  state = decide(state, with(moving(), &F::obstacle), kOptions);
  EXPECT_EQ(state.cause, DriveCause::kBaseFault);
}

// Whatever the facts say, in whatever order: what must hold of every pair of states.
TEST(DriveMode, WhatHoldsForAnyFacts) {
  std::mt19937 random(11);
  const auto one_in = [&](unsigned n) { return random() % n == 0; };
  DriveState state;
  std::set<DriveMode> seen;
  bool latched = false;
  for (int n = 0; n < 20000; ++n) {
    DriveFacts f = one_in(2) ? well(0.1 * n) : moving(0.1 * n);
    f.told_to_drive = !one_in(30);
    f.emergency_stop = one_in(40);
    f.acknowledged = one_in(10);
    if (one_in(40)) f.stale_source = "s";
    if (one_in(40)) f.base_fault = "b";
    if (one_in(40)) f.obstacle = "o";
    if (one_in(40)) f.late_thread = "t";
    if (one_in(40)) f.ended_thread = "t";
    f.uncommanded_motion = one_in(60);
    if (one_in(60)) f.not_following = "f";
    if (one_in(60)) f.silent_emergency_stop = "e";
    f.localization = static_cast<Localization>(one_in(4) ? random() % 3 : 0);
    if (one_in(200)) f.stamp = std::nan("");
    const DriveState next = decide(state, f, kOptions);
    seen.insert(next.mode);
    const DriveSpeed speed = drive_speed(next, kOptions);
    if (f.emergency_stop) {
      EXPECT_TRUE(next.mode == kStopping || next.mode == kStopped);
      EXPECT_NE(speed.response, DriveResponse::kComfortStop);
      latched = true;
    }
    if (latches(next.cause) && next.mode == kStopping) latched = true;
    if (latched && next.mode == kIdle) {
      EXPECT_TRUE(f.acknowledged && f.rest_for > 0.0 && state.mode == kStopped) << n;
      latched = false;
    }
    EXPECT_TRUE(!latched || next.mode == kStopping || next.mode == kStopped) << n;
    const bool drives = next.mode == kActive || next.mode == kDegraded;
    const bool drove = state.mode == kActive || state.mode == kDegraded;
    EXPECT_TRUE(!drives || drove || state.mode == kReady) << n;
    EXPECT_TRUE(!drives || (f.told_to_drive && f.obstacle.empty() && f.stale_source.empty()));
    EXPECT_EQ(speed.share > 0.0, drives);
    EXPECT_TRUE(next.mode != kStopped || latches(next.cause)) << n;
    state = next;
  }
  EXPECT_EQ(seen.size(), kDriveModes.size());
}

TEST(DriveMode, ResponsesOfModesAndCauses) {
  EXPECT_EQ(drive_speed(in(kIdle), kOptions).response, DriveResponse::kStand);
  EXPECT_EQ(drive_speed(in(kReady), kOptions).response, DriveResponse::kStand);
  for (const DriveCausePolicy& policy : drive_cause_policies()) {
    if (!policy.latches) continue;
    EXPECT_EQ(drive_speed(in(kStopped, policy.cause), kOptions).response,
              DriveResponse::kEmergencyStop);
  }
  EXPECT_EQ(drive_speed(in(kActive), kOptions).response, DriveResponse::kFull);
  // One policy a cause, in their order; each of them is one that the table leads to.
  int before = -1;
  for (const DriveCausePolicy& policy : drive_cause_policies()) {
    EXPECT_GT(static_cast<int>(policy.cause), before);
    before = static_cast<int>(policy.cause);
    bool named = false;
    for (const DriveModeRow& row : drive_mode_table()) {
      const bool slow = row.to == kDegraded, stop = row.to == kStopping;
      if (row.cause != policy.cause || (!slow && !stop)) continue;
      named = true;
      EXPECT_EQ(slow, policy.response == DriveResponse::kSlow);
      EXPECT_EQ(slow, policy.share != nullptr);
    }
    EXPECT_TRUE(named) << to_string(policy.cause);
    const DriveSpeed speed = drive_speed(in(kDegraded, policy.cause), kOptions);
    EXPECT_EQ(speed.share, policy.share ? kOptions.*policy.share : 0.0);
  }
  // A cause without policy in a mode that needs one: the hardest answer.
  EXPECT_EQ(drive_speed(in(kStopping), kOptions).response, DriveResponse::kEmergencyStop);
}

TEST(DriveMode, SaysWhatItDoesAndWhy) {
  EXPECT_EQ(describe(in(kStopping, DriveCause::kSourceStale),
                     with(moving(), &DriveFacts::stale_source, "left camera")),
            "Brakes along its way: source stale (left camera).");
  EXPECT_EQ(describe(in(kStopping, DriveCause::kBaseSilent), moving()),
            "Brakes as hard as it can: base silent.");
  EXPECT_EQ(describe(in(kStopped, DriveCause::kEmergencyStop), well()),
            "Stands until the stop is acknowledged: emergency stop.");
  std::set<std::string_view> names;
  for (int cause = 0; cause < kDriveCauses; ++cause) {
    names.insert(to_string(static_cast<DriveCause>(cause)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kDriveCauses));
  EXPECT_EQ(names.count("?"), 0u);
}

TEST(DriveMode, TheReferencePageHoldsTheTables) {
  std::ifstream file(PROSPECT_SOURCE_DIR "/docs/reference/drive_modes.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find("<!-- prospect list drive-modes -->\n" + drive_mode_tables() +
                            "<!-- end -->"),
            std::string::npos)
      << "docs/reference/drive_modes.md: put the output of `prospect list drive-modes` between the "
         "marks";
}

}  // namespace
}  // namespace prospect::drive_mode_test
