// SPDX-License-Identifier: Apache-2.0
#include "engine/support/worker_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace prospect::worker_threads_test {
namespace {

TEST(WorkerThreads, MakesEveryCallOnceHoweverOften) {
  for (const int threads : {1, 2, 3, 8}) {
    WorkerThreads workers(threads);
    // Many short rounds: threads that wake up late must find nothing to do.
    for (int round = 0; round < 2000; ++round) {
      const int count = round % 11;
      std::vector<int> calls(static_cast<std::size_t>(count), 0);
      workers.run(count, [&](int k) { calls[static_cast<std::size_t>(k)] += k + 1; });
      for (int k = 0; k < count; ++k) ASSERT_EQ(calls[static_cast<std::size_t>(k)], k + 1);
    }
  }
}

TEST(WorkerThreads, WorkInSeveralThreadsAtOnce) {
  WorkerThreads workers(3);
  // Three calls that wait for each other end only if each has a thread of its own.
  std::atomic<int> here{0};
  std::vector<std::thread::id> ids(3);
  workers.run(3, [&](int k) {
    ids[static_cast<std::size_t>(k)] = std::this_thread::get_id();
    ++here;
    while (here < 3) std::this_thread::yield();
  });
  EXPECT_EQ(std::set(ids.begin(), ids.end()).size(), 3u);
}

TEST(WorkerThreads, OneThreadIsTheCallers) {
  WorkerThreads workers(1);
  std::vector<std::thread::id> ids;
  workers.run(3, [&](int) { ids.push_back(std::this_thread::get_id()); });
  EXPECT_EQ(ids, std::vector<std::thread::id>(3, std::this_thread::get_id()));
  EXPECT_THROW(WorkerThreads(0), std::invalid_argument);
}

TEST(WorkerThreads, WhatTheFirstCallsThrowIsThrown) {
  for (const int threads : {1, 2, 3}) {
    WorkerThreads workers(threads);
    for (int round = 0; round < 100; ++round) {
      try {
        workers.run(8, [](int k) {
          if (k % 3 == 2) throw std::runtime_error(std::to_string(k));
        });
        ADD_FAILURE() << "nothing was thrown";
      } catch (const std::runtime_error& e) {
        EXPECT_STREQ(e.what(), "2");
      }
      int calls = 0;
      workers.run(1, [&](int) { ++calls; });
      EXPECT_EQ(calls, 1) << "what was thrown is forgotten";
    }
  }
}

}  // namespace
}  // namespace prospect::worker_threads_test
