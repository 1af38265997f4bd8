// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// The calling thread runs before all others of the machine that do not ask for as much
/// (SCHED_FIFO of Linux), where the system allows it, until this ends. Thread-safety: made and
/// ended by the thread that it is of.
class RealtimePriority {
 public:
  enum class Started {
    kAsOthers,  ///< a thread that it starts meanwhile begins as all others
    kLikewise   ///< ... as it does
  };
  /// priority: 1 to 99; 0: as before.
  explicit RealtimePriority(int priority, Started started = Started::kAsOthers);
  ~RealtimePriority();
  RealtimePriority(const RealtimePriority&) = delete;
  RealtimePriority& operator=(const RealtimePriority&) = delete;

  /// Why it is not so, one sentence; empty: it is, or was not asked for.
  const std::string& problem() const { return problem_; }

 private:
  int policy_before_ = -1, priority_before_ = 0;  // -1: nothing was changed
  int flag_ = 0;
  std::string problem_;
};

}  // namespace prospect
