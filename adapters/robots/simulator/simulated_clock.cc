// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_clock.h"

#include <algorithm>

namespace prospect {

double SimulatedClock::now() const noexcept {
  const std::lock_guard lock(mutex_);
  return now_;
}

void SimulatedClock::go_on() const noexcept {
  if (static_cast<int>(waiting_.size()) < threads_) return;
  const auto earliest =
      std::min_element(waiting_.begin(), waiting_.end(),
                       [](const Waiter* a, const Waiter* b) { return a->time < b->time; });
  Waiter* const next = *earliest;
  waiting_.erase(earliest);
  now_ = std::max(now_, next->time);
  next->woken = true;
  woken_.notify_all();
}

bool SimulatedClock::wait_until(double time, const std::stop_token& stop) const noexcept {
  std::unique_lock lock(mutex_);
  if (stop.stop_requested()) return false;
  if (!(time > now_)) return true;
  Waiter own{time};
  waiting_.push_back(&own);
  woken_.notify_all();
  go_on();
  if (woken_.wait(lock, stop, [&] { return own.woken; })) return true;
  waiting_.remove(&own);
  return false;
}

void SimulatedClock::until_waited_for(int threads) const noexcept {
  std::unique_lock lock(mutex_);
  woken_.wait(lock, [&] { return static_cast<int>(waiting_.size()) >= threads; });
}

}  // namespace prospect
