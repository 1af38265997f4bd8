// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// A thread that must answer.
struct SupervisedThread {
  std::string name;
  double limit = 0.5;  ///< [s] longest time between two beats, and from the start to the first
};

enum class ThreadState {
  kStarting,      ///< no beat yet, within its limit
  kNeverStarted,  ///< no beat yet, beyond its limit
  kOnTime,
  kLate,  ///< its newest beat is older than its limit, or has no time
  kEnded  ///< it said that it ends
};
/// "starting", "never started", "on time", "late", "ended".
std::string_view to_string(ThreadState state);

/// What the supervisor knows of a thread at one instant.
struct ThreadReport {
  std::string name;
  ThreadState state = ThreadState::kStarting;
  double age = 0.0;    ///< [s] of the newest beat; without one, since the start
  double limit = 0.0;  ///< [s]
  std::uint64_t beats = 0;
};

/// Who of the robot's threads answers, and whether the watchdog may be stroked.
///
/// Each thread calls beat() itself, where it does its work, once each round: so a thread that hangs
/// is late, whatever another one does for it. One that waits for long calls it while it waits. The
/// watchdog, or the base's own dead-man, is stroked only if may_stroke() says so: all threads have
/// beaten since the last time, none is late, none has ended. So the slowest thread's limit must be
/// below the watchdog's time (longest_limit()).
/// Source: F Prime's health component, whose pings are answered by each component's own thread.
///
/// Times are of the runtime's monotonic clock [s] and handed over. Thread-safety: beat() and end()
/// of one thread may run beside all other functions, and wait for nobody; may_stroke() by one
/// thread. Errors: the constructor throws std::invalid_argument without threads, for names that are
/// empty or there twice, and for limits that are not positive and finite. The index of a thread is
/// that of the list; another one is asserted.
class Supervisor {
 public:
  Supervisor(std::vector<SupervisedThread> threads, double start);

  /// By the thread itself.
  void beat(int thread, double now);
  /// By the thread itself, as its last act. For good.
  void end(int thread);

  /// In the order of the list.
  std::vector<ThreadReport> report(double now) const;
  /// Whether the watchdog may be stroked. If so, the beats until now are used up.
  bool may_stroke(double now);
  double longest_limit() const;  ///< [s]

 private:
  struct Slot {
    std::atomic<double> newest{0.0};
    std::atomic<std::uint64_t> beats{0};
    std::atomic<bool> ended{false};
    std::uint64_t stroked = 0;  // beats at the last stroke
  };
  ThreadReport report(std::size_t thread, double now) const;

  std::vector<SupervisedThread> threads_;
  double start_;
  std::unique_ptr<Slot[]> slots_;
};

}  // namespace prospect
