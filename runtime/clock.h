// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace prospect {

/// The clock of everything in the runtime: seconds that only go on. It is no time of day, and its
/// zero is arbitrary. Stamps of beliefs, plans and commands are readings of it.
///
/// Thread-safety: any thread. Nothing here throws.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual double now() const noexcept = 0;  ///< [s]

  /// Waits until now() >= time. True: that time has come. False: `stop` was requested before. A
  /// time that is not a number has come; an infinite one comes never.
  virtual bool wait_until(double time, const std::stop_token& stop) const noexcept = 0;
};

/// The machine's monotonic clock (CLOCK_MONOTONIC): steps of the time of day do not touch it. All
/// objects, of all processes of a machine, have the same time. It may stand still while the machine
/// sleeps.
class SteadyClock final : public Clock {
 public:
  double now() const noexcept override;
  bool wait_until(double time, const std::stop_token& stop) const noexcept override;

  /// The reading that belongs to a time of the same clock.
  static double seconds(std::chrono::steady_clock::time_point time) noexcept;
};

/// A clock that is set by hand, for tests: it stands still in between.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(double start = 0.0) : now_(start) {}
  double now() const noexcept override;
  bool wait_until(double time, const std::stop_token& stop) const noexcept override;

  /// Goes on to `time`, and wakes who has waited for it. An earlier time or one that is not finite
  /// leaves the clock as it is.
  void set(double time) noexcept;
  void advance(double seconds) noexcept;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  double now_;
};

}  // namespace prospect
