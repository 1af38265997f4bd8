// SPDX-License-Identifier: Apache-2.0
#include "runtime/health_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace prospect::health_report_test {
namespace {

HealthReport well() {
  HealthReport r;
  r.stamp = 62.5;
  r.drive = {DriveMode::kActive, DriveCause::kNewPlan, 12.0};
  r.speed = drive_speed(r.drive, {});
  r.why = "Drives: new plan.";
  r.sources = {{"cameras", 0.041, 0.3, 900, 2}};
  r.threads = {{"planner", ThreadState::kOnTime, 0.21, 1.0, 300}};
  r.preflight = {{"dead-man", CheckVerdict::kPassed, "0.5 s"}};
  return r;
}

TEST(HealthReport, TheWorstDecidesTheLevel) {
  struct Case {
    const char* what;
    std::function<void(HealthReport&)> change;
    Severity level;
  };
  const auto drive = [](DriveMode mode, DriveCause cause) {
    return [=](HealthReport& r) { r.drive = {mode, cause, 60.0}; };
  };
  const auto event = [](Severity severity) {
    return [=](HealthReport& r) { r.newest.push_back({60.0, severity, "a", "b", ""}); };
  };
  for (const Case& c : std::vector<Case>{
           {"well", [](HealthReport&) {}, Severity::kInfo},
           {"nothing", [](HealthReport& r) { r = {}; }, Severity::kInfo},
           {"task over", drive(DriveMode::kStopping, DriveCause::kTaskOver), Severity::kInfo},
           {"told to stand", drive(DriveMode::kStopping, DriveCause::kToldToStand),
            Severity::kInfo},
           {"degraded", drive(DriveMode::kDegraded, DriveCause::kLocalizationLost),
            Severity::kWarning},
           {"stale", drive(DriveMode::kStopping, DriveCause::kSourceStale), Severity::kError},
           {"emergency", drive(DriveMode::kStopping, DriveCause::kEmergencyStop), Severity::kFatal},
           {"stopped", drive(DriveMode::kStopped, DriveCause::kBaseFault), Severity::kFatal},
           {"old source", [](HealthReport& r) { r.sources[0].age = 0.31; }, Severity::kError},
           {"no source yet", [](HealthReport& r) { r.sources[0].age = INFINITY; },
            Severity::kError},
           {"source without age", [](HealthReport& r) { r.sources[0].age = std::nan(""); },
            Severity::kError},
           {"thread starting", [](HealthReport& r) { r.threads[0].state = ThreadState::kStarting; },
            Severity::kInfo},
           {"thread late", [](HealthReport& r) { r.threads[0].state = ThreadState::kLate; },
            Severity::kError},
           {"thread ended", [](HealthReport& r) { r.threads[0].state = ThreadState::kEnded; },
            Severity::kError},
           {"thread absent",
            [](HealthReport& r) { r.threads[0].state = ThreadState::kNeverStarted; },
            Severity::kError},
           {"check warned", [](HealthReport& r) { r.preflight[0].verdict = CheckVerdict::kWarned; },
            Severity::kWarning},
           {"check failed", [](HealthReport& r) { r.preflight[0].verdict = CheckVerdict::kFailed; },
            Severity::kError},
           {"warning shown", event(Severity::kWarning), Severity::kWarning},
           {"fatal shown", event(Severity::kFatal), Severity::kFatal},
       }) {
    HealthReport report = well();
    c.change(report);
    EXPECT_EQ(to_string(level(report)), to_string(c.level)) << c.what;
  }
}

TEST(HealthReport, TextHoldsAllOfIt) {
  HealthReport r = well();
  r.drive = {DriveMode::kStopping, DriveCause::kSourceStale, 62.0};
  r.speed = drive_speed(r.drive, {});
  r.why = "Brakes along its way: source stale (depth).";
  r.sources.push_back({"depth", 0.82, 0.5, 400, 0});
  r.sources.push_back({"wheels", INFINITY, 0.2, 0, 0});
  r.threads.push_back({"log", ThreadState::kLate, 2.5, 1.0, 7});
  NamedLatency latency{"capture to wheel", {}};
  for (int n = 0; n < 10; ++n) latency.histogram.add(0.1);
  r.latencies = {latency};
  r.preflight.push_back({"yaw of the pose", CheckVerdict::kWarned, "gain 0.87"});
  r.preflight.push_back({"slip", CheckVerdict::kNotPossible, "no wheels"});
  EventLog log;
  log.add(62.0, Severity::kError, "depth", "stale", "0.82 s old");
  log.add(62.1, Severity::kInfo, "planner", "new plan", "");
  r.events = log.totals();
  r.newest = log.since(0).events;
  EXPECT_EQ(to_text(r),
            "62.500 s, error: stopping since 62.000 s, comfort stop, 0 % of the speed\n"
            "  Brakes along its way: source stale (depth).\n"
            "  source cameras: age 41.0 ms, limit 300 ms, 900 received, 2 dropped\n"
            "! source depth: age 820 ms, limit 500 ms, 400 received, 0 dropped\n"
            "! source wheels: age none yet, limit 200 ms, 0 received, 0 dropped\n"
            "  thread planner: on time, age 210 ms, limit 1.00 s\n"
            "! thread log: late, age 2.50 s, limit 1.00 s\n"
            "  latency capture to wheel: n 10, p50 100 ms, p99 100 ms, max 100 ms\n"
            "  check yaw of the pose: warned: gain 0.87\n"
            "  check slip: not possible: no wheels\n"
            "  events: 1 info, 0 warning, 1 error, 0 fatal, 0 dropped\n"
            "! 62.000 error depth: stale: 0.82 s old\n"
            "  62.100 info planner: new plan\n");
}

TEST(HealthReport, ARobotThatHasNotBegunSaysSo) {
  EXPECT_EQ(to_text(HealthReport()),
            "0.000 s, info: idle since 0.000 s, stand, 0 % of the speed\n"
            "  pre-flight: not made\n"
            "  events: 0 info, 0 warning, 0 error, 0 fatal, 0 dropped\n");
}

}  // namespace
}  // namespace prospect::health_report_test
