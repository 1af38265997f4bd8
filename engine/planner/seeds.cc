// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/seeds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/planner/descent_path.h"
#include "engine/problem/admissible_inputs.h"
#include "models/tracking_input.h"

namespace prospect {
namespace {

/// What a steering law is asked: the desired body velocity at time t [s] and pose.
using Law = std::function<Twist(double t, const Pose& pose)>;

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

/// Rolls a steering law out, one decision a knot, and returns the knots' inputs.
Eigen::VectorXd roll(const Problem& problem, const Law& law) {
  const ProblemDefinition& d = problem.definition();
  const MotionModel& model = *d.model;
  Eigen::VectorXd z(problem.num_variables());
  Eigen::VectorXd x = d.x0;
  Eigen::VectorXd next(model.nx());
  Eigen::VectorXd u = d.u_previous;
  // A velocity may change once a stage; an acceleration acts for as long as the knot lasts.
  const bool velocity_controlled = model.num_state_constraints() == 0;
  for (int k = 0; k < d.N;) {
    const int knot = problem.knot(k);
    int stages = 1;
    while (k + stages < d.N && problem.knot(k + stages) == knot) ++stages;
    const double duration = velocity_controlled ? d.dt : stages * d.dt;
    u = tracking_input(model, x, u, law(k * d.dt, model.pose(x)), duration);
    z.segment(knot * model.nu(), model.nu()) = u;
    for (int s = 0; s < stages; ++s) {
      model.step(x, u, d.dt, next);
      x.swap(next);
    }
    k += stages;
  }
  return admissible_inputs(problem, z);
}

Twist forward(double v, double w) { return {Eigen::Vector3d(v, 0.0, 0.0), w}; }

class Laws {
 public:
  Laws(const Problem& problem, const SeedContext& context)
      : model_(*problem.definition().model), context_(context), dt_(problem.definition().dt) {
    if (context.known == nullptr) return;
    // Where the robot is nearer than the margin, it need not keep it (BrakingConstraint).
    margin_ = std::min(context.known_margin,
                       context.known->clearance(model_.pose(problem.definition().x0)));
  }

  Law constant(double speed, double turn) const {
    return [=, this](double, const Pose& pose) {
      return stoppable(pose, forward(speed * model_.max_speed(), turn * model_.max_yaw_rate()));
    };
  }

  /// The same with a speed from which the robot can stop within what is known to be free.
  Twist stoppable(const Pose& pose, Twist twist) const {
    const double speed = twist.linear.norm();
    if (context_.known == nullptr || speed < kCreep * model_.max_speed()) return twist;
    const double a = model_.max_deceleration();
    const double needed = speed * dt_ + 0.5 * speed * speed / a;
    double free = 0.0;
    for (int place = 0; place < kMostPlaces && free < needed; ++place) {
      // Along the arc that it is on.
      const double next = std::min(free + kSpacing, needed);
      const double half = 0.5 * twist.yaw_rate / speed * next;
      const double c = std::cos(pose.yaw + half), s = std::sin(pose.yaw + half);
      const Eigen::Vector3d path = twist.linear * (next / speed);
      Pose there{pose.position, pose.yaw + 2.0 * half};
      there.position +=
          Eigen::Vector3d(c * path.x() - s * path.y(), s * path.x() + c * path.y(), path.z());
      if (context_.known->clearance(there) < margin_) break;
      free = next;
    }
    if (free >= needed) return twist;
    const double v =
        std::max(kCreep * model_.max_speed(), a * (std::sqrt(dt_ * dt_ + 2.0 * free / a) - dt_));
    twist.linear *= std::min(1.0, v / speed);
    return twist;
  }

  /// Turns towards a heading, with the speed falling off as the error grows.
  Twist steer(double heading, double speed, const Pose& pose) const {
    const double error = wrapped(heading - pose.yaw);
    const double turn = std::clamp(2.0 * error, -model_.max_yaw_rate(), model_.max_yaw_rate());
    const double ahead = std::max(0.0, std::cos(error));
    return stoppable(pose, forward(speed * model_.max_speed() * ahead * ahead * ahead, turn));
  }

