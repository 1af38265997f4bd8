// SPDX-License-Identifier: Apache-2.0
#include "runtime/supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace prospect::supervisor_test {
namespace {

using ::testing::HasSubstr;

enum Thread { kPerception, kPlanner, kCommands };

Supervisor three() {
  return Supervisor({{"perception", 0.3}, {"planner", 1.0}, {"commands", 0.1}}, 100.0);
}

TEST(Supervisor, ThreadStatesAreToldApart) {
  struct Case {
    const char* what;
    double beat;  // [s]; 0: none
    bool ended;
    double now;
    ThreadState state;
    double age;
  };
  const double nan = std::nan("");
  for (const Case& c : {
           Case{"before its first beat", 0.0, false, 100.9, ThreadState::kStarting, 0.9},
           Case{"no first beat", 0.0, false, 101.1, ThreadState::kNeverStarted, 1.1},
           Case{"ended without a beat", 0.0, true, 100.1, ThreadState::kEnded, 0.1},
           Case{"a beat", 105.0, false, 106.0, ThreadState::kOnTime, 1.0},
           Case{"a beat in between", 105.1, false, 105.0, ThreadState::kOnTime, -0.1},
           Case{"an old beat", 105.0, false, 106.01, ThreadState::kLate, 1.01},
           Case{"ended after a beat", 105.0, true, 105.1, ThreadState::kEnded, 0.1},
           Case{"ended and old", 105.0, true, 205.0, ThreadState::kEnded, 100.0},
           Case{"a beat without time", nan, false, 105.0, ThreadState::kLate, nan},
           Case{"asked without time", 105.0, false, nan, ThreadState::kLate, nan},
       }) {
    Supervisor supervisor = three();
    if (c.beat != 0.0) supervisor.beat(kPlanner, c.beat);
    if (c.ended) supervisor.end(kPlanner);
    const ThreadReport report = supervisor.report(c.now)[kPlanner];
    EXPECT_EQ(to_string(report.state), to_string(c.state)) << c.what;
    EXPECT_EQ(report.name, "planner");
    EXPECT_EQ(report.limit, 1.0);
    EXPECT_EQ(report.beats, c.beat != 0.0 ? 1u : 0u);
    EXPECT_TRUE(std::isnan(c.age) ? std::isnan(report.age) : std::abs(report.age - c.age) < 1e-9)
        << c.what;
    EXPECT_FALSE(supervisor.may_stroke(c.now)) << c.what;  // the others have not begun
  }
}

TEST(Supervisor, TheWatchdogIsStrokedOnlyIfAllHaveAnsweredSince) {
  Supervisor supervisor = three();
  EXPECT_FALSE(supervisor.may_stroke(100.0));
  supervisor.beat(kPerception, 100.0);
  supervisor.beat(kPlanner, 100.0);
  EXPECT_FALSE(supervisor.may_stroke(100.0));
  supervisor.beat(kCommands, 100.0);
  EXPECT_TRUE(supervisor.may_stroke(100.05));
  EXPECT_FALSE(supervisor.may_stroke(100.05));  // nobody has answered since
  supervisor.beat(kCommands, 100.10);
  supervisor.beat(kPerception, 100.10);
  EXPECT_FALSE(supervisor.may_stroke(100.1));  // the planner has not, though it is not late
  EXPECT_EQ(supervisor.report(100.1)[kPlanner].state, ThreadState::kOnTime);
  supervisor.beat(kPlanner, 100.15);
  EXPECT_TRUE(supervisor.may_stroke(100.15));
  // All have answered, but one is late by now.
  for (const int thread : {kPerception, kPlanner, kCommands}) supervisor.beat(thread, 100.2);
  EXPECT_FALSE(supervisor.may_stroke(100.35));
  EXPECT_EQ(supervisor.report(100.35)[kCommands].state, ThreadState::kLate);
  supervisor.beat(kCommands, 100.36);
  EXPECT_TRUE(supervisor.may_stroke(100.36));  // what was answered before is not lost
  // One has ended.
  for (const int thread : {kPerception, kPlanner, kCommands}) supervisor.beat(thread, 100.4);
  supervisor.end(kPerception);
  EXPECT_FALSE(supervisor.may_stroke(100.4));
}

// A planner that sleeps for 2 s beside threads that do not.
TEST(Supervisor, AThreadThatSleepsStopsTheStrokes) {
  Supervisor supervisor = three();
  double last = 0.0, late_at = 0.0;
  for (int n = 1; n <= 200; ++n) {
    const double now = 100.0 + 0.02 * n;
    supervisor.beat(kCommands, now);
    supervisor.beat(kPerception, now);
    if (n <= 50 && n % 10 == 0) supervisor.beat(kPlanner, now);
    if (supervisor.may_stroke(now)) last = now;
    const bool late = supervisor.report(now)[kPlanner].state == ThreadState::kLate;
    if (late && late_at == 0.0) late_at = now;
  }
  EXPECT_NEAR(last, 101.0, 1e-9);
  EXPECT_NEAR(late_at, 102.02, 1e-9);
  EXPECT_EQ(supervisor.longest_limit(), 1.0);
}

TEST(Supervisor, ThreadsBeatWhileAnotherAsks) {
  Supervisor supervisor({{"a", 1e9}, {"b", 1e9}}, 0.0);
  std::atomic<bool> go{true};
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t) {
    threads.emplace_back([&supervisor, &go, t] {
      for (double now = 1.0; go; now += 1.0) {
        supervisor.beat(t, now);
        std::this_thread::yield();
      }
      supervisor.end(t);
    });
  }
  int strokes = 0;
  while (strokes < 10) {
    strokes += supervisor.may_stroke(1e6);
    std::this_thread::yield();
  }
  go = false;
  for (std::thread& thread : threads) thread.join();
  for (const ThreadReport& report : supervisor.report(1e6)) {
    EXPECT_EQ(report.state, ThreadState::kEnded);
    EXPECT_GE(report.beats, 10u);
  }
}

TEST(Supervisor, RefusesThreadsThatCannotBeToldApartOrAreNeverLate) {
  struct Case {
    std::vector<SupervisedThread> threads;
    const char* message;
  };
  for (const Case& c : {Case{{}, "no thread; expected one or more"},
                        Case{{{"", 1.0}}, "thread ''; expected a name"},
                        Case{{{"a", 1.0}, {"a", 1.0}}, "thread 'a'; expected a name, and another"},
                        Case{{{"a", 0.0}}, "limit of thread 'a' is 0; expected a number above 0 s"},
                        Case{{{"a", INFINITY}}, "limit of thread 'a' is inf; expected"}}) {
    try {
      Supervisor supervisor(c.threads, 0.0);
      FAIL() << c.message;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message));
    }
  }
}

}  // namespace
}  // namespace prospect::supervisor_test
