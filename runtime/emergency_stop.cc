// SPDX-License-Identifier: Apache-2.0
#include "runtime/emergency_stop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "models/formatted.h"

namespace prospect {
namespace {

constexpr double kMoment = 0.2;  // [s] that a look may miss who is there

}  // namespace

EmergencyStopInput::EmergencyStopInput(std::string name, const EmergencyStopContract& contract)
    : name_(std::move(name)), contract_(contract) {
  if (contract.publishers < 1 || !(contract.max_age > 0.0) || !std::isfinite(contract.max_age)) {
    throw std::invalid_argument(
        "emergency stop " + name_ +
        formatted(": %d publishers, each %g s old at most; expected one or more, and a finite time "
                  "above 0",
                  contract.publishers, contract.max_age));
  }
}

void EmergencyStopInput::told(std::uint64_t publisher, bool pressed, double now) {
  constexpr std::size_t kMost = 100;
  const std::lock_guard lock(mutex_);
  // Who has gone for long makes room.
  if (words_.size() == kMost && !words_.contains(publisher)) {
    words_.erase(std::min_element(words_.begin(), words_.end(), [](const auto& a, const auto& b) {
      return a.second.stamp < b.second.stamp;
    }));
  }
  words_[publisher] = {now, pressed};
}

void EmergencyStopInput::set_present(std::span<const std::uint64_t> publishers, double now) {
  const std::lock_guard lock(mutex_);
  std::erase_if(present_, [&](const auto& one) { return now - one.second > kMoment; });
  for (const std::uint64_t publisher : publishers) present_[publisher] = now;
}

EmergencyStopState EmergencyStopInput::state(double now) const {
  EmergencyStopState state;
  int there = 0;
  double newest = -HUGE_VAL;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [publisher, word] : words_) {
      newest = std::max(newest, word.stamp);
      const auto seen = present_.find(publisher);
      const bool is_there = contract_.latched
                                ? seen != present_.end() && now - seen->second <= kMoment
                                : now - word.stamp <= contract_.max_age;
      if (!is_there) continue;
      ++there;
      state.pressed = state.pressed || word.pressed;
    }
  }
  if (there >= contract_.publishers) return state;
  state.silent = name_ + formatted(": %d of %d publishers", there, contract_.publishers);
  if (contract_.latched) {
    state.silent += " are there and have said whether it is pressed";
  } else if (std::isfinite(newest)) {
    state.silent += formatted(
        " say whether it is pressed, the newest word is %.2f s old; expected "
        "%g s at most",
        now - newest, contract_.max_age);
  } else {
    state.silent +=
        formatted(" say whether it is pressed; expected a word each %g s", contract_.max_age);
  }
  return state;
}

}  // namespace prospect
