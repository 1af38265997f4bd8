// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "engine/support/resumable.h"
#include "engine/support/stopwatch.h"

namespace prospect::test {

/// The share of its processor time that the longest piece of `work` takes, paused wherever it may
/// be. The least of three runs, since the machine may be busy. A share is the same on a slow
/// machine and under sanitizers.
inline double longest_piece(const std::function<void(const PausePoint&)>& work) {
  double least = 1.0;
  for (int run = 0; run < 3; ++run) {
    Resumable resumable;
    resumable.begin(work);
    double longest = 0.0, total = 0.0;
    for (bool done = false; !done;) {
      ProcessorStopwatch watch(CLOCK_PROCESS_CPUTIME_ID);
      done = resumable.run_until(Resumable::Clock::now() + std::chrono::microseconds(200));
      const double took = watch.lap();
      longest = std::max(longest, took);
      total += took;
    }
    least = std::min(least, longest / total);
  }
  return least;
}

}  // namespace prospect::test
