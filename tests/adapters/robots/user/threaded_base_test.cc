// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/threaded_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/clock.h"

namespace prospect::threaded_base_test {
namespace {

using testing::HasSubstr;

/// Does what the test says; shared with it, as a driver that hangs outlives all.
struct Says {
  std::function<void()> send, report;
  std::atomic<int> sent{0}, stopped{0};
  std::atomic<bool> hang{true}, hangs{false};
};

class SayingBase final : public Base {
 public:
  explicit SayingBase(std::shared_ptr<Says> says) : says_(std::move(says)) {}
  std::string name() const override { return "says"; }
  std::optional<double> dead_man() const override { return 0.5; }
  void send(const Twist&, double) override {
    if (says_->send) says_->send();
    ++says_->sent;
  }
  void stop() override { ++says_->stopped; }
  BaseReport report() override {
    if (says_->report) says_->report();
    BaseReport report;
    report.connected = true;
    report.stamp = SteadyClock().now();
    report.wheels.resize(1);
    return report;
  }

 private:
  const std::shared_ptr<Says> says_;
};

bool soon(const std::function<bool()>& so) {
  const SteadyClock clock;
  for (const double end = clock.now() + 10.0; clock.now() < end;) {
    if (so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return so();
}

TEST(ThreadedBase, PassesAllOn) {
  const auto says = std::make_shared<Says>();
  {
    ThreadedBase base(std::make_shared<SayingBase>(says), 0);
    EXPECT_EQ(base.name(), "says");
    EXPECT_EQ(base.dead_man(), 0.5);
    std::size_t wheels = 0;
    EXPECT_TRUE(soon([&] {
      const BaseReport report = base.report();
      wheels += report.wheels.size();
      return report.connected && wheels >= 3 && report.faults.empty();
    }));
    base.send({}, 1e9);
    EXPECT_TRUE(soon([&] { return says->sent == 1; }));
    base.stop();
  }
  EXPECT_EQ(says->stopped, 1) << "what was ordered before the end is done";
}

TEST(ThreadedBase, WhatIsThrownIsToldAndOverWhenItGoesWellAgain) {
  const auto says = std::make_shared<Says>();
  std::atomic<bool> bad{true};
  says->send = [&] {
    if (bad) throw std::runtime_error("no motors");
  };
  ThreadedBase base(std::make_shared<SayingBase>(says), 0);
  base.send({}, 1e9);
  EXPECT_TRUE(soon([&] {
    const BaseReport report = base.report();
    return report.connected &&
           report.faults == std::vector<std::string>{"its driver failed in send(): no motors"};
  }));
  bad = false;
  EXPECT_TRUE(soon([&] {
    base.send({}, 1e9);
    return base.report().faults.empty();
  }));
}

TEST(ThreadedBase, ADriverThatDoesNotReturnIsAFaultAndHoldsNobodyUp) {
  const SteadyClock clock;
  for (const bool in_send : {true, false}) {
    const auto says = std::make_shared<Says>();
    // The test's own wait is for a machine that is busy; the driver's never ends by itself.
    const auto hang = [s = says.get()] {
      s->hangs = true;
      while (s->hang) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    };
    (in_send ? says->send : says->report) = hang;
    double ended = 0.0;
    {
      ThreadedBase base(std::make_shared<SayingBase>(says), 0);
      in_send ? base.send({}, 1e9) : static_cast<void>(base.report());
      ASSERT_TRUE(soon([&] { return says->hangs.load(); }));
      const double before = clock.now();
      for (int k = 0; k < 100; ++k) base.send({}, 1e9);
      base.stop();
      EXPECT_LT(clock.now() - before, 0.4);
      std::string fault;
      EXPECT_TRUE(soon([&] {
        const BaseReport report = base.report();
        if (!report.faults.empty()) fault = report.faults.front();
        return !fault.empty();
      }));
      EXPECT_THAT(fault, HasSubstr(std::string("its driver has not returned from ") +
                                   (in_send ? "send" : "report") + "() for 0."));
      ended = clock.now();
    }
    EXPECT_LT(clock.now() - ended, ForeignThread::kPatience + 5.0) << "it is left";
    EXPECT_EQ(says->stopped, 0);
    says->hang = false;
    EXPECT_TRUE(soon([&] { return says.use_count() == 1; }));
  }
}

}  // namespace
}  // namespace prospect::threaded_base_test
