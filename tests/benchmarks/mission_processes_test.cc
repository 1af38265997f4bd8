// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/mission_processes.h"

#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <stdexcept>

namespace prospect::mission_processes_test {
namespace {

TEST(MissionProcesses, OneThatCrashesOrThrowsCostsOnlyItself) {
  std::map<std::size_t, ProcessEnd> ends;
  run_in_processes(
      5, 2,
      [](std::size_t i) {
        if (i == 1) std::raise(SIGKILL);
        if (i == 3) throw std::runtime_error("as expected by the test");
      },
      [&](std::size_t i, const ProcessEnd& end) { EXPECT_TRUE(ends.emplace(i, end).second); });
  ASSERT_EQ(ends.size(), 5U);
  for (const auto& [i, end] : ends) {
    EXPECT_EQ(end.signal, i == 1 ? SIGKILL : 0) << i;
    EXPECT_EQ(end.threw, i == 3) << i;
  }
}

}  // namespace
}  // namespace prospect::mission_processes_test
