// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/rate_limit.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace prospect {

RateLimit::RateLimit(const InputLimits& limits, int knots) : knots_(knots) {
  if (knots < 0) {
    throw std::invalid_argument("rate limit: knots is " + std::to_string(knots) +
                                "; expected >= 0");
  }
  for (Eigen::Index j = 0; j < limits.rate.size(); ++j) {
    if (std::isfinite(limits.rate[j])) limited_.emplace_back(static_cast<int>(j), limits.rate[j]);
  }
}

TermTraits RateLimit::traits() const {
  return {TermKind::kConstraint, Smoothness::kSmooth, true, "unit of u", "none"};
}

bool RateLimit::changes(int stage, int N) const {
  if (stage == 0 || knots_ == 0 || knots_ >= N) return true;
  return stage * knots_ / N != (stage - 1) * knots_ / N;
}

int RateLimit::rows(const Horizon& horizon) const {
  int stages = 0;
  for (int k = 0; k < horizon.N; ++k) stages += changes(k, horizon.N);
  return stages * 2 * static_cast<int>(limited_.size());
}

std::vector<JacobianBlock> RateLimit::jacobian_pattern(const Horizon& horizon) const {
  std::vector<JacobianBlock> pattern;
  int row = 0;
  for (int k = 0; k < horizon.N; ++k) {
    if (!changes(k, horizon.N)) continue;
    for (std::size_t j = 0; j < 2 * limited_.size(); ++j, ++row) {
      pattern.push_back({row, k, true});
      if (k > 0) pattern.push_back({row, k - 1, true});
    }
  }
  return pattern;
}

void RateLimit::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                         TermOutput& out) const {
  const int N = t.horizon.N, nu = t.horizon.nu();
  int row = 0;
  Eigen::Index block = 0;
  for (int k = 0; k < N; ++k) {
    if (!changes(k, N)) continue;
    for (const auto& [j, rate] : limited_) {
      const double allowed = rate * t.horizon.dt;
      for (const double sign : {-1.0, 1.0}) {
        for (int b = 0; b < t.batch(); ++b) {
          const double before = k > 0 ? t.u(k - 1, j, b) : t.u_previous[j];
          out.value(row, b) = allowed + sign * (t.u(k, j, b) - before);
        }
        if (request.gradient) {
          out.jacobian.col(block).head(nu).setZero();
          out.jacobian(j, block++) = sign;
          if (k > 0) {
            out.jacobian.col(block).head(nu).setZero();
            out.jacobian(j, block++) = -sign;
          }
        }
        ++row;
      }
    }
  }
}

}  // namespace prospect
