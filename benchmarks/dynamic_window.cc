// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/dynamic_window.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/planner/descent_path.h"
#include "models/tracking_input.h"

namespace prospect {
namespace {

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

Twist forward(double v, double w) { return {Eigen::Vector3d(v, 0.0, 0.0), w}; }

}  // namespace

std::vector<DriveCandidate> dynamic_window(const MotionModel& model, const BodyClearance& body,
                                           const DriveTask& task,
                                           const DynamicWindowOptions& options) {
  const double v_max = model.max_speed(), w_max = model.max_yaw_rate();
  const Pose start = model.pose(task.x0);
  const DescentPath path(*task.cost_to_go, start.position.head<2>(), options.path_length);
  const double allowed = std::min(options.d_safe - options.lattice_slack, body.clearance(start));
  std::vector<DriveCandidate> candidates;

  const auto add = [&](const char* name, const std::function<Twist(const Pose&)>& law) {
    DriveCandidate c{name, Eigen::MatrixXd(model.nu(), options.stages), 0.0};
    Eigen::VectorXd x = task.x0, next(model.nx()), u = task.u_previous;
    double close = 0.0, violation = 0.0;
    for (int k = 0; k < options.stages; ++k) {
      u = tracking_input(model, x, u, law(model.pose(x)), options.dt);
      c.inputs.col(k) = u;
      model.step(x, u, options.dt, next);
      x.swap(next);
      const double d = body.clearance(model.pose(x));
      const double lack = std::max(0.0, (options.d_des - d) / (options.d_des - options.d_safe));
      close += lack * lack / options.stages;
      violation = std::max(violation, allowed - d);
    }
    const Pose end = model.pose(x);
    const Eigen::Vector2d p = end.position.head<2>();
    double heading = path.heading(p, options.lookahead, end.yaw);
    if (task.arrived && task.target) {
      const Eigen::Vector2d to = task.target->looks_at - p;
      heading = std::atan2(to.y(), to.x());
    }
    c.cost = task.cost_to_go->value(p) +
             options.heading_weight * std::abs(wrapped(heading - end.yaw)) / w_max +
             options.clearance_weight * close + 60.0 * violation;
    if (std::isfinite(c.cost)) candidates.push_back(std::move(c));
  };
  const auto add_stop = [&] {
    const std::size_t before = candidates.size();
    add("stop", [](const Pose&) { return Twist{}; });
    if (candidates.size() > before) candidates.back().stops = true;
  };
  const auto towards = [&](double heading, double yaw) {
    return std::clamp(2.0 * wrapped(heading - yaw), -w_max, w_max);
  };

  if (task.arrived && task.target) {
    add("face", [&](const Pose& pose) {
      const Eigen::Vector2d to = task.target->looks_at - pose.position.head<2>();
      return forward(0.0, towards(std::atan2(to.y(), to.x()), pose.yaw));
    });
  } else if (!task.target) {
    add("look around", [&](const Pose&) { return forward(0.0, w_max); });
    add_stop();
    return candidates;
  } else if (task.escape) {
    for (const double speed : {0.4, 0.2, 0.0}) {
      add("escape", [&](const Pose& pose) {
        Eigen::Vector4d away;
        body.clearance(pose, &away);
        const double heading =
            away.head<2>().norm() < 1e-6 ? pose.yaw + 1.0 : std::atan2(away.y(), away.x());
        const double ahead = std::max(0.0, std::cos(wrapped(heading - pose.yaw)));
        return forward(speed * v_max * ahead * ahead * ahead, towards(heading, pose.yaw));
      });
    }
    add_stop();
    return candidates;
  } else {
    // Looking less far ahead cuts corners less: what gets through narrow gaps.
    for (const double share : {1.0, 0.4}) {
      const double lookahead = share * options.lookahead;
      for (const double speed : {1.0, 0.7, 0.4, 0.2}) {
        add("pursuit", [&](const Pose& pose) {
          const double heading = path.heading(pose.position.head<2>(), lookahead, pose.yaw);
          const double ahead = std::max(0.0, std::cos(wrapped(heading - pose.yaw)));
          // In the last stretch a second from the end, which is where the robot is to stand.
          const double v = std::min(speed * v_max, path.left(pose.position.head<2>()));
          return forward(v * ahead * ahead * ahead, towards(heading, pose.yaw));
        });
      }
    }
    add("turn to path", [&](const Pose& pose) {
      return forward(
          0.0,
          towards(path.heading(pose.position.head<2>(), options.lookahead, pose.yaw), pose.yaw));
    });
    for (int i = 0; i < 8; ++i) {
      for (int j = -7; j <= 7; ++j) {
        const Twist twist = forward(v_max * i / 7.0, w_max * j / 7.0);
        if (i > 0 || j != 0) add(i == 0 ? "turn" : "arc", [&](const Pose&) { return twist; });
      }
    }
  }
  add_stop();
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const DriveCandidate& a, const DriveCandidate& b) { return a.cost < b.cost; });
  return candidates;
}

}  // namespace prospect
