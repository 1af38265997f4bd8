// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "engine/support/resumable.h"

namespace prospect {

/// The newest whole result of a computation that is asked for again and again and may take longer
/// than there is time. What is not done when the time is up is continued at the next call; until
/// then the last whole result serves, and stamp() says of when it is.
///
/// Thread-safety: one caller at a time.
template <typename T>
class Resumed {
 public:
  using Clock = Resumable::Clock;

  /// Goes on with what is under way; then, if there is time left or nothing was, begins
  /// make(pause), T(const PausePoint&), anew, of what is at `stamp` [s]. Clock::time_point::max():
  /// all of it, in the caller's thread. Returns whether newest() is what this call began. Passes on
  /// what `make` throws.
  template <typename Make>
  bool update(double stamp, const Make& make, Clock::time_point until) {
    if (work_.busy()) {
      go_on(until);
      if (work_.busy() || Clock::now() >= until) return false;
    }
    next_stamp_ = stamp;
    if (until == Clock::time_point::max()) {
      newest_ = make(PausePoint());
      stamp_ = stamp;
      return true;
    }
    work_.begin([this, make](const PausePoint& pause) { next_.emplace(make(pause)); });
    return go_on(until);
  }
  /// Goes on with what is under way. Returns whether newest() is another now. Passes on what it
  /// throws.
  bool go_on(Clock::time_point until) {
    if (!work_.busy()) return false;
    try {
      if (!work_.run_until(until)) return false;
    } catch (...) {
      unwanted_ = false;
      throw;
    }
    const bool wanted = !std::exchange(unwanted_, false);
    if (wanted) {
      newest_ = std::move(next_);
      stamp_ = next_stamp_;
    }
    next_.reset();
    return wanted;
  }

  const std::optional<T>& newest() const { return newest_; }
  /// Of newest() [s]; there is one.
  double stamp() const { return stamp_; }
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
  std::optional<T> newest_, next_;
  double stamp_ = 0.0, next_stamp_ = 0.0;
  bool unwanted_ = false;  // what is under way
  Resumable work_;         // last: it is unwound first
};

}  // namespace prospect
