#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace prospect {

enum class StopRequest { kNone, kDeadline, kCancelled };

/// When a solve must end: a small value that is asked inside the evaluator, before every
/// evaluation. Composable: `deadline(...) || cancelled(...)` stops as soon as either does.
///
/// Thread-safety: operator() may be called from any thread if the wrapped function may.
class StopCondition {
 public:
  using Function = std::function<StopRequest()>;
  using Clock = std::chrono::steady_clock;

  /// Never stops.
  StopCondition() = default;
  /// latest: when it will ask to stop at the latest, if that is known.
  explicit StopCondition(Function ask, Clock::time_point latest = Clock::time_point::max())
      : ask_(std::move(ask)), latest_(latest) {}

  StopRequest operator()() const { return ask_ ? ask_() : StopRequest::kNone; }
  /// The time by which it stops; max() if it may never. For those who share out the time they have.
  Clock::time_point latest() const { return latest_; }

  friend StopCondition operator||(StopCondition a, StopCondition b) {
    if (!a.ask_) return b;
    if (!b.ask_) return a;
    const Clock::time_point latest = std::min(a.latest_, b.latest_);
    return StopCondition(
        [a = std::move(a.ask_), b = std::move(b.ask_)] {
          const StopRequest first = a();
          return first != StopRequest::kNone ? first : b();
        },
        latest);
  }

 private:
  Function ask_;
  Clock::time_point latest_ = Clock::time_point::max();
};

/// Stops once `seconds` of wall-clock (steady) time have passed since this call. Infinite: never.
/// Not a number, zero or less: at once.
inline StopCondition deadline(double seconds) {
  // Lifetimes would not fit the clock; nobody waits for them.
  if (seconds >= 1e9) return {};
  if (!(seconds > 0.0)) {
    return StopCondition([] { return StopRequest::kDeadline; }, StopCondition::Clock::now());
  }
  const auto end =
      StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                        std::chrono::duration<double>(seconds));
  return StopCondition(
      [end] {
        return StopCondition::Clock::now() >= end ? StopRequest::kDeadline : StopRequest::kNone;
      },
      end);
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
      stop.latest());
}

}  // namespace prospect
