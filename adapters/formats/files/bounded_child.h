// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace prospect {

/// What a child process may use.
struct ChildLimits {
  std::size_t memory = std::size_t{1} << 30;  ///< [bytes] beyond what this process has
  double seconds = 60.0;                      ///< of processor time, and as many of sleep
  std::size_t result = std::size_t{2} << 30;  ///< [bytes] of what it hands back
};

/// Runs `work` in a child process (a fork of this one) and hands back what it returns: for
/// libraries that crash, or use memory and time without bound, on hostile files. Time that the
/// child waits for a processor, or is stopped, is not counted. What the child prints is dropped. An
/// InputError of `work` is thrown again here. Throws InputError in one line,
/// `subject: what`, if the work throws anything else, crashes, or exceeds a limit;
/// std::runtime_error if there can be no child. The child must not need other threads of this
/// process. `waiting` is called every now and then until the child is done, with the seconds so
/// far.
std::string run_in_child(const std::string& subject, const std::function<std::string()>& work,
                         const ChildLimits& limits,
                         const std::function<void(double)>& waiting = {});

}  // namespace prospect
