// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"

namespace prospect {

/// The last gate before motors: what of the commands that come in may go out, and when.
///
///   Bounds. A velocity beyond the limits is scaled down as a whole, so that its arc stays the
///   same: by min(1, speed / |v|, yaw_rate / |w|). From there the velocity that went out last is
///   led to it by at most acceleration dt and yaw_acceleration dt, dt [s] since then. What brakes
///   is never held back: towards zero it goes at once.
///
///   Age. A command holds until it is `dead_man` old, counted from its stamp: one that comes older
///   than that is not taken, nor one that is stamped so far ahead. Once the newest is that old,
///   zero goes out, again and again.
///
///   Numbers. A command that is not finite is zero.
///
///   One commander. While several publish commands, zero goes out, whatever they say.
///
/// What it bounds and refuses it says (complaint()). A change that is led to within a fifth of a
/// second is none that is told of: commands do not come evenly.
///
/// Before the first command nothing goes out. Thread-safety: one thread at a time. Never throws,
/// but for lack of memory.
class CommandGate {
 public:
  struct Limits {
    double speed = 0.0;             ///< [m/s]
    double yaw_rate = 0.0;          ///< [rad/s]; of all axes that turn
    double acceleration = 0.0;      ///< [m/s^2]
    double yaw_acceleration = 0.0;  ///< [rad/s^2]
    double dead_man = 0.0;          ///< [s]
    double period = 0.02;           ///< [s] in which output() is asked, at least
  };
  /// All > 0.
  explicit CommandGate(const Limits& limits) : limits_(limits) {}

  /// A command that came at `now` [s], `age` [s] old then by its stamp (negative: ahead); 0 where
  /// it has no stamp.
  void take(const ros::Twist& command, double age, double now);
  /// What is to go out at `now`, with these commanders; none: what went out last still holds.
  std::optional<ros::Twist> output(const std::vector<std::string>& commanders, double now);
  /// Zero from now on, whatever comes.
  void close() { closed_ = true; }

  /// What was wrong with commands within the last second before `now`, one line; empty: nothing.
  std::string complaint(double now) const;

 private:
  enum class Wrong { kNothing, kNotFinite, kTooFast, kTooSudden, kTooOld, kAhead, kCommanders };
  void complain(Wrong wrong, const std::string& line, double now);

  Limits limits_;
  Eigen::Vector3d wanted_linear_ = Eigen::Vector3d::Zero(), linear_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d wanted_angular_ = Eigen::Vector3d::Zero(), angular_ = Eigen::Vector3d::Zero();
  std::optional<double> since_;  // [s] when the newest command was made
  std::optional<double> sent_;   // [s] when something went out last
  bool fresh_ = false;           // a command came since
  bool closed_ = false;
  Wrong wrong_ = Wrong::kNothing;
  std::string line_;
  double complained_ = 0.0;
};

}  // namespace prospect
