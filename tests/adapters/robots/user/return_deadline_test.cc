// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/return_deadline.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "adapters/program/cli/command_line.h"

namespace prospect::return_deadline_test {
namespace {

void sleep_long() { std::this_thread::sleep_for(std::chrono::seconds(60)); }

// A plug-in whose entry hung was ended by a signal alone.
TEST(ReturnDeadlineDeathTest, CodeOfOthersThatDoesNotComeBackEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto hang = [](const std::string&, const PluginTargets&) -> std::string {
    sleep_long();
    return "";
  };
  EXPECT_EXIT(
      {
        Registries registries;
        load_plugins({"lib.so"}, hang, registries, 0.1);
      },
      testing::ExitedWithCode(1),
      "^prospect: plug-in 'lib.so': its entry has not returned for 0.1 s; expected it to\n$");
  EXPECT_EXIT(
      {
        const ReturnDeadline deadline("mine: make()", 0.1);
        sleep_long();
      },
      testing::ExitedWithCode(1), "mine: make\\(\\) has not returned");
  Registries registries;
  load_plugins(
      {"lib.so"}, [](const auto&, const auto&) { return std::string(); }, registries, 5.0);
}

}  // namespace
}  // namespace prospect::return_deadline_test
