#include "engine/behaviour/monitors/low_yield_monitor.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace prospect::low_yield_monitor_test {
namespace {

constexpr LowYieldMonitor::Options kOptions{.share = 0.7, .least = 60.0, .growth = 0.1};

/// When it is up, in steps of 0.5 s, if it begins at `begin`; explored(t) [m^2].
template <typename Explored>
double end_of(double begin, Explored explored) {
  LowYieldMonitor clock(kOptions);
  for (double t = 0.0; t < 1000.0; t += 0.5) {
    clock.update(t, explored(t));
    if (t >= begin) clock.begin(t, explored(t));
    if (clock.up(t)) return t;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(LowYieldMonitor, IsUpAfterAShareOfTheTimeBeforeOrTheLeastTime) {
  const auto explored = [](double) { return 100.0; };
  EXPECT_EQ(end_of(10.0, explored), 70.5);
  EXPECT_EQ(end_of(200.0, explored), 340.5);
}

TEST(LowYieldMonitor, IsNeverUpBeforeItBegins) {
  LowYieldMonitor clock(kOptions);
  EXPECT_FALSE(clock.up(1e9));
  EXPECT_FALSE(clock.update(0.0, 1.0));
  EXPECT_FALSE(clock.up(1e9));
  EXPECT_FALSE(clock.update(1.0, 100.0)) << "growth counts from the beginning on";
}

TEST(LowYieldMonitor, BeginsAnewWithATenthMore) {
  const auto grows_to = [](double area) {
    return [area](double t) { return t < 50.0 ? 100.0 : area; };
  };
  EXPECT_EQ(end_of(10.0, grows_to(109.0)), 70.5);
  EXPECT_EQ(end_of(10.0, grows_to(110.5)), 110.5);
  // A tenth of what there was then.
  EXPECT_EQ(end_of(10.0, [](double t) { return t < 50.0   ? 100.0
                                               : t < 60.0 ? 111.0
                                                          : 120.0; }),
            110.5);
  // It never ends earlier than it would have.
  EXPECT_EQ(end_of(200.0, [](double t) { return t < 210.0 ? 100.0 : 111.0; }), 340.5);
}

TEST(LowYieldMonitor, OptionsOutOfRangeAreNamed) {
  for (const LowYieldMonitor::Options& bad :
       {LowYieldMonitor::Options{.share = -0.1}, LowYieldMonitor::Options{.least = 2e6},
        LowYieldMonitor::Options{.growth = std::numeric_limits<double>::quiet_NaN()}}) {
    EXPECT_THROW(LowYieldMonitor{bad}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect::low_yield_monitor_test
