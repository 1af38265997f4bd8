// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/localization_monitor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::localization_monitor_test {
namespace {

TEST(LocalizationMonitor, SaysForHowLongAndWhenItGotLost) {
  LocalizationMonitor monitor;
  monitor.update(1.0, Localization::kLost);
  EXPECT_TRUE(monitor.got_lost());
  EXPECT_TRUE(std::isinf(monitor.lost_for())) << "it never was localized";
  monitor.update(2.0, Localization::kDegraded);
  EXPECT_FALSE(monitor.got_lost());
  EXPECT_EQ(monitor.lost_for(), 0.0);
  monitor.update(2.5, Localization::kLost);
  EXPECT_TRUE(monitor.got_lost());
  EXPECT_EQ(monitor.lost_for(), 0.5);
  monitor.update(4.0, Localization::kLost);
  EXPECT_FALSE(monitor.got_lost());
  EXPECT_EQ(monitor.lost_for(), 2.0);
}

}  // namespace
}  // namespace prospect::localization_monitor_test
