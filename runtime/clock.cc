// SPDX-License-Identifier: Apache-2.0
#include "runtime/clock.h"

#include <cmath>

namespace prospect {
namespace {

using Steady = std::chrono::steady_clock;

// Farther ahead than any wait, and within what the system's clock can be told.
constexpr double kFarAhead = 1e8;  // [s]

}  // namespace

double SteadyClock::seconds(Steady::time_point time) noexcept {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

double SteadyClock::now() const noexcept { return seconds(Steady::now()); }

bool SteadyClock::wait_until(double time, const std::stop_token& stop) const noexcept {
  // A condition of its own for each wait: nobody but the stop request notifies it.
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  while (true) {
    if (stop.stop_requested()) return false;
    const double left = time - now();
    if (!(left > 0.0)) return true;
    const auto wait = std::chrono::duration_cast<Steady::duration>(
                          std::chrono::duration<double>(left < kFarAhead ? left : kFarAhead)) +
                      Steady::duration(1);
    never.wait_until(lock, stop, Steady::now() + wait, [] { return false; });
  }
}

double ManualClock::now() const noexcept {
  const std::lock_guard lock(mutex_);
  return now_;
}

bool ManualClock::wait_until(double time, const std::stop_token& stop) const noexcept {
  std::unique_lock lock(mutex_);
  const auto come = [&] { return !(now_ < time); };
  return changed_.wait(lock, stop, come);
}

void ManualClock::set(double time) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (!std::isfinite(time) || time <= now_) return;
    now_ = time;
  }
  changed_.notify_all();
}

void ManualClock::advance(double seconds) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (!std::isfinite(seconds) || seconds <= 0.0) return;
    now_ += seconds;
  }
  changed_.notify_all();
}

}  // namespace prospect
