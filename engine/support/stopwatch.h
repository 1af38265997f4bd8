// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <chrono>

namespace prospect {

/// Wall time, for reports: never an input to anything that must be reproducible.
class Stopwatch {
 public:
  /// Milliseconds since construction or the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Processor time of the calling thread, or of all of the process: what work costs where others
/// keep the machine busy.
class ProcessorStopwatch {
 public:
  explicit ProcessorStopwatch(clockid_t clock = CLOCK_THREAD_CPUTIME_ID) : clock_(clock) {}
  /// Milliseconds since construction or the last lap.
  double lap() {
    const double before = last_;
    last_ = now();
    return last_ - before;
  }

 private:
  double now() const {
    timespec t{};
    clock_gettime(clock_, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
  clockid_t clock_;
  double last_ = now();
};

}  // namespace prospect
