// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/bounded_child.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect::bounded_child_test {
namespace {

using ::testing::HasSubstr;

/// The one line that running this gives.
std::string refusal(const std::function<std::string()>& work, const ChildLimits& limits = {}) {
  try {
    run_in_child("a.dae", work, limits);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  ADD_FAILURE() << "it went well";
  return "";
}

int recurse(int n) {
  volatile char frame[4096];
  frame[0] = static_cast<char>(n);
  return n == 0 ? 0 : recurse(n - 1) + frame[0];
}

TEST(BoundedChild, HandsBackWhatTheWorkReturns) {
  EXPECT_EQ(run_in_child("a", [] { return std::string(); }, {}), "");
  const std::string large(10'000'000, '\0');
  EXPECT_EQ(run_in_child("a", [&] { return large + "x"; }, {}), large + "x");
  int touched = 0;  // in the child only
  EXPECT_EQ(run_in_child("a", [&] { return std::to_string(++touched); }, {}), "1");
  EXPECT_EQ(touched, 0);
}

TEST(BoundedChild, SaysWhatItThrows) {
  EXPECT_EQ(refusal([]() -> std::string { throw InputError("b.obj:3: wrong; expected right"); }),
            "b.obj:3: wrong; expected right");
  EXPECT_EQ(refusal([]() -> std::string { throw std::runtime_error("two\nlines"); }),
            "a.dae: cannot be read (two lines); expected a sound file");
  EXPECT_THAT(refusal([]() -> std::string { throw 7; }), HasSubstr("cannot be read"));
}

TEST(BoundedChild, CrashesAreALine) {
  EXPECT_THAT(refusal([]() -> std::string { std::abort(); }), HasSubstr("the reader crashed"));
  EXPECT_THAT(refusal([]() -> std::string { std::_Exit(0); }), HasSubstr("the reader crashed"));
  EXPECT_THAT(refusal([] { return std::to_string(recurse(1'000'000'000)); }),
              HasSubstr("the reader crashed"));
}

TEST(BoundedChild, TimeAndMemoryAreBounded) {
  const auto start = std::chrono::steady_clock::now();
  ChildLimits limits;
  limits.seconds = 0.3;
  EXPECT_THAT(refusal(
                  [] {
                    for (volatile bool on = true; on;) {
                    }
                    return std::string();
                  },
                  limits),
              HasSubstr("takes more than 0.3 s"));
  limits = {};
  limits.memory = std::size_t{100} << 20;
  EXPECT_THAT(refusal(
                  [] {
                    std::vector<std::unique_ptr<char[]>> all;
                    for (;;) {
                      constexpr std::size_t kSize = std::size_t{1} << 20;
                      all.push_back(std::make_unique<char[]>(kSize));
                      std::memset(all.back().get(), 1, kSize);
                    }
                    return std::string();
                  },
                  limits),
              HasSubstr("takes more than 100 MB"));
  limits = {};
  limits.result = 1000;
  EXPECT_THAT(refusal([] { return std::string(100'000, 'x'); }, limits),
              HasSubstr("takes more than"));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 30.0);
}

// Ctrl-Z, a paused container, a machine with too much to do.
TEST(BoundedChild, TimeInWhichItDoesNotComputeIsNotCounted) {
  void* shared = ::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  auto& child = *new (shared) std::atomic<int>(0);
  ChildLimits limits;
  limits.seconds = 0.1;
  const auto work = [&] {
    child = ::getpid();
    ::raise(SIGSTOP);
    return std::string("done");
  };
  double waited = 0.0;
  const auto goes_on = [&](double seconds) {
    waited = seconds;
    if (child > 0 && seconds > 5.0 * limits.seconds) ::kill(child, SIGCONT);
  };
  EXPECT_EQ(run_in_child("a.dae", work, limits, goes_on), "done");
  EXPECT_GT(waited, 5.0 * limits.seconds);
  ::munmap(shared, sizeof(std::atomic<int>));

  // But one that sleeps, as on a file that never comes, ends.
  EXPECT_THAT(refusal(
                  [] {
                    ::sleep(20);
                    return std::string();
                  },
                  limits),
              HasSubstr("takes more than 0.1 s"));
}

}  // namespace
}  // namespace prospect::bounded_child_test
