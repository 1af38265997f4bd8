// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "models/types.h"
#include "runtime/clock.h"

/// Stands for the robot: a base that drives as it is told, its localization, a 2-D lidar, and two
/// rooms joined by a door. Replace it by your drivers. Used by one thread.
class PretendRobot {
 public:
  static constexpr double kDeadMan = 0.3;  // [s] after which it stands if nothing comes

  /// The body velocity (forward, turn) from now until `expires` [s].
  void drive(const prospect::Twist& command, double expires) {
    pose_ = pose();
    since_ = clock_.now();
    until_ = std::min(expires, since_ + kDeadMan);
    command_ = command;
  }
  prospect::Twist velocity() const { return clock_.now() < until_ ? command_ : prospect::Twist(); }

  /// Where the robot is: x, y [m] in W, and heading [rad].
  prospect::Pose pose() const {
    const double t = std::max(0.0, std::min(clock_.now(), until_) - since_);
    const double half = 0.5 * command_.yaw_rate * t;
    const double chord = command_.linear.x() * t * (half == 0.0 ? 1.0 : std::sin(half) / half);
    prospect::Pose at = pose_;
    at.position.x() += chord * std::cos(pose_.yaw + half);
    at.position.y() += chord * std::sin(pose_.yaw + half);
    at.yaw += 2.0 * half;
    return at;
  }

  /// One turn of the lidar from `at`: 720 ranges [m], counter-clockwise from straight ahead;
  /// infinite where nothing is within `max_range`.
  std::vector<double> scan(const prospect::Pose& at, double max_range) const {
    std::vector<double> ranges(720, INFINITY);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double angle = at.yaw + 2.0 * M_PI * static_cast<double>(i) / 720.0;
      for (double r = 0.1; r < max_range; r += 0.02) {
        if (!solid(at.position.x() + r * std::cos(angle), at.position.y() + r * std::sin(angle))) {
          continue;
        }
        ranges[i] = r;
        break;
      }
    }
    return ranges;
  }

  /// Whether a disc of that radius about the robot touches a wall.
  bool touches(double radius) const {
    const prospect::Pose at = pose();
    return std::any_of(kWalls.begin(), kWalls.end(), [&](const Wall& wall) {
      const double dx = at.position.x() - std::clamp(at.position.x(), wall.x0, wall.x1);
      const double dy = at.position.y() - std::clamp(at.position.y(), wall.y0, wall.y1);
      return std::hypot(dx, dy) < radius;
    });
  }

 private:
  struct Wall {
    double x0, y0, x1, y1;
  };
  static constexpr std::array<Wall, 8> kWalls = {{{-1.2, -1.2, 8.2, -1.0},
                                                  {-1.2, 3.0, 8.2, 3.2},
                                                  {-1.2, -1.2, -1.0, 3.2},
                                                  {8.0, -1.2, 8.2, 3.2},
                                                  {3.5, -1.2, 3.7, 0.5},
                                                  {3.5, 1.7, 3.7, 3.2},
                                                  {1.4, 0.4, 1.9, 0.9},
                                                  {5.6, 1.6, 6.2, 3.2}}};
  static bool solid(double x, double y) {
    return std::any_of(kWalls.begin(), kWalls.end(), [&](const Wall& wall) {
      return x >= wall.x0 && x <= wall.x1 && y >= wall.y0 && y <= wall.y1;
    });
  }

  prospect::SteadyClock clock_;
  double since_ = 0.0, until_ = 0.0;
  prospect::Twist command_;
  prospect::Pose pose_;
};
