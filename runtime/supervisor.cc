// SPDX-License-Identifier: Apache-2.0
#include "runtime/supervisor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "models/range_text.h"

namespace prospect {

std::string_view to_string(ThreadState state) {
  switch (state) {
    case ThreadState::kStarting:
      return "starting";
    case ThreadState::kNeverStarted:
      return "never started";
    case ThreadState::kOnTime:
      return "on time";
    case ThreadState::kLate:
      return "late";
    case ThreadState::kEnded:
      return "ended";
  }
  return "?";
}

Supervisor::Supervisor(std::vector<SupervisedThread> threads, double start)
    : threads_(std::move(threads)),
      start_(start),
      slots_(std::make_unique<Slot[]>(threads_.size())) {
  if (threads_.empty()) {
    throw std::invalid_argument("supervisor: no thread; expected one or more");
  }
  std::set<std::string> names;
  for (const SupervisedThread& thread : threads_) {
    if (thread.name.empty() || !names.insert(thread.name).second) {
      throw std::invalid_argument("supervisor: thread '" + thread.name +
                                  "'; expected a name, and another one for each thread");
    }
    if (!std::isfinite(thread.limit) || thread.limit <= 0.0) {
      throw std::invalid_argument("supervisor: limit of thread '" + thread.name + "' is " +
                                  exact_text(thread.limit) + "; expected a number above 0 s");
    }
  }
}

void Supervisor::beat(int thread, double now) {
  assert(thread >= 0 && static_cast<std::size_t>(thread) < threads_.size());
  Slot& slot = slots_[static_cast<std::size_t>(thread)];
  slot.newest.store(now, std::memory_order_relaxed);
  // Whoever sees the beat sees its time.
  slot.beats.fetch_add(1, std::memory_order_release);
}

void Supervisor::end(int thread) {
  assert(thread >= 0 && static_cast<std::size_t>(thread) < threads_.size());
  slots_[static_cast<std::size_t>(thread)].ended.store(true, std::memory_order_release);
}

ThreadReport Supervisor::report(std::size_t thread, double now) const {
  const Slot& slot = slots_[thread];
  ThreadReport report;
  report.name = threads_[thread].name;
  report.limit = threads_[thread].limit;
  report.beats = slot.beats.load(std::memory_order_acquire);
  const bool begun = report.beats > 0;
  report.age = now - (begun ? slot.newest.load(std::memory_order_relaxed) : start_);
  // A beat while this is read may be newer than `now`.
  const bool within = report.age <= report.limit && std::isfinite(report.age);
  if (slot.ended.load(std::memory_order_acquire)) {
    report.state = ThreadState::kEnded;
  } else if (begun) {
    report.state = within ? ThreadState::kOnTime : ThreadState::kLate;
  } else {
    report.state = within ? ThreadState::kStarting : ThreadState::kNeverStarted;
  }
  return report;
}

std::vector<ThreadReport> Supervisor::report(double now) const {
  std::vector<ThreadReport> all;
  for (std::size_t thread = 0; thread < threads_.size(); ++thread) {
    all.push_back(report(thread, now));
  }
  return all;
}

bool Supervisor::may_stroke(double now) {
  const std::vector<ThreadReport> all = report(now);
  for (std::size_t thread = 0; thread < all.size(); ++thread) {
    if (all[thread].state != ThreadState::kOnTime || all[thread].beats == slots_[thread].stroked) {
      return false;
    }
  }
  for (std::size_t thread = 0; thread < all.size(); ++thread) {
    slots_[thread].stroked = all[thread].beats;
  }
  return true;
}

double Supervisor::longest_limit() const {
  double longest = 0.0;
  for (const SupervisedThread& thread : threads_) longest = std::max(longest, thread.limit);
  return longest;
}

}  // namespace prospect
