// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

// Of the libraries of sanitizers; null in a program that is not linked against them. It is asked
// when a test runs, not when it is compiled: both builds may share its object
// (tests/CMakeLists.txt).
extern "C" {
void __asan_init() __attribute__((weak));
void __tsan_init() __attribute__((weak));
}

namespace prospect::test {
inline bool under_address_sanitizer() { return &__asan_init != nullptr; }
inline bool under_sanitizers() { return under_address_sanitizer() || &__tsan_init != nullptr; }
}  // namespace prospect::test

/// Skips a test under AddressSanitizer, and says why: what it runs others run as well, in less
/// time.
#define NOT_UNDER_SANITIZERS(why) \
  if (prospect::test::under_address_sanitizer()) GTEST_SKIP() << (why)
