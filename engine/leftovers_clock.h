#pragma once

#include <Eigen/Core>
#include <optional>

namespace prospect {

/// How long a robot may spend on what is left once the first look at a building is over: narrow
/// places, keyholes, gaps.
///
///   time = max(least, share t)      t: how long the first rules led somewhere
///
/// An estimate that drifts goes on drawing walls twice, and with them frontiers, for ever, and a
/// robot in narrow places with such a map will touch something in the end. But
/// * what adds the share `growth` to the explored area is no leftover, it is a part of the building
///   behind a door that looked shut: `least` begins anew;
/// * time in which the robot is held (20 s or longer within 1 m: in a nook, say, that is hardly
///   wider than itself) does not count, up to `least`: it does not get to what is left.
///
/// A value: one a mission. Thread-safety: none. Never throws after construction. Source: our
/// choice, measured (docs/frontiers.md).
class LeftoversClock {
 public:
  struct Options {
    double share = 0.5;    ///< of the time that the first rules took, 0 to 1000
    double least = 300.0;  ///< [s], 0 to 1e6
    double growth = 0.1;   ///< share of the explored area, 0 to 1000
  };

  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit LeftoversClock(const Options& options);

  /// The robot at `position` in W (x, y) [m] at `stamp` [s], non-decreasing, with `explored` [m^2].
  /// All finite. Returns true where what was taken for leftovers has turned out to be none.
  bool update(double stamp, const Eigen::Vector2d& position, double explored);

  /// The first rules lead nowhere, at the update's stamp and with that much explored; from the
  /// second call on without effect.
  void begin(double stamp, double explored);

  /// Whether the time is up. Never before begin().
  bool up(double stamp) const { return until_ && stamp > *until_; }

 private:
  Options options_;
  std::optional<double> started_at_;      // [s] first update
  std::optional<double> until_;           // [s]
  double area_ = 0.0;                     // [m^2] explored when it began, or began anew
  double held_for_ = 0.0;                 // [s] that did not count since
  Eigen::Vector2d arrived_{0.0, 0.0};     // in W [m]; the robot has been near since
  double arrived_at_ = 0.0, last_ = 0.0;  // [s]
};

}  // namespace prospect
