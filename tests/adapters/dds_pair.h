// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "adapters/robots/dds/dds_node.h"

namespace prospect::test {

/// This machine alone, and a domain that no other test that runs now is likely to have. Its ports
/// lie below those that the system gives away.
inline DdsAddress dds_test_address(const std::string& node = "test") {
  DdsAddress address;
  address.domain = 1 + static_cast<int>(getpid() % 90);
  address.node = node;
  address.loopback = true;
  return address;
}

/// Whether it becomes true within so many seconds, while `again` is called every 10 ms.
template <typename Test, typename Again>
bool within(double seconds, const Test& test, const Again& again) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!test()) {
    if (std::chrono::steady_clock::now() > end) return false;
    again();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}
template <typename Test>
bool within(double seconds, const Test& test) {
  return within(seconds, test, [] {});
}
/// [s] of a machine that is busy.
inline constexpr double kPatience = 20.0;

}  // namespace prospect::test
