// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/admissible_inputs.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

// Of slow zones: the deceleration that a plan counts on, as a share of what its knots leave and at
// most [m/s^2], and how far before a zone it is slow enough [m].
constexpr double kShare = 0.5;
constexpr double kMostDeceleration = 100.0;
constexpr double kEarly = 0.05;

}  // namespace

Eigen::VectorXd admissible_inputs(const Problem& problem,
                                  const Eigen::Ref<const Eigen::VectorXd>& z) {
  const ProblemDefinition& d = problem.definition();
  const MotionModel& model = *d.model;
  const InputLimits& limits = model.limits();
  const int nu = model.nu();
  Eigen::VectorXd result = z;
  Eigen::VectorXd x = d.x0, at = d.x0, next(model.nx());
  Eigen::VectorXd before = d.u_previous;
  Eigen::VectorXd c(model.num_state_constraints());
  const ZoneMap* zones = d.zones != nullptr && d.zones->slows() ? d.zones.get() : nullptr;
  const double deceleration =
      std::min(kMostDeceleration, kShare * model.max_deceleration() * d.M / d.N);
  const auto slow_enough = [&](const Eigen::VectorXd& state, const Eigen::VectorXd& input) {
    const double most =
        zones->approach_speed(model.pose(state).position.head<2>(), deceleration, kEarly);
    return model.twist(state, input).linear.norm() <= most;
  };

  const auto clamp = [&](Eigen::VectorXd& u) {
    for (int j = 0; j < nu; ++j) {
      const double reach = limits.rate[j] * d.dt;
      if (std::isfinite(reach)) u[j] = std::clamp(u[j], before[j] - reach, before[j] + reach);
      u[j] = std::clamp(u[j], limits.lower[j], limits.upper[j]);
    }
  };
  for (int k = 0; k < d.N;) {
    const int m = problem.knot(k);
    int stages = 1;
    while (k + stages < d.N && problem.knot(k + stages) == m) ++stages;
    Eigen::VectorXd u = z.segment(m * nu, nu);
    clamp(u);
    const auto keeps_speeds = [&](const Eigen::VectorXd& input) {
      at = x;
      for (int s = 0; s < stages; ++s) {
        if (zones != nullptr) {
          // The velocity at the start of a stage can be chosen only where it is the input.
          if (c.size() == 0 && !slow_enough(at, input)) return false;
          for (const double share : {0.5, 1.0}) {
            model.step(at, input, share * d.dt, next);
            if (!slow_enough(next, input)) return false;
          }
        }
        model.step(at, input, d.dt, next);
        at.swap(next);
        if (c.size() == 0) continue;
        model.state_constraints(at, c, nullptr);
        if ((c.array() < 0.0).any()) return false;
      }
      return true;
    };
    if ((c.size() > 0 || zones != nullptr) && !keeps_speeds(u)) {
      const Eigen::VectorXd brake = model.braking_input(x, before, stages * d.dt);
      const auto blend = [&](double s) {
        Eigen::VectorXd v = brake + s * (u - brake);
        clamp(v);
        return v;
      };
      double low = 0.0, high = 1.0;
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (low + high);
        (keeps_speeds(blend(middle)) ? low : high) = middle;
      }
      u = blend(low);
    }
    result.segment(m * nu, nu) = u;
    before = u;
    for (int s = 0; s < stages; ++s) {
      model.step(x, u, d.dt, next);
      x.swap(next);
    }
    k += stages;
  }
  return result;
}

}  // namespace prospect
