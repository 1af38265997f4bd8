// SPDX-License-Identifier: Apache-2.0
#include "runtime/emergency_stop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace prospect::emergency_stop_test {
namespace {

using ::testing::HasSubstr;

TEST(EmergencyStop, NobodyHasSaidAnything) {
  const EmergencyStopInput stop("/stop");
  EXPECT_FALSE(stop.state(10.0).pressed);
  EXPECT_THAT(stop.state(10.0).silent, HasSubstr("/stop: 0 of 1 publishers"));
}

TEST(EmergencyStop, AWordCountsForItsTime) {
  EmergencyStopInput stop("/stop", {.max_age = 0.5});
  stop.told(1, false, 10.0);
  EXPECT_EQ(stop.state(10.5).silent, "");
  EXPECT_THAT(stop.state(10.6).silent, HasSubstr("0.60 s old; expected 0.5 s at most"));
  stop.told(1, true, 11.0);
  EXPECT_TRUE(stop.state(11.1).pressed);
  stop.told(1, false, 11.2);
  EXPECT_FALSE(stop.state(11.3).pressed);
  EXPECT_EQ(stop.state(11.3).silent, "");
}

TEST(EmergencyStop, EachOfSeveralMustBeThereAndAnyPresses) {
  EmergencyStopInput stop("/stop", {.publishers = 2, .max_age = 0.5});
  stop.told(1, false, 10.0);
  stop.told(1, false, 10.1);
  EXPECT_THAT(stop.state(10.1).silent, HasSubstr("1 of 2")) << "one that says it twice is one";
  stop.told(2, true, 10.1);
  EXPECT_EQ(stop.state(10.2).silent, "");
  EXPECT_TRUE(stop.state(10.2).pressed);
  stop.told(1, false, 10.3);
  EXPECT_TRUE(stop.state(10.3).pressed) << "another's word does not release it";
  stop.told(1, false, 10.6);
  EXPECT_THAT(stop.state(10.7).silent, HasSubstr("1 of 2")) << "the second has died";
}

TEST(EmergencyStop, ALatchedOneIsThereAsLongAsItsPublisherIs) {
  EmergencyStopInput stop("/stop", {.latched = true});
  stop.told(7, false, 10.0);
  EXPECT_THAT(stop.state(10.0).silent, HasSubstr("0 of 1")) << "nobody has said who is there";
  const std::array<std::uint64_t, 2> both = {7, 8};
  stop.set_present(both, 1000.0);
  EXPECT_EQ(stop.state(1000.0).silent, "") << "its word is old, it is there";
  stop.set_present({}, 1000.1);
  EXPECT_EQ(stop.state(1000.1).silent, "") << "one look that misses it decides nothing";
  stop.set_present({}, 1000.3);
  EXPECT_THAT(stop.state(1000.3).silent, HasSubstr("0 of 1"));
  stop.told(8, true, 1001.0);
  stop.set_present(both, 1002.0);
  EXPECT_TRUE(stop.state(1002.0).pressed);
  EXPECT_THAT(stop.state(1003.0).silent, HasSubstr("0 of 1")) << "nobody looks any more";
}

TEST(EmergencyStop, ThousandsOfPublishersCostNothing) {
  EmergencyStopInput stop("/stop");
  for (std::uint64_t k = 0; k < 5000; ++k) stop.told(k, false, 1e-3 * static_cast<double>(k));
  EXPECT_EQ(stop.state(5.0).silent, "");
}

TEST(EmergencyStop, WhatCannotBeKeptWatchOverIsRefused) {
  for (const EmergencyStopContract& contract :
       {EmergencyStopContract{.publishers = 0}, EmergencyStopContract{.max_age = 0.0},
        EmergencyStopContract{.max_age = INFINITY}, EmergencyStopContract{.max_age = NAN}}) {
    EXPECT_THROW(EmergencyStopInput("/stop", contract), std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect::emergency_stop_test
