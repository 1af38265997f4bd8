#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "runtime/drive_requests.h"

namespace prospect {

/// What viewers may tell a robot, in words. Thread-safety: as DriveRequests.
class LiveCommands {
 public:
  /// requests outlives it.
  explicit LiveCommands(DriveRequests& requests) : requests_(requests) {}

  /// "stop", "acknowledge", "hold", "resume".
  static std::vector<std::string> names();
  /// Empty, or why nothing was done. A stop is a hold, too, so that an acknowledgement does not
  /// start the robot; while it is stopped, nothing but an acknowledgement leads on.
  std::string give(const std::string& name);
  /// To a place in W [m]; likewise.
  std::string go(const Eigen::Vector2d& place);

  const DriveRequests& requests() const { return requests_; }

 private:
  DriveRequests& requests_;
};

}  // namespace prospect
