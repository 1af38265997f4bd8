#include "engine/admissible_inputs.h"

#include <algorithm>
#include <cmath>

namespace prospect {

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
        model.step(at, input, d.dt, next);
        at.swap(next);
        model.state_constraints(at, c, nullptr);
        if ((c.array() < 0.0).any()) return false;
      }
      return true;
    };
    if (c.size() > 0 && !keeps_speeds(u)) {
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
