// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

namespace prospect {

/// Whether a robot at a goal can have the heading that was asked for.
///
/// It cannot once localization was lost kLosses times while the robot was there, or once it has
/// tried for kPatience without turning nearer to it by kTurned. From then on the place counts.
///
/// A value: one a goal. Thread-safety: none. Never throws. Source: our choice.
class HeadingMonitor {
 public:
  static constexpr int kLosses = 2;          ///< once may be chance
  static constexpr double kPatience = 20.0;  ///< [s]: three full turns
  static constexpr double kTurned = 0.1;     ///< [rad]

  enum class Verdict { kOpen, kGetsLost, kDoesNotTurn };

  /// What the robot is doing, since the update before.
  struct Attempt {
    bool pursued = true;    ///< it tried to get there
    bool got_lost = false;  ///< localization was lost
  };

  /// At `stamp` [s]; there: at the place; turned: [rad] that are left to the heading, >= 0.
  Verdict update(double stamp, bool there, double turned, const Attempt& attempt) {
    const double passed = last_ ? std::max(0.0, stamp - *last_) : 0.0;
    last_ = stamp;
    if (verdict_ != Verdict::kOpen || !there) return verdict_;
    if (attempt.got_lost && ++losses_ >= kLosses) verdict_ = Verdict::kGetsLost;
    if (turned <= least_ - kTurned) {
      least_ = turned;
      tried_for_ = 0.0;
    } else if (attempt.pursued) {
      tried_for_ += passed;
    }
    if (verdict_ == Verdict::kOpen && tried_for_ >= kPatience - 1e-9) {
      verdict_ = Verdict::kDoesNotTurn;
    }
    return verdict_;
  }
  Verdict verdict() const { return verdict_; }

 private:
  std::optional<double> last_;                              // [s]
  double least_ = std::numeric_limits<double>::infinity();  // [rad]
  double tried_for_ = 0.0;                                  // [s]
  int losses_ = 0;
  Verdict verdict_ = Verdict::kOpen;
};

}  // namespace prospect
