// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/braking_constraint.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/terms/clearance_constraint.h"

namespace prospect {
namespace {

constexpr double kAtRest = 1e-3;    // [m] of way in a stage below which its direction fades
constexpr double kStanding = 1e-2;  // [m/s] below which a speed is rounded off

/// Where the robot comes to rest, and its derivatives.
struct Stop {
  Pose pose;
  // From pose's position: along, and to the left [-]; both of the way that is left, `length` [m].
  Eigen::Vector3d along, left;
  double length = 0.0;
  double c = 1.0, s = 0.0;        // of the angle from the way before it to the way that is left
  double per_way = 0.0;           // 1 / |D| [1/m]
  double turn_per_turn = 0.0;     // d theta / d delta [-]
  double turn_per_squared = 0.0;  // d theta / d |v|^2 [rad s^2/m^2]
};

Stop stop_from(const Pose& before, const Pose& pose, double squared_speed, double a, double dt) {
  Stop stop;
  const Eigen::Vector3d way = pose.position - before.position;
  const double turned = pose.yaw - before.yaw;
  const double rounded = std::sqrt(squared_speed + kStanding * kStanding);
  stop.length = squared_speed / (2.0 * a);
  stop.turn_per_turn = (rounded - kStanding) / (2.0 * a * dt);
  stop.turn_per_squared = turned / (4.0 * a * dt * rounded);
  const double turn = stop.turn_per_turn * turned;
  stop.per_way = 1.0 / std::sqrt(way.squaredNorm() + kAtRest * kAtRest);
  stop.c = std::cos(0.5 * (turned + turn));
  stop.s = std::sin(0.5 * (turned + turn));
  const Eigen::Vector3d h = way * stop.per_way;
  stop.along = {stop.c * h.x() - stop.s * h.y(), stop.s * h.x() + stop.c * h.y(), h.z()};
  stop.left = {-stop.along.y(), stop.along.x(), 0.0};
  stop.pose = {pose.position + stop.length * stop.along, pose.yaw + turn};
  return stop;
}

struct BrakingScratch final : TermScratch {
  explicit BrakingScratch(const Horizon& horizon)
      : x(horizon.nx()), u(horizon.nu()), d_x(horizon.nx()), d_u(horizon.nu()) {}
  Eigen::VectorXd x, u, d_x, d_u;
};

}  // namespace

BrakingConstraint::BrakingConstraint(std::shared_ptr<const BodyClearance> known, Options options)
    : known_(std::move(known)), options_(options) {
  if (known_ == nullptr) throw std::invalid_argument("braking constraint: no clearance");
  if (known_->field().options().obstacles != ClearanceField::Obstacles::kOccupiedAndUnknown) {
    throw std::invalid_argument(
        "braking constraint: the clearance ignores unknown space; expected a field with "
        "kOccupiedAndUnknown");
  }
  if (!(options_.margin >= 0.0) || !(options_.slack >= 0.0) || !std::isfinite(options_.slack) ||
      !(options_.deceleration >= 0.0) || !std::isfinite(options_.deceleration)) {
    throw std::invalid_argument(
        "braking constraint: margin, slack and deceleration are " +
        std::to_string(options_.margin) + ", " + std::to_string(options_.slack) + ", " +
        std::to_string(options_.deceleration) + "; expected finite numbers >= 0");
  }
  if (!(known_->saturation() > options_.margin)) {
    throw std::invalid_argument("braking constraint: the clearance saturates at " +
                                std::to_string(known_->saturation()) +
                                " m; expected above the margin, " +
                                std::to_string(options_.margin) + " m (raise the field's cutoff)");
  }
}

TermTraits BrakingConstraint::traits() const {
  return {TermKind::kConstraint, Smoothness::kC1, true, "m", "none"};
}

std::vector<JacobianBlock> BrakingConstraint::jacobian_pattern(const Horizon& horizon) const {
  std::vector<JacobianBlock> blocks;
  blocks.reserve(static_cast<std::size_t>(3 * horizon.N));
  for (int k = 1; k <= horizon.N; ++k) {
    blocks.push_back({k - 1, k, false});
    blocks.push_back({k - 1, k - 1, false});
    blocks.push_back({k - 1, k - 1, true});
  }
  return blocks;
}

std::unique_ptr<TermScratch> BrakingConstraint::make_scratch(const Horizon& horizon, int) const {
  return std::make_unique<BrakingScratch>(horizon);
}

void BrakingConstraint::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                                 TermScratch* scratch, TermOutput& out) const {
  const MotionModel& model = *t.horizon.model;
  const int N = t.horizon.N;
  const int nx = t.horizon.nx();
  const int nu = t.horizon.nu();
  auto& s = static_cast<BrakingScratch&>(*scratch);
  const double a = options_.deceleration > 0.0 ? options_.deceleration : model.max_deceleration();
  Eigen::Vector4d g;
  for (int b = 0; b < t.batch(); ++b) {
    Pose before = t.pose(0, b);
    const double d_0 = known_->clearance(before);
    const double required =
        std::min(options_.margin, std::max(-known_->largest_radius(), d_0 - options_.slack));
    for (int k = 1; k <= N; ++k) {
      s.x = t.states.col(b).segment(k * nx, nx);
      s.u = t.inputs.col(b).segment((k - 1) * nu, nu);
      const double v2 = model.squared_speed(s.x, s.u, request.gradient ? &s.d_x : nullptr,
                                            request.gradient ? &s.d_u : nullptr);
      const Pose pose = t.pose(k, b);
      const Stop stop = stop_from(before, pose, v2, a, t.horizon.dt);
      before = pose;
      out.value(k - 1, b) =
          known_->clearance(stop.pose, request.gradient ? &g : nullptr) - required;
      if (!request.gradient) continue;
      const Eigen::Vector3d g_p = g.head<3>();
      // Of half the angle by which the way to the stop is turned from the way before it.
      const double by_half = stop.length * g_p.dot(stop.left);
      const double by_turn = g[3] + 0.5 * by_half;
      const double by_turned = 0.5 * by_half + by_turn * stop.turn_per_turn;
      const double by_squared = g_p.dot(stop.along) / (2.0 * a) + by_turn * stop.turn_per_squared;
      // Of D: what is across the way turns it.
      const Eigen::Vector3d across = g_p - stop.along * stop.along.dot(g_p);
      const double share = stop.length * stop.per_way;
      const Eigen::Vector3d by_way(share * (stop.c * across.x() + stop.s * across.y()),
                                   share * (stop.c * across.y() - stop.s * across.x()),
                                   share * across.z());
      const Eigen::Vector3d by_position = g_p + by_way;
      const auto block = static_cast<Eigen::Index>(3 * (k - 1));
      out.set_pose_block(t, block, by_position.x(), by_position.y(), by_position.z(),
                         g[3] + by_turned);
      out.jacobian.col(block).head(nx) += by_squared * s.d_x;
      out.set_pose_block(t, block + 1, -by_way.x(), -by_way.y(), -by_way.z(), -by_turned);
      auto d_input = out.jacobian.col(block + 2);
      d_input.setZero();
      d_input.head(nu) = by_squared * s.d_u;
    }
  }
}

std::shared_ptr<const Term> unknown_space_constraint(UnknownPolicy policy,
                                                     std::shared_ptr<const BodyClearance> known,
                                                     double d_safe) {
  switch (policy) {
    case UnknownPolicy::kFree:
      return nullptr;
    case UnknownPolicy::kBlocked: {
      if (known == nullptr) throw std::invalid_argument("known_space constraint: no clearance");
      // The border of the known is no wall: a robot may stand half in it, as it does at the start.
      const double floor = std::min(d_safe, -known->largest_radius());
      return std::make_shared<ClearanceConstraint>(
          std::move(known),
          ClearanceConstraint::Options{d_safe, floor, 0.005, "known_space", TermQuantity::kOther});
    }
    case UnknownPolicy::kBraking:
      return std::make_shared<BrakingConstraint>(std::move(known),
                                                 BrakingConstraint::Options{d_safe, 0.0, 0.005});
  }
  return nullptr;
}

}  // namespace prospect
