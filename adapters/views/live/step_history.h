// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// The steps of a mission for whoever comes late: at most `most`. Where there are more, every other
/// one is left out, so that older ones get sparser; what it changed in the map goes to the one
/// after it. A value. Thread-safety: one thread.
class StepHistory {
 public:
  explicit StepHistory(std::size_t most = 2000) : most_(most) {}

  void add(std::shared_ptr<const StepRecord> step);
  /// The oldest that are later than step number `after`, at most `count`.
  std::vector<std::shared_ptr<const StepRecord>> since(int after, std::size_t count) const;
  /// Number of the newest; -1: there is none.
  int newest() const { return steps_.empty() ? -1 : steps_.back()->step; }
  std::size_t size() const { return steps_.size(); }

 private:
  std::size_t most_;
  std::vector<std::shared_ptr<const StepRecord>> steps_;
};

}  // namespace prospect
