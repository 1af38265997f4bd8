#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/gazebo/gazebo_options.h"
#include "models/types.h"

namespace prospect {

/// The dead-man that Gazebo's DiffDrivePlugin lacks, which holds its last command for ever: a
/// process of its own between us and the plug-in. It passes on each command that has not expired.
/// When the newest one is expired, or older than its dead-man's time, it sends zero velocity, and
/// again with every period. When who started it ends, in whatever way, it sends zero velocity for
/// 0.2 s and ends. It does not heed Ctrl-C, nor a terminal that closes.
///
/// It is a copy of the process that starts it (fork), so it is started before threads are. What it
/// cannot do: stop the robot after it was killed itself, or when its own link to Gazebo breaks;
/// state() shows either.
///
/// Thread-safety: one thread at a time; send() and state() return at once.
class VelocityRelay {
 public:
  struct Report {
    bool connected = false;  ///< to the master, and the plug-in listens
    std::string fault;       ///< empty: none
  };

  /// Waits until it runs. Throws InputError with what it says if it cannot reach Gazebo,
  /// NotBuiltIn.
  explicit VelocityRelay(const GazeboOptions& options);
  /// Waits until it has ended, at most 2 s.
  ~VelocityRelay();
  VelocityRelay(const VelocityRelay&) = delete;
  VelocityRelay& operator=(const VelocityRelay&) = delete;

  /// `expires` [s] of SteadyClock. A velocity that is not finite is a stop. False: it was not
  /// taken.
  bool send(const Twist& velocity, double expires) noexcept;
  /// Its newest word; a fault if it is silent for a second or has ended.
  Report state() noexcept;

  int process() const { return process_; }

 private:
  int process_ = -1;
  int link_ = -1;
  double heard_ = 0.0;  // [s] of SteadyClock
  Report report_;
};

}  // namespace prospect
