#pragma once

#include <chrono>
#include <functional>
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
  explicit StopCondition(Function ask) : ask_(std::move(ask)) {}

  StopRequest operator()() const { return ask_ ? ask_() : StopRequest::kNone; }

  friend StopCondition operator||(StopCondition a, StopCondition b) {
    if (!a.ask_) return b;
    if (!b.ask_) return a;
    return StopCondition([a = std::move(a.ask_), b = std::move(b.ask_)] {
      const StopRequest first = a();
      return first != StopRequest::kNone ? first : b();
    });
  }

 private:
  Function ask_;
};

/// Stops once `seconds` of wall-clock (steady) time have passed since this call. Infinite: never.
/// Not a number, zero or less: at once.
inline StopCondition deadline(double seconds) {
  // Lifetimes would not fit the clock; nobody waits for them.
  if (seconds >= 1e9) return {};
  if (!(seconds > 0.0)) {
    return StopCondition([] { return StopRequest::kDeadline; });
  }
  const auto end =
      StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                        std::chrono::duration<double>(seconds));
  return StopCondition([end] {
    return StopCondition::Clock::now() >= end ? StopRequest::kDeadline : StopRequest::kNone;
  });
}

/// Stops once `flag()` is true (e.g. reads an atomic). An empty function: never.
inline StopCondition cancelled_by(std::function<bool()> flag) {
  if (!flag) return {};
  return StopCondition(
      [flag = std::move(flag)] { return flag() ? StopRequest::kCancelled : StopRequest::kNone; });
}

}  // namespace prospect
