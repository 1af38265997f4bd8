// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "runtime/drive_requests.h"

namespace prospect {

/// What people may tell a robot from afar, in words. Thread-safety: as DriveRequests.
class DriveCommands {
 public:
  /// requests outlives it.
  explicit DriveCommands(DriveRequests& requests) : requests_(requests) {}

  /// "stop", "acknowledge", "hold", "resume", "cancel": the place that it was sent to.
  static std::vector<std::string> names();
  /// Empty, or why nothing was done. A stop is a hold, too, so that an acknowledgement does not
  /// start the robot; while it is stopped, nothing but an acknowledgement leads on.
  std::string give(const std::string& name);
  /// To a place in W [m], with a heading [rad] if one is given; likewise. `number`: that of
  /// DriveRequests::go_to().
  std::string go(const Eigen::Vector2d& place, std::optional<double> yaw = std::nullopt,
                 int* number = nullptr);

  const DriveRequests& requests() const { return requests_; }

 private:
  DriveRequests& requests_;
};

}  // namespace prospect
