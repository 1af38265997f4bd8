// SPDX-License-Identifier: Apache-2.0
#include "runtime/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace prospect::event_log_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(EventLog, KeepsEventsInOrderAndGivesThemByNumber) {
  EventLog log;
  EXPECT_TRUE(log.since(0).events.empty());
  EXPECT_EQ(log.since(0).next, 0u);
  log.add(1.0, Severity::kInfo, "driver", "ready", "");
  log.add(1.5, Severity::kError, "left camera", "stale", "0.7 s old");
  const EventLog::Reading first = log.since(0);
  ASSERT_EQ(first.events.size(), 2u);
  EXPECT_EQ(first.next, 2u);
  EXPECT_TRUE(first.complete);
  EXPECT_EQ(to_text(first.events[0]), "1.000 info driver: ready");
  EXPECT_EQ(to_text(first.events[1]), "1.500 error left camera: stale: 0.7 s old");
  EXPECT_TRUE(log.since(first.next).events.empty());
  log.add(2.0, Severity::kWarning, "planner", "late", "");
  const EventLog::Reading second = log.since(first.next);
  ASSERT_EQ(second.events.size(), 1u);
  EXPECT_EQ(second.events[0].source, "planner");
  EXPECT_TRUE(log.since(99).events.empty());  // a number that is still to come
}

TEST(EventLog, CountsWhatComesAgain) {
  struct Case {
    const char* what;
    double stamp;
    Severity severity;
    const char* source;
    const char* cause;
    bool repeated;
  };
  for (const Case& c : {
           Case{"the same", 10.5, Severity::kError, "camera", "stale", true},
           Case{"at the end of the gap", 12.0, Severity::kError, "camera", "stale", true},
           Case{"after the gap", 12.01, Severity::kError, "camera", "stale", false},
           Case{"stamped a little earlier", 9.9, Severity::kError, "camera", "stale", true},
           Case{"another severity", 10.5, Severity::kWarning, "camera", "stale", false},
           Case{"another source", 10.5, Severity::kError, "wheels", "stale", false},
           Case{"another cause", 10.5, Severity::kError, "camera", "jumped", false},
           Case{"no stamp", std::nan(""), Severity::kError, "camera", "stale", false},
       }) {
    EventLog log;
    log.add(10.0, Severity::kError, "camera", "stale", "0.6 s old");
    log.add(c.stamp, c.severity, c.source, c.cause, "0.8 s old");
    const std::vector<Event> events = log.since(0).events;
    ASSERT_EQ(events.size(), c.repeated ? 1u : 2u) << c.what;
    EXPECT_EQ(events.back().count, c.repeated ? 2 : 1) << c.what;
    EXPECT_EQ(events.back().text, "0.8 s old") << c.what;
    EXPECT_EQ(events.front().stamp, 10.0) << c.what;
  }
}

// Two faults that alternate at each command are two events, whatever numbers their texts hold.
TEST(EventLog, AlternatingFaultsAreTwoEvents) {
  EventLog log;
  log.add(0.0, Severity::kInfo, "driver", "started", "");
  for (int k = 0; k < 500; ++k) {
    log.add(0.02 * k, Severity::kError, "camera", "stale", std::to_string(k) + " ms old");
    log.add(0.02 * k, Severity::kError, "wheels", "stale", std::to_string(k) + " ms old");
  }
  const EventLog::Reading reading = log.since(0);
  ASSERT_EQ(reading.events.size(), 3u);
  EXPECT_EQ(reading.events[1].count, 500);
  EXPECT_EQ(to_text(reading.events[2]),
            "0.000 error wheels: stale: 499 ms old (500 times until 9.980)");
  EXPECT_EQ(log.totals().of(Severity::kError), 1000u);
  EXPECT_EQ(log.totals().dropped, 0u);
  // Who has read it sees it again once it happens again.
  log.add(10.0, Severity::kError, "camera", "stale", "");
  ASSERT_EQ(log.since(reading.next).events.size(), 1u);
  EXPECT_EQ(log.since(reading.next).events[0].count, 501);
}

// What an event said in other words is read after the mission, too; numbers alone are not.
TEST(EventLog, EachTextThatDiffersIsKept) {
  EventLog log;
  const auto say = [&](double stamp, const std::string& text) {
    log.add(stamp, Severity::kError, "base", "fault", text);
  };
  say(1.0, "bumper pressed");
  say(1.1, "battery at 11.2 V");
  say(1.2, "battery at -3 V");
  say(1.3, "bumper pressed");
  say(1.4, "wheel drop");
  const Event event = log.since(0).events.at(0);
  EXPECT_EQ(event.text, "wheel drop");
  EXPECT_THAT(event.before, ElementsAre("battery at -3 V", "bumper pressed"));
  EXPECT_EQ(to_text(event),
            "1.000 error base: fault: wheel drop (5 times until 1.400; before: battery at -3 V; "
            "bumper pressed)");
  // Bounded.
  for (char c = 'a'; c <= 'z'; ++c) say(1.5, std::string("no ") + c);
  const Event longer = log.since(0).events.at(0);
  EXPECT_EQ(longer.before.size(), kMostTexts);
  EXPECT_EQ(longer.before.back(), "no y");
  EXPECT_EQ(longer.left_out, 8);
  EXPECT_THAT(to_text(longer), HasSubstr("; no y; 8 more)"));
}

TEST(EventLog, OverflowIsCountedAndAReaderThatMissedSomethingIsTold) {
  EventLog log({.capacity = 16});
  for (int k = 0; k < 20; ++k) {
    log.add(k, Severity::kInfo, "source", "cause " + std::to_string(k), "");
  }
  EXPECT_EQ(log.totals().dropped, 4u);
  const EventLog::Reading reading = log.since(0);
  ASSERT_EQ(reading.events.size(), 16u);
  EXPECT_EQ(reading.events.front().cause, "cause 4");
  EXPECT_FALSE(reading.complete);
  EXPECT_FALSE(log.since(3).complete);
  EXPECT_TRUE(log.since(4).complete);
  EXPECT_TRUE(log.since(reading.next).complete);
}

TEST(EventLog, LongTextsAreCutAndSaySo) {
  EventLog log({.longest_text = 16});
  log.add(0.0, Severity::kInfo, "s", "a", std::string(16, 'x'));
  log.add(0.0, Severity::kInfo, "s", "b", std::string(17, 'x'));
  EXPECT_EQ(log.since(0).events[0].text, std::string(16, 'x'));
  EXPECT_EQ(log.since(0).events[1].text, std::string(13, 'x') + "...");
}

TEST(EventLog, SeveralThreadsAddWhileOneReads) {
  EventLog log({.capacity = 100000});
  constexpr int kThreads = 3, kEach = 400;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&log, t] {
      for (int k = 0; k < kEach; ++k) {
        log.add(10.0 * k, Severity::kInfo, "thread " + std::to_string(t), "tick", "");
      }
    });
  }
  std::size_t read = 0;
  std::uint64_t next = 0;
  while (read < kThreads * kEach) {
    const EventLog::Reading reading = log.since(next);
    for (const Event& e : reading.events) EXPECT_EQ(e.number, next++);
    EXPECT_EQ(reading.next, next);
    read += reading.events.size();
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(log.totals().of(Severity::kInfo), static_cast<std::uint64_t>(kThreads * kEach));
}

TEST(EventLog, RefusesOptionsOutOfRange) {
  try {
    EventLog log({.capacity = 0});
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("event log: capacity is 0; expected"));
  }
}

}  // namespace
}  // namespace prospect::event_log_test
