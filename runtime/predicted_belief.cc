// SPDX-License-Identifier: Apache-2.0
#include "runtime/predicted_belief.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "models/sinc.h"

namespace prospect {
namespace {

/// The command in force at time t.
Twist in_force(std::span<const SentCommand> commands, double t) {
  Twist command;
  for (const SentCommand& sent : commands) {
    if (sent.time > t) break;
    command = sent.command;
  }
  return command;
}

}  // namespace

Pose predicted_pose(const Pose& pose, double from, std::span<const SentCommand> commands,
                    double until, const ActuationDelay& delay) {
  const double linear_end = until + delay.linear, angular_end = until + delay.angular;
  const double end = std::max(linear_end, angular_end);
  // Where either velocity changes.
  std::vector<double> times = {from, linear_end, angular_end};
  for (const SentCommand& sent : commands) {
    if (sent.time >= until) break;
    times.push_back(sent.time + delay.linear);
    times.push_back(sent.time + delay.angular);
  }
  std::erase_if(times, [&](double t) { return !(t >= from && t <= end); });
  std::sort(times.begin(), times.end());
  Pose at = pose;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const double dt = times[k + 1] - times[k];
    if (!(dt > 0.0)) continue;
    const double t = times[k];
    const Eigen::Vector3d v =
        t < linear_end ? in_force(commands, t - delay.linear).linear : Eigen::Vector3d::Zero();
    const double w = t < angular_end ? in_force(commands, t - delay.angular).yaw_rate : 0.0;
    const double half = 0.5 * w * dt;
    const Eigen::AngleAxisd turned(at.yaw + half, Eigen::Vector3d::UnitZ());
    const double chord = dt * sinc(half);
    at.position += turned * Eigen::Vector3d(v.x() * chord, v.y() * chord, v.z() * dt);
    at.yaw += w * dt;
  }
  return at;
}

Belief predicted_belief(const Belief& belief, std::span<const SentCommand> commands, double start,
                        const ActuationDelay& delay) {
  Belief predicted = belief;
  const double until = std::max(start, belief.stamp);
  predicted.pose = predicted_pose(belief.pose, belief.stamp, commands, until, delay);
  predicted.stamp = until;
  // The newest command before `start`: the one at `start` is the plan's own.
  predicted.twist = in_force(commands, std::nextafter(until, -std::numeric_limits<double>::max()));
  predicted.command = predicted.twist;
  return predicted;
}

}  // namespace prospect
