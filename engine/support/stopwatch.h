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

/// Processor time of the calling thread: what work costs where others keep the machine busy.
class ProcessorStopwatch {
 public:
  /// Milliseconds of this thread since construction or the last lap.
  double lap() {
    const double before = last_;
    last_ = now();
    return last_ - before;
  }

 private:
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
  double last_ = now();
};

}  // namespace prospect
