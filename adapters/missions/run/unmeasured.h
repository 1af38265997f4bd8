// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "runtime/truth.h"

namespace prospect {

/// What is true of a robot that nobody measures, for its records: the way by the estimate, how
/// often the estimate was lost, all else unknown (NaN). Thread-safety: one thread at a time.
class Unmeasured final : public Truth {
 public:
  TrueState at(const Belief& belief) override {
    if (before_) way_ += (belief.pose.position - *before_).head<2>().norm();
    before_ = belief.pose.position;
    const bool lost = belief.localization == Localization::kLost;
    losses_ += lost && !lost_;
    lost_ = lost;
    return newest();
  }
  TrueState newest() const override {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    TrueState truth;
    truth.pose = {Eigen::Vector3d::Constant(kUnknown), kUnknown};
    truth.coverage = truth.seen_area = truth.localization_error = kUnknown;
    truth.path_length = way_;
    truth.losses = losses_;
    return truth;
  }

 private:
  std::optional<Eigen::Vector3d> before_;
  double way_ = 0.0;
  int losses_ = 0;
  bool lost_ = false;
};

}  // namespace prospect
