// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace prospect {

/// How a process ended: with its work done, with an exception (which it has printed), or by a
/// signal.
struct ProcessEnd {
  bool threw = false;
  int signal = 0;
};

/// work(i) for i = 0 ... count - 1, each in a process of its own (fork), so that one that crashes
/// costs only itself; at most `jobs` at a time, begun in order. ended(i, how) is called in this
/// process after each; what it throws is passed on, and running processes are left to end.
/// Throws std::runtime_error if no process can be started.
void run_in_processes(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t, const ProcessEnd&)>& ended);

}  // namespace prospect