  /// Down the cost-to-go.
  Twist descend(double speed, const Pose& pose) const {
    Eigen::Vector2d gradient;
    context_.cost_to_go->value(Eigen::Vector2d(pose.position.head<2>()), gradient);
    if (!gradient.allFinite() || gradient.norm() < 1e-3) return {};
    return steer(std::atan2(-gradient.y(), -gradient.x()), speed, pose);
  }
  Law follow(double speed) const {
    return [=, this](double, const Pose& pose) { return descend(speed, pose); };
  }
  /// Down the cost-to-go with the tail ahead, slower the more the tail is off.
  Law back_off(double speed) const {
    return [=, this](double, const Pose& pose) -> Twist {
      Eigen::Vector2d gradient;
      context_.cost_to_go->value(Eigen::Vector2d(pose.position.head<2>()), gradient);
      if (!gradient.allFinite() || gradient.norm() < 1e-3) return {};
      Pose reversed = pose;
      reversed.yaw += M_PI;
      Twist twist = steer(std::atan2(-gradient.y(), -gradient.x()), speed, reversed);
      twist.linear = -twist.linear;
      return stoppable(pose, twist);
    };
  }
  /// Down the cost-to-go towards a point that far ahead. The path must outlive the law.
  Law pursue(const DescentPath& path, double speed, double lookahead) const {
    return [=, this, &path](double, const Pose& pose) {
      return steer(path.heading(pose.position.head<2>(), lookahead, pose.yaw), speed, pose);
    };
  }
  /// Down the cost-to-go until `from`, then also turning.
  Law follow_then_look(double from, double turn) const {
    return [=, this](double t, const Pose& pose) {
      return t < from ? descend(1.0, pose) : forward(0.0, turn * model_.max_yaw_rate());
    };
  }
  /// Turns to a heading on the spot until it is off by less than `near` [rad], then drives `speed`
  /// along it.
  Law turn_then_go(std::function<double(const Pose&)> heading, double speed,
                   double near = 0.3) const {
    return [=, this](double, const Pose& pose) {
      const double error = wrapped(heading(pose) - pose.yaw);
      if (std::abs(error) < near) return steer(heading(pose), speed, pose);
      return forward(0.0, std::clamp(2.0 * error, -model_.max_yaw_rate(), model_.max_yaw_rate()));
    };
  }
  /// Straight to a place and, from `there` [m] on, to a heading; to the place with at most the
  /// share `speed`, the slower the nearer.
  Law arrive(const Eigen::Vector2d& place, double yaw, double there, double speed) const {
    return [=, this](double, const Pose& pose) {
      const Eigen::Vector2d to = place - pose.position.head<2>();
      const double left = to.norm();
      const bool turn = left < there;
      const double error = wrapped((turn ? yaw : std::atan2(to.y(), to.x())) - pose.yaw);
      const double rate = std::clamp(2.0 * error, -model_.max_yaw_rate(), model_.max_yaw_rate());
      if (turn || std::abs(error) > 0.4) return forward(0.0, rate);
      constexpr double kTime = 1.5;  // [s] in which the way that is left would be gone
      return forward(std::min(speed * model_.max_speed(), left / kTime), rate);
    };
  }
  /// Drives down the cost-to-go without turning there, while facing a heading: for bases that can.
  Law strafe(std::function<double(const Pose&)> heading) const {
    return [=, this](double, const Pose& pose) -> Twist {
      Eigen::Vector2d gradient;
      context_.cost_to_go->value(Eigen::Vector2d(pose.position.head<2>()), gradient);
      if (!gradient.allFinite() || gradient.norm() < 1e-3) return {};
      const Eigen::Vector2d v = -gradient.normalized() * model_.max_speed() * 0.7;
      const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
      const double error = wrapped(heading(pose) - pose.yaw);
      return stoppable(pose,
                       {Eigen::Vector3d(c * v.x() + s * v.y(), -s * v.x() + c * v.y(), 0.0),
                        std::clamp(2.0 * error, -model_.max_yaw_rate(), model_.max_yaw_rate())});
    };
  }

 private:
  static constexpr double kCreep = 0.1;     // share of the largest speed that it may always try
  static constexpr double kSpacing = 0.15;  // [m] between the places that are asked
  // Farther nothing is asked, and so the speed is one from which it can stop by then: 30 m.
  static constexpr int kMostPlaces = 200;

  const MotionModel& model_;
  const SeedContext& context_;
  double dt_;
  double margin_ = 0.0;  // [m]
};

std::function<double(const Pose&)> towards(const Eigen::Vector2d& point) {
  return [point](const Pose& pose) {
    const Eigen::Vector2d d = point - pose.position.head<2>();
    return d.norm() < 1e-6 ? pose.yaw : std::atan2(d.y(), d.x());
  };
}

Seed stop_seed(const Problem& problem) {
  return {"stop", roll(problem, [](double, const Pose&) { return Twist{}; }), true};
}

/// Seeds in the order in which they are added, while there is time.
class SeedList {
 public:
  SeedList(const Problem& problem, const StopCondition& stop) : problem_(problem), stop_(stop) {}

  void add(const std::string& name, const Law& law) {
    if (seeds_.empty() || stop_() == StopRequest::kNone) {
      seeds_.push_back({name, roll(problem_, law)});
    }
  }
  void add(Seed seed) { seeds_.push_back(std::move(seed)); }
  std::vector<Seed> and_stop() && {
    seeds_.push_back(stop_seed(problem_));
    return std::move(seeds_);
  }

