// SPDX-License-Identifier: Apache-2.0
#include "docs/examples/create2/create2_base.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/examples/fake_create2.h"

namespace prospect::create2_base_test {
namespace {

/// Waits until it is so; tests share their machine.
bool soon(const std::function<bool()>& so) {
  const SteadyClock clock;
  for (const double end = clock.now() + 10.0; clock.now() < end;) {
    if (so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return so();
}

class Create2BaseTest : public ::testing::Test {
 protected:
  Create2Options options() {
    Create2Options options;
    options.device = robot_.device();
    options.patience = 10.0;
    return options;
  }
  /// What the base reports, all wheel motion added up.
  BaseReport report(Create2Base& base) {
    BaseReport report = base.report();
    for (const WheelSample& sample : report.wheels) {
      if (before_ > 0.0) way_ += sample.velocity.x() * (sample.stamp - before_);
      before_ = sample.stamp;
    }
    return report;
  }

  SteadyClock clock_;
  test::FakeCreate2 robot_;
  double way_ = 0.0, before_ = 0.0;
};

TEST_F(Create2BaseTest, DrivesMeasuresAndStandsWhenCommandsCease) {
  Create2Base base(options());
  EXPECT_EQ(base.dead_man(), 0.3);
  EXPECT_EQ(base.limits().speed, 0.5);
  EXPECT_TRUE(soon([&] { return report(base).connected && before_ > 0.0; }));
  double fastest = 0.0;
  EXPECT_TRUE(soon([&] {
    base.send({{0.3, 0.0, 0.0}, 0.4}, clock_.now() + 0.2);
    fastest = std::max(fastest, report(base).velocity.linear.x());
    return robot_.driven() > 0.06;  // the encoders have wrapped
  }));
  EXPECT_NEAR(robot_.right(), 0.347, 1e-9);
  EXPECT_NEAR(robot_.left(), 0.253, 1e-9);
  EXPECT_GT(fastest, 0.2);
  // Nobody sends any more: the relay stops it.
  EXPECT_TRUE(soon([&] { return robot_.right() == 0.0 && robot_.left() == 0.0; }));
  EXPECT_TRUE(soon([&] { return report(base).velocity.linear.x() == 0.0; }));
  EXPECT_NEAR(way_, robot_.driven(), 0.005);
}

TEST_F(Create2BaseTest, ACommandThatHasExpiredIsNotExecutedAndAStopIs) {
  Create2Base base(options());
  base.send({{0.3, 0.0, 0.0}, 0.0}, clock_.now() - 0.01);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  EXPECT_EQ(robot_.right(), 0.0);
  EXPECT_TRUE(soon([&] {
    base.send({{0.3, 0.0, 0.0}, 0.0}, clock_.now() + 5.0);
    return robot_.right() > 0.2;
  }));
  base.stop();
  EXPECT_TRUE(soon([&] { return robot_.right() == 0.0; }));
}

TEST_F(Create2BaseTest, TheDeadMansTimeHoldsWhateverTheExpiry) {
  Create2Base base(options());
  EXPECT_TRUE(soon([&] {
    base.send({{0.3, 0.0, 0.0}, 0.0}, clock_.now() + 100.0);
    return robot_.right() > 0.2;
  }));
  EXPECT_TRUE(soon([&] { return robot_.right() == 0.0; }));
}

TEST_F(Create2BaseTest, WhoeverDiesLeavesAStop) {
  // The owner is a process that drives and is killed.
  const Create2Options as_here = options();
  const pid_t owner = ::fork();
  if (owner == 0) {
    Create2Base base(as_here);
    while (true) {
      base.send({{0.3, 0.0, 0.0}, 0.0}, SteadyClock().now() + 100.0);
      ::usleep(20000);
    }
  }
  EXPECT_TRUE(soon([&] { return robot_.right() > 0.2; }));
  ::kill(owner, SIGKILL);
  ::waitpid(owner, nullptr, 0);
  EXPECT_TRUE(soon([&] { return robot_.stops() == 1; }));
  EXPECT_EQ(robot_.right(), 0.0);
}

TEST_F(Create2BaseTest, CorruptedBytesCostTheirPacketsAlone) {
  robot_.corrupt = true;
  Create2Base base(options());
  EXPECT_TRUE(soon([&] { return report(base).connected && before_ > 0.0; }));
  EXPECT_TRUE(soon([&] {
    base.send({{0.3, 0.0, 0.0}, 0.0}, clock_.now() + 0.2);
    const BaseReport now = report(base);
    EXPECT_TRUE(now.faults.empty());
    EXPECT_LT(now.velocity.linear.x(), 0.45);
    return robot_.driven() > 0.06;
  }));
  EXPECT_TRUE(
      soon([&] { return report(base).velocity.linear.x() == 0.0 && robot_.right() == 0.0; }));
  EXPECT_NEAR(way_, robot_.driven(), 0.01);
}

TEST_F(Create2BaseTest, SilenceShowsInTheStamp) {
  Create2Base base(options());
  EXPECT_TRUE(soon([&] { return report(base).connected; }));
  robot_.silent = true;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const double stamp = report(base).stamp;
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  EXPECT_EQ(report(base).stamp, stamp);
  robot_.silent = false;
  EXPECT_TRUE(soon([&] { return report(base).stamp > stamp; }));
}

TEST_F(Create2BaseTest, AnUnpluggedCableIsAFault) {
  Create2Base base(options());
  EXPECT_TRUE(soon([&] { return report(base).connected; }));
  robot_.unplug = true;
  EXPECT_TRUE(soon([&] { return !report(base).connected; }));
  ASSERT_FALSE(report(base).faults.empty());
  EXPECT_NE(report(base).faults.back().find("unplugged"), std::string::npos);
}

TEST_F(Create2BaseTest, ARelayThatHasEndedIsAFault) {
  Create2Base base(options());
  EXPECT_TRUE(soon([&] { return report(base).connected; }));
  ::kill(base.relay().process(), SIGKILL);
  EXPECT_TRUE(soon([&] { return !report(base).connected; }));
  EXPECT_NE(report(base).faults.back().find("relay"), std::string::npos);
}

TEST_F(Create2BaseTest, ABumperIsAFaultAndTheSafeModeIsEnteredAgain) {
  Create2Base base(options());
  robot_.set([](Create2Sensors& s) { s.bump_left = true; });
  EXPECT_TRUE(soon([&] { return !report(base).faults.empty(); }));
  robot_.set([](Create2Sensors& s) { s.bump_left = false; });
  EXPECT_TRUE(soon([&] { return report(base).faults.empty(); }));
  // As the base does over a cliff.
  robot_.set([](Create2Sensors& s) { s.cliff = true, s.mode = 1; });
  EXPECT_TRUE(soon([&] { return report(base).faults.size() == 2; }));
  robot_.set([](Create2Sensors& s) { s.cliff = false; });
  EXPECT_TRUE(soon([&] { return report(base).faults.empty(); }));
}

TEST_F(Create2BaseTest, WhatIsNoCreateIsRefused) {
  const auto refusal = [](const Create2Options& options) -> std::string {
    try {
      const Create2Base base(options);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Create2Options wrong = options();
  wrong.device = "/dev/no such line";
  EXPECT_EQ(refusal(wrong),
            "/dev/no such line: No such file or directory; expected a serial device that may be "
            "read and written");
  wrong.device = "/dev/null";
  EXPECT_NE(refusal(wrong).find("/dev/null: "), std::string::npos);
  wrong = options();
  wrong.rate = 1234;
  EXPECT_NE(refusal(wrong).find("a rate of 1234 baud"), std::string::npos);
  wrong = options();
  robot_.silent = true;
  wrong.patience = 0.1;
  EXPECT_NE(refusal(wrong).find("nothing that can be understood comes"), std::string::npos);
  wrong.dead_man = 0.0;
  EXPECT_THROW(Create2Base{wrong}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::create2_base_test
