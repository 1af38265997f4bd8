#pragma once

#include <optional>

namespace prospect {

/// How long a robot may spend on low-yield frontiers, what is left once ordinary ones lead nowhere
/// (search.h): short frontiers, narrow passages, what was given up.
///
///   time = max(least, share t)      t: how long the ordinary ones took
///
/// An estimate that drifts goes on drawing walls twice, and with them frontiers, for ever, and a
/// robot in narrow places with such a map will touch something in the end. But what adds the share
/// `growth` to the explored area is a part of the building behind a door that looked shut: `least`
/// begins anew.
///
/// A value: one a mission. Thread-safety: none. Never throws after construction. Source: our
/// choice, measured (docs/frontiers.md).
class LowYieldMonitor {
 public:
  struct Options {
    double share = 0.5;    ///< of the time that ordinary frontiers took, 0 to 1000
    double least = 300.0;  ///< [s], 0 to 1e6
    double growth = 0.1;   ///< share of the explored area, 0 to 1000
  };

  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit LowYieldMonitor(const Options& options);

  /// At `stamp` [s], non-decreasing, `explored` [m^2] are; both finite. Returns true where what was
  /// taken for low-yield has turned out not to be.
  bool update(double stamp, double explored);

  /// Ordinary frontiers lead nowhere, at the update's stamp and with that much explored; from the
  /// second call on without effect.
  void begin(double stamp, double explored);

  /// Whether the time is up. Never before begin().
  bool up(double stamp) const { return until_ && stamp > *until_; }

 private:
  Options options_;
  std::optional<double> started_at_;  // [s] first update
  std::optional<double> until_;       // [s]
  double area_ = 0.0;                 // [m^2] explored when it began, or began anew
};

}  // namespace prospect
