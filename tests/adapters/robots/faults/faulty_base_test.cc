// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_base.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace prospect::faulty_base_test {
namespace {

class Hand final : public Clock {
 public:
  double now() const noexcept override { return time; }
  bool wait_until(double until, const std::stop_token&) const noexcept override {
    time = std::max(time, until);
    return true;
  }
  mutable double time = 100.0;  // [s]
};

/// Moves at a speed of its own.
class Plain final : public Base {
 public:
  Plain(const Clock& clock, bool tells_wheels) : clock_(clock), tells_wheels_(tells_wheels) {}
  std::string name() const noexcept override { return "plain"; }
  std::optional<double> dead_man() const noexcept override { return 0.4; }
  void send(const Twist& command, double) noexcept override { sent.push_back(command.linear.x()); }
  void stop() noexcept override { ++stops; }
  BaseReport report() noexcept override {
    BaseReport report;
    report.connected = true;
    report.stamp = clock_.now();
    report.velocity = {{speed, 0.0, 0.0}, 0.0};
    if (tells_wheels_) report.wheels = {{clock_.now(), {speed, 0.0}, 0.0}};
    return report;
  }
  std::vector<double> sent;
  int stops = 0;
  double speed = 0.5;  // [m/s]

 private:
  const Clock& clock_;
  const bool tells_wheels_;
};

struct Broken {
  explicit Broken(const std::string& fault, bool tells_wheels = true)
      : plain(clock, tells_wheels),
        base(plain, clock, {parse_fault(fault + "@1+2")}, clock.now()) {}
  /// Reports and sends each 0.1 s until so many seconds after the start.
  std::vector<BaseReport> until(double end) {
    std::vector<BaseReport> reports;
    for (; (clock.time = 100.05 + 0.1 * tick) < 100.0 + end; ++tick) {
      reports.push_back(base.report());
      base.send({{clock.time - 100.0, 0.0, 0.0}, 0.0}, clock.time + 0.15);
    }
    return reports;
  }
  int tick = 0;
  Hand clock;
  Plain plain;
  FaultyBase base;
};

TEST(FaultyBase, ALinkThatIsOffCarriesNothing) {
  Broken b("link:off");
  b.until(1.0);
  EXPECT_EQ(b.plain.sent.size(), 10U);
  const auto reports = b.until(2.0);
  EXPECT_EQ(b.plain.sent.size(), 10U);
  EXPECT_NEAR(reports.back().stamp, 100.95, 1e-9) << "the newest that passed";
  b.base.stop();
  EXPECT_EQ(b.plain.stops, 0);
  b.until(3.0);
  // What the wheels measured meanwhile is told when the link is back.
  EXPECT_GT(b.until(3.1).back().wheels.size(), 15U);
  EXPECT_EQ(b.plain.sent.size(), 11U);
}

TEST(FaultyBase, CommandsThatComeLateHaveExpired) {
  Broken late("link:delayed");
  late.until(3.0);
  EXPECT_EQ(late.plain.sent.size(), 10U);
  Broken slow("link:slow");
  slow.until(3.0);
  EXPECT_NEAR(static_cast<double>(slow.plain.sent.size()), 10.0 + 2.0 / kSlowLink, 1.0);
}

TEST(FaultyBase, MotorsThatDoOtherwise) {
  Broken b("base:inverted");
  b.until(1.0);
  EXPECT_GT(b.plain.sent.back(), 0.0);
  b.until(3.0);
  EXPECT_LT(b.plain.sent.back(), 0.0);
  b.until(3.2);
  EXPECT_GT(b.plain.sent.back(), 0.0);
}

// Of a base that tells what its wheels measured and of one that tells its velocity alone. It slows
// down as the fault begins.
TEST(FaultyBase, EncodersThatLie) {
  struct Case {
    const char* fault;
    double at;     // [s]
    double speed;  // [m/s] that it tells then
  };
  for (const bool tells_wheels : {true, false}) {
    const auto broken = [&](const char* fault, double at) {
      Broken b(fault, tells_wheels);
      b.until(1.0);
      b.plain.speed = 0.25;
      return b.until(at).back();
    };
    for (const Case& c : {
             Case{"wheels:wrong", 2.0, 0.5}, Case{"wheels:wrong", 3.5, 0.25},  // it is over
             Case{"wheels:stuck", 2.0, 0.25},  // the first that it measured then
             Case{"wheels:intermittent", 1.5, 0.0}, Case{"wheels:intermittent", 2.0, 0.25},
             Case{"wheels:slow", 2.0, 0.5},      // the report before
             Case{"wheels:slow", 2.5, 0.25},     // 1.2 s later
             Case{"wheels:delayed", 1.3, 0.5},   // 0.3 s old
             Case{"wheels:delayed", 1.5, 0.25},  // likewise
         }) {
      const BaseReport report = broken(c.fault, c.at);
      EXPECT_EQ(report.velocity.linear.x(), c.speed) << c.fault << " at " << c.at;
      if (!report.wheels.empty()) {
        EXPECT_EQ(report.wheels.back().velocity.x(), c.speed) << c.fault;
      }
    }
    EXPECT_TRUE(std::isnan(broken("wheels:garbage", 2.0).velocity.linear.x()));
    EXPECT_EQ(broken("wheels:off", 2.0).faults.size(), 1U);
    EXPECT_TRUE(broken("wheels:off", 2.0).wheels.empty());
    EXPECT_NEAR(broken("wheels:slow", 2.0).stamp, 100.95, 1e-9);
    // What was measured as it stuck is told again.
    Broken stuck("wheels:stuck", tells_wheels);
    stuck.until(1.2);
    stuck.plain.speed = 0.0;
    EXPECT_EQ(stuck.until(2.0).back().velocity.linear.x(), 0.5);
    EXPECT_EQ(stuck.until(3.5).back().velocity.linear.x(), 0.0);
  }
}

TEST(FaultyBase, ACommandThreadThatSleeps) {
  Broken b("command:stuck");
  b.until(1.0);
  b.base.report();
  EXPECT_NEAR(b.clock.time, 103.0, 1e-9);
}

}  // namespace
}  // namespace prospect::faulty_base_test
