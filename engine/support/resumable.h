// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>

namespace prospect {

/// Where a computation may pause: called by its loops every few microseconds of work. One that
/// belongs to no Resumable does nothing.
///
/// Thread-safety: only of the thread that works. Throws what unwinds a Resumable that was given up;
/// loops let it pass.
class PausePoint {
 public:
  PausePoint() = default;
  void operator()() const {
    if (pause_ != nullptr) (*pause_)();
  }

 private:
  friend class Resumable;
  explicit PausePoint(const std::function<void()>* pause) : pause_(pause) {}
  const std::function<void()>* pause_ = nullptr;
};

/// A computation that is done in pieces, in the time that its caller has for it: begun once,
/// continued until it is done. Between two pieces it stands still, so that caller and computation
/// never work at the same time and need no locks between them.
///
/// It works on a stack of its own: a thread, started by the first begin(), to which the caller
/// hands over and for which it waits. What it makes does not depend on where it paused.
///
/// Thread-safety: one caller at a time. The destructor gives up what is not done.
class Resumable {
 public:
  using Clock = std::chrono::steady_clock;

  Resumable();
  ~Resumable();
  Resumable(const Resumable&) = delete;
  Resumable& operator=(const Resumable&) = delete;

  /// Begins `work`, without doing any of it yet. Requires !busy(). Throws std::system_error if the
  /// system has no thread.
  void begin(std::function<void(const PausePoint&)> work);
  /// Goes on until it is done or the time has come; a little of it in any case. Returns whether it
  /// is done, which it is where nothing was begun. Throws what the work threw, which is done then.
  bool run_until(Clock::time_point time);
  /// Whether something was begun that is not done.
  bool busy() const;
  /// Unwinds what is not done.
  void give_up();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
