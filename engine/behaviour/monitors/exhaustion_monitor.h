// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

namespace prospect {

/// For how long nothing has been reachable while the robot looked for a path: a cell that noise
/// fills in a narrow passage must not end a mission.
///
/// A value: one a robot. Thread-safety: none. Never throws.
class ExhaustionMonitor {
 public:
  struct Search {
    bool nothing_reachable = false;  ///< at present
    bool observed = false;           ///< since the last update the robot had nothing else to do
  };
  /// At `stamp` [s]. Returns the time [s].
  double update(double stamp, const Search& search) {
    if (!search.nothing_reachable) {
      since_.reset();
    } else {
      if (!since_ || stamp < *since_) since_ = stamp;
      if (!search.observed) *since_ += std::max(0.0, stamp - updated_at_);
    }
    updated_at_ = stamp;
    return since_ ? stamp - *since_ : 0.0;
  }

 private:
  std::optional<double> since_;  // [s]
  double updated_at_ = 0.0;      // [s]
};

}  // namespace prospect
