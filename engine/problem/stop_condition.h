// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

namespace prospect {

enum class StopRequest { kNone, kDeadline, kCancelled };

/// By what the time of a solve is counted.
enum class SolveClock {
  kWall,      ///< steady time: what a robot has
  kProcessor  ///< processor time of all threads of the process: the same beside other work
};

/// By that clock, from some origin. [s]
inline double seconds_by(SolveClock clock) {
  timespec t{};
  clock_gettime(clock == SolveClock::kWall ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// When a solve must end: a small value that is asked inside the evaluator, before every
/// evaluation. Composable: `deadline(...) || cancelled(...)` stops as soon as either does.
///
/// Thread-safety: operator() may be called from any thread if the wrapped function may.
class StopCondition {
 public:
  using Function = std::function<StopRequest()>;
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// Never stops.
  StopCondition() = default;
  /// latest: when it will ask to stop at the latest, seconds_by(clock), if that is known.
  explicit StopCondition(Function ask, double latest = kNever, SolveClock clock = SolveClock::kWall)
      : ask_(std::move(ask)), latest_(latest), clock_(clock) {}

  StopRequest operator()() const { return ask_ ? ask_() : StopRequest::kNone; }
  /// Time until it stops at the latest, by its clock [s]; infinite if it may never. For those who
  /// share out the time they have.
  double left() const { return latest_ == kNever ? kNever : latest_ - seconds_by(clock_); }
  /// When that is, seconds_by(clock()).
  double latest() const { return latest_; }
  /// By which the time of the solve is told, too.
  SolveClock clock() const { return clock_; }

  friend StopCondition operator||(StopCondition a, StopCondition b) {
    if (!a.ask_) return b;
    if (!b.ask_) return a;
    const bool first = a.left() <= b.left();
    const double latest = first ? a.latest_ : b.latest_;
    const SolveClock clock = first ? a.clock_ : b.clock_;
    return StopCondition(
        [a = std::move(a.ask_), b = std::move(b.ask_)] {
          const StopRequest first = a();
          return first != StopRequest::kNone ? first : b();
        },
        latest, clock);
  }

 private:
  Function ask_;
  double latest_ = kNever;
  SolveClock clock_ = SolveClock::kWall;
};

/// Stops once `seconds` have passed by that clock since this call. Infinite: never. Not a number,
/// zero or less: at once.
inline StopCondition deadline(double seconds, SolveClock clock = SolveClock::kWall) {
  const double now = seconds_by(clock);
  if (!(seconds > 0.0)) {
    return StopCondition([] { return StopRequest::kDeadline; }, now, clock);
  }
  // Of lifetimes nothing but the clock is left.
  const double end = seconds >= 1e9 ? StopCondition::kNever : now + seconds;
  return StopCondition(
      [end, clock] {
        return seconds_by(clock) >= end ? StopRequest::kDeadline : StopRequest::kNone;
      },
      end, clock);
}

/// Stops once `flag()` is true (e.g. reads an atomic). An empty function: never.
inline StopCondition cancelled_by(std::function<bool()> flag) {
  if (!flag) return {};
  return StopCondition(
      [flag = std::move(flag)] { return flag() ? StopRequest::kCancelled : StopRequest::kNone; });
}

/// Asks `stop`, which must outlive it, from one thread at a time, and never again once it has asked
/// to stop: for what runs on several threads with a function that knows of none.
inline StopCondition one_at_a_time(const StopCondition& stop) {
  struct State {
    std::mutex mutex;
    StopRequest answer = StopRequest::kNone;
  };
  return StopCondition(
      [&stop, state = std::make_shared<State>()] {
        const std::lock_guard lock(state->mutex);
        if (state->answer == StopRequest::kNone) state->answer = stop();
        return state->answer;
      },
      stop.latest(), stop.clock());
}

}  // namespace prospect
