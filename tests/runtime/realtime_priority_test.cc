// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime_priority.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

namespace prospect::realtime_priority_test {
namespace {

int policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }

TEST(RealtimePriority, HoldsForItsThreadAloneAndItsTimeOrSaysWhyNot) {
  const int before = policy();
  {
    const RealtimePriority own(5);
    int of_another = -1;
    std::thread([&] { of_another = policy(); }).join();
    EXPECT_EQ(of_another, before);
    if (own.problem().empty()) {
      EXPECT_EQ(policy(), SCHED_FIFO);
      sched_param now{};
      sched_getparam(0, &now);
      EXPECT_EQ(now.sched_priority, 5);
    } else {
      EXPECT_EQ(policy(), before);
      EXPECT_NE(own.problem().find("SCHED_FIFO is refused"), std::string::npos);
    }
  }
  EXPECT_EQ(policy(), before);
  {
    const RealtimePriority all(5, RealtimePriority::Started::kLikewise);
    int of_another = -1;
    std::thread([&] { of_another = policy(); }).join();
    EXPECT_EQ(of_another, policy());
  }
  EXPECT_EQ(policy(), before);
  EXPECT_EQ(RealtimePriority(0).problem(), "") << "not asked for";
  EXPECT_EQ(policy(), before);
  EXPECT_NE(RealtimePriority(1000).problem(), "") << "there is no such priority";
}

}  // namespace
}  // namespace prospect::realtime_priority_test
