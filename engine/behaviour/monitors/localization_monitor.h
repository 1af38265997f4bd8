// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "engine/maps/localization.h"

namespace prospect {

/// For how long localization has been lost, and whether it got lost just now.
///
/// A value: one a robot. Thread-safety: none. Never throws.
class LocalizationMonitor {
 public:
  /// At `stamp` [s].
  void update(double stamp, Localization localization) {
    const bool lost = localization == Localization::kLost;
    got_lost_ = lost && !lost_;
    lost_ = lost;
    if (!lost) last_not_lost_ = stamp;
    lost_for_ = stamp - last_not_lost_;
  }

  /// It was not lost at the update before; the robot begins localized.
  bool got_lost() const { return got_lost_; }
  /// [s] since it was not lost; infinite if it never was otherwise.
  double lost_for() const { return lost_for_; }

 private:
  bool lost_ = false;
  bool got_lost_ = false;
  double last_not_lost_ = -std::numeric_limits<double>::infinity();
  double lost_for_ = 0.0;
};

}  // namespace prospect
