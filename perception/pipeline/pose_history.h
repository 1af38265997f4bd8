#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "models/types.h"

namespace prospect {

/// Where a body was of late, as it was believed then; nothing is corrected afterwards.
/// Thread-safety: one thread. Never throws. Deterministic.
class PoseHistory {
 public:
  /// span [s]: times up to so long before the newest are known.
  explicit PoseHistory(double span) : span_(span) {}

  /// Stamps are finite and increase [s].
  void add(double stamp, const Pose& pose);
  /// Between two poses straight on, the yaw the shorter way round; nothing before the first and
  /// after the newest.
  std::optional<Pose> at(double stamp) const;
  std::optional<double> newest() const;

 private:
  double span_;
  std::deque<std::pair<double, Pose>> poses_;
};

}  // namespace prospect
