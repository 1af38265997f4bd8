// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <list>
#include <mutex>

#include "runtime/clock.h"

namespace prospect {

/// The clock of threads that are simulated together. It stands still while any of them computes,
/// and goes on, to the earliest time that one of them waits for, once all of them wait. So what
/// they compute takes no time, and a minute passes as fast as the machine computes it.
///
/// One thread is woken at a time; of those that wait for the same time, the one that began to wait
/// first. So from the first time that all wait, their order is always the same; which one that is,
/// until_waited_for() lets a thread decide that begins after others.
///
/// A thread that waits for anything else than this clock holds it up. Thread-safety: any thread,
/// but at most `threads` of them wait at once.
class SimulatedClock final : public Clock {
 public:
  /// threads: how many wait on it, >= 1.
  explicit SimulatedClock(int threads, double start = 0.0) : threads_(threads), now_(start) {}
  double now() const noexcept override;
  bool wait_until(double time, const std::stop_token& stop) const noexcept override;
  /// Returns once that many threads wait on it, fewer than all: who waits afterwards comes after
  /// them. Takes no time of this clock.
  void until_waited_for(int threads) const noexcept;

 private:
  struct Waiter {
    double time;
    bool woken = false;
  };
  /// Under the lock.
  void go_on() const noexcept;

  const int threads_;
  mutable std::mutex mutex_;
  mutable std::condition_variable_any woken_;
  mutable double now_;
  mutable std::list<Waiter*> waiting_;  // in order of arrival
};

}  // namespace prospect
