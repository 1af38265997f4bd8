#pragma once

#include <optional>
#include <utility>

#include "engine/support/resumable.h"

namespace prospect {

/// The newest whole result of a computation that is asked for again and again and may take longer
/// than there is time. What is not done when the time is up is continued at the next call; until
/// then the last whole result serves.
///
/// Thread-safety: one caller at a time.
template <typename T>
class Resumed {
 public:
  using Clock = Resumable::Clock;

  /// Goes on with what is under way; then, if there is time left or nothing was, begins
  /// make(pause), T(const PausePoint&), anew. Clock::time_point::max(): all of it, in the caller's
  /// thread. Returns whether newest() is what this call began. Passes on what `make` throws.
  template <typename Make>
  bool update(const Make& make, Clock::time_point until) {
    if (work_.busy()) {
      go_on(until);
      if (work_.busy() || Clock::now() >= until) return false;
    }
    if (until == Clock::time_point::max()) {
      newest_ = make(PausePoint());
      return true;
    }
    work_.begin([this, make](const PausePoint& pause) { next_.emplace(make(pause)); });
    return go_on(until);
  }

  const std::optional<T>& newest() const { return newest_; }
  bool busy() const { return work_.busy(); }
  /// There is no newest one any more, and what is under way will be none.
  void forget() {
    newest_.reset();
    unwanted_ = work_.busy();
  }
  /// The same, and what is under way is unwound.
  void give_up() {
    work_.give_up();
    next_.reset();
    forget();
  }

 private:
  bool go_on(Clock::time_point until) {
    if (!work_.run_until(until)) return false;
    if (!std::exchange(unwanted_, false)) newest_ = std::move(next_);
    next_.reset();
    return true;
  }

  std::optional<T> newest_, next_;
  bool unwanted_ = false;  // what is under way
  Resumable work_;         // last: it is unwound first
};

}  // namespace prospect
