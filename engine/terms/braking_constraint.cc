#include "engine/terms/braking_constraint.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/terms/clearance_constraint.h"

namespace prospect {
namespace {

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
  blocks.reserve(static_cast<std::size_t>(2 * horizon.N));
  for (int k = 1; k <= horizon.N; ++k) {
    blocks.push_back({k - 1, k, false});
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
  const double per_squared_speed = 0.5 / a;
  Eigen::Vector4d g;
  for (int b = 0; b < t.batch(); ++b) {
    const double d_0 = known_->clearance(t.pose(0, b));
    const double required =
        std::min(options_.margin, std::max(-known_->largest_radius(), d_0 - options_.slack));
    for (int k = 1; k <= N; ++k) {
      s.x = t.states.col(b).segment(k * nx, nx);
      s.u = t.inputs.col(b).segment((k - 1) * nu, nu);
      const double v2 = model.squared_speed(s.x, s.u, request.gradient ? &s.d_x : nullptr,
                                            request.gradient ? &s.d_u : nullptr);
      const double d = known_->clearance(t.pose(k, b), request.gradient ? &g : nullptr);
      out.value(k - 1, b) = d - required - per_squared_speed * v2;
      if (!request.gradient) continue;
      auto d_state = out.jacobian.col(2 * (k - 1));
      d_state.setZero();
      d_state.head(nx) = -per_squared_speed * s.d_x;
      d_state[t.layout.px] += g[0];
      d_state[t.layout.py] += g[1];
      if (t.layout.pz >= 0) d_state[t.layout.pz] += g[2];
      d_state[t.layout.yaw] += g[3];
      auto d_input = out.jacobian.col(2 * (k - 1) + 1);
      d_input.setZero();
      d_input.head(nu) = -per_squared_speed * s.d_u;
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
          std::move(known), ClearanceConstraint::Options{d_safe, floor, 0.005, "known_space"});
    }
    case UnknownPolicy::kBraking:
      return std::make_shared<BrakingConstraint>(std::move(known),
                                                 BrakingConstraint::Options{d_safe, 0.0, 0.005});
  }
  return nullptr;
}

}  // namespace prospect
