// SPDX-License-Identifier: Apache-2.0
#include "solvers/limited_memory_bfgs.h"

#include <algorithm>

namespace prospect {

LimitedMemoryBfgs::LimitedMemoryBfgs(int n, int most)
    : most_(static_cast<std::size_t>(std::max(1, most))), B_(Eigen::MatrixXd::Identity(n, n)) {}

void LimitedMemoryBfgs::update(const Eigen::Ref<const Eigen::VectorXd>& s,
                               const Eigen::Ref<const Eigen::VectorXd>& y) {
  constexpr double kLeastCurvature = 1.5e-8;  // the root of the machine's precision
  constexpr int kMostLeftOut = 2;
  if (s.isZero(0.0)) return;
  if (s.dot(y) > kLeastCurvature * s.norm() * y.norm()) {
    if (pairs_.size() == most_) pairs_.pop_front();
    pairs_.emplace_back(s, y);
    left_out_ = 0;
  } else if (++left_out_ >= kMostLeftOut) {
    pairs_.clear();
    left_out_ = 0;
  }
  B_.setIdentity();
  if (pairs_.empty()) return;
  const auto& [newest_s, newest_y] = pairs_.back();
  B_ *= std::clamp(newest_s.dot(newest_y) / newest_s.squaredNorm(), 1e-8, 1e8);
  for (const auto& [old_s, old_y] : pairs_) {
    Bs_.noalias() = B_ * old_s;
    B_.noalias() -= Bs_ * Bs_.transpose() / old_s.dot(Bs_);
    B_.noalias() += old_y * old_y.transpose() / old_s.dot(old_y);
  }
}

}  // namespace prospect