 private:
  const Problem& problem_;
  const StopCondition& stop_;
  std::vector<Seed> seeds_;
};

}  // namespace

std::vector<Seed> make_seeds(const Problem& problem, const SeedContext& context) {
  const ProblemDefinition& d = problem.definition();
  const Laws laws(problem, context);
  SeedList seeds(problem, context.stop);

  if (context.previous.cols() > 0) {
    Eigen::MatrixXd inputs(d.N, d.model->nu());
    const Eigen::Index last = context.previous.cols() - 1;
    for (int k = 0; k < d.N; ++k) {
      inputs.row(k) = context.previous.col(std::min<Eigen::Index>(k, last)).transpose();
    }
    seeds.add({"previous", admissible_inputs(problem, problem.knots_from_inputs(inputs))});
  }
  const double horizon = d.N * d.dt;
  seeds.add("follow", laws.follow(1.0));
  seeds.add("follow slowly", laws.follow(0.5));
  seeds.add("follow and look left", laws.follow_then_look(0.5 * horizon, 0.8));
  seeds.add("follow and look right", laws.follow_then_look(0.5 * horizon, -0.8));
  for (const double speed : {1.0, 0.5}) {
    for (const double turn : {0.0, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0}) {
      seeds.add("arc", laws.constant(speed, turn));
    }
  }
  for (const double turn : {1.0, -1.0, 0.5, -0.5}) seeds.add("turn", laws.constant(0.0, turn));
  if (context.target) {
    const auto observation = towards(context.target->looks_at);
    const auto go = towards(context.target->viewpoint);
    seeds.add("face", laws.turn_then_go(observation, 0.0));
    seeds.add("face and go", laws.turn_then_go(observation, 0.7));
    seeds.add("turn and go", laws.turn_then_go(go, 1.0));
    if (d.model->nu() > 2) seeds.add("strafe", laws.strafe(observation));
  }
  if (context.backwards) {
    seeds.add("back", laws.constant(-0.5, 0.0));
    seeds.add("follow backwards", laws.back_off(1.0));
    seeds.add("follow backwards slowly", laws.back_off(0.4));
  }
  return std::move(seeds).and_stop();
}

std::vector<Seed> make_approach_seeds(const Problem& problem, const SeedContext& context) {
  const Laws laws(problem, context);
  SeedList seeds(problem, context.stop);
  if (context.target) {
    const Pose pose = problem.definition().model->pose(problem.definition().x0);
    const double distance = (context.target->viewpoint - pose.position.head<2>()).norm();
    if (distance > 0.2) {
      constexpr double kLength = 3.0;      // [m]
      constexpr double kRoomy = 0.5;       // [m] clearance of a point that is left where it is
      constexpr double kOffMiddle = 0.15;  // [m] that one is moved
      const DescentPath path(*context.cost_to_go, pose.position.head<2>(), kLength);
      seeds.add("approach: go", laws.pursue(path, 0.5, 0.5));
      // Looking less far ahead cuts corners less: what gets through narrow gaps.
      seeds.add("approach: go closely", laws.pursue(path, 0.3, 0.2));
      seeds.add("approach: go slowly", laws.follow(0.25));
      // Where the robot stands beside the middle of a gap, no arc ahead leads into it.
      DescentPath middle = path;
      if (context.clearance != nullptr) {
        middle.centre(*context.clearance, pose.position.z(), kRoomy, kOffMiddle);
      }
      const auto along = [&](const Pose& p) {
        return middle.heading(p.position.head<2>(), 0.1, p.yaw);
      };
      seeds.add("approach: turn and go", laws.turn_then_go(along, 0.2, 0.1));
      if (context.backwards) seeds.add("approach: go backwards", laws.back_off(0.4));
    }
    seeds.add("approach: face", laws.turn_then_go(towards(context.target->looks_at), 0.0));
  } else {
    seeds.add("turn around", laws.constant(0.0, 1.0));
  }
  return std::move(seeds).and_stop();
}

std::vector<Seed> make_arrival_seeds(const Problem& problem, const SeedContext& context,
                                     double there) {
  const Laws laws(problem, context);
  SeedList seeds(problem, context.stop);
  if (context.target) {
    const Eigen::Vector2d goal = context.target->viewpoint;
    const double yaw = context.target->yaw;
    seeds.add("arrive", laws.arrive(goal, yaw, there, 0.5));
    seeds.add("arrive: slowly", laws.arrive(goal, yaw, there, 0.2));
    const Pose pose = problem.definition().model->pose(problem.definition().x0);
    const DescentPath path(*context.cost_to_go, pose.position.head<2>(), 1.0);
    seeds.add("arrive: along the way", laws.pursue(path, 0.3, 0.2));
    seeds.add("arrive: turn", laws.turn_then_go([yaw](const Pose&) { return yaw; }, 0.0));
  }
  return std::move(seeds).and_stop();
}

std::vector<Seed> make_stop_seeds(const Problem& problem) { return {stop_seed(problem)}; }

std::vector<Seed> make_seeds(const Problem& problem, SeedContext context, ModePolicy::Seeds wanted,
                             double there) {
  switch (wanted) {
    case ModePolicy::Seeds::kAll:
      return make_seeds(problem, context);
    case ModePolicy::Seeds::kTurn:
      context.target.reset();
      return make_approach_seeds(problem, context);
    case ModePolicy::Seeds::kApproach:
      return make_approach_seeds(problem, context);
    case ModePolicy::Seeds::kArrive:
      return make_arrival_seeds(problem, context, there);
    case ModePolicy::Seeds::kStop:
      break;
  }
  return make_stop_seeds(problem);
}

}  // namespace prospect
