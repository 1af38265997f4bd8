// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime_priority.h"

#include <sched.h>

#include <cerrno>
#include <cstring>

namespace prospect {

RealtimePriority::RealtimePriority(int priority, Started started)
    : flag_(started == Started::kAsOthers ? SCHED_RESET_ON_FORK : 0) {
  if (priority <= 0) return;
  sched_param before{}, wanted{};
  const int policy = sched_getscheduler(0);
  wanted.sched_priority = priority;
  if (policy < 0 || sched_getparam(0, &before) != 0 ||
      sched_setscheduler(0, SCHED_FIFO | flag_, &wanted) != 0) {
    problem_ = "SCHED_FIFO is refused (" + std::string(std::strerror(errno)) +
               "): on a busy machine commands come late; expected CAP_SYS_NICE, or rtprio " +
               std::to_string(priority) + " in /etc/security/limits.conf";
    return;
  }
  policy_before_ = policy;
  priority_before_ = before.sched_priority;
}

RealtimePriority::~RealtimePriority() {
  if (policy_before_ < 0) return;
  sched_param before{};
  before.sched_priority = priority_before_;
  // Not everybody may take the flag back; it changes nothing for a thread of no such priority.
  sched_setscheduler(0, policy_before_ | flag_, &before);
}

}  // namespace prospect
