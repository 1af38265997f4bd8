// SPDX-License-Identifier: Apache-2.0
#include "runtime/simulation_clock.h"

#include <algorithm>
#include <cmath>

namespace prospect {

SimulationClock::SimulationClock(const Clock& machine) noexcept
    : machine_(machine), arrival_(machine.now()) {}

void SimulationClock::tick(double stamp) noexcept {
  const std::lock_guard lock(mutex_);
  if (!std::isfinite(stamp) || (ticked_ && stamp <= stamp_)) return;
  constexpr double kLeap = 1.0, kFastest = 10.0;  // [s] and [s/s] that need nobody who agrees
  const auto leaps = [&](double from) {
    return stamp - from > kLeap + kFastest * (machine_.now() - arrival_);
  };
  if (ticked_ && leaps(stamp_) && (!leapt_ || stamp < *leapt_ || leaps(*leapt_))) {
    leapt_ = stamp;
    return;
  }
  leapt_.reset();
  constexpr double kCounted = 0.5;  // [s]
  stamp_ = stamp;
  arrival_ = machine_.now();
  const double counted = arrival_ - rate_arrival_;
  if (!ticked_ || counted >= kCounted) {
    if (ticked_) rate_ = std::clamp((stamp - rate_stamp_) / counted, 0.0, 1.0);
    rate_stamp_ = stamp;
    rate_arrival_ = arrival_;
  }
  ticked_ = true;
}

double SimulationClock::now() const noexcept {
  const std::lock_guard lock(mutex_);
  const double since = machine_.now() - arrival_;
  const double ahead = ticked_ ? std::min(rate_ * since, kAhead) + std::max(0.0, since - kLost)
                               : std::max(0.0, since);
  newest_ = std::max(newest_, stamp_ + ahead);
  return newest_;
}

bool SimulationClock::wait_until(double time, const std::stop_token& stop) const noexcept {
  constexpr double kLeast = 0.001, kMost = 0.01;  // [s] between two looks
  for (;;) {
    if (stop.stop_requested()) return false;
    const double left = time - now();
    if (!(left > 0.0)) return true;
    if (!machine_.wait_until(machine_.now() + std::clamp(left, kLeast, kMost), stop)) return false;
  }
}

}  // namespace prospect
