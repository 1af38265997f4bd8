// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/return_deadline.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <utility>

#include "models/formatted.h"

namespace prospect {

ReturnDeadline::ReturnDeadline(std::string what, double seconds)
    : thread_([this, seconds,
               line = "prospect: " + std::move(what) +
                      formatted(" has not returned for %g s; expected it to\n", seconds)] {
        std::unique_lock lock(mutex_);
        const std::chrono::duration<double> patience(seconds);
        if (changed_.wait_for(lock, patience, [this] { return back_; })) return;
        if (::write(STDERR_FILENO, line.data(), line.size()) >= 0) {
        }
        ::_exit(EXIT_FAILURE);
      }) {}

ReturnDeadline::~ReturnDeadline() {
  {
    const std::lock_guard lock(mutex_);
    back_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

}  // namespace prospect
