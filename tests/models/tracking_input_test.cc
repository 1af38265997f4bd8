// SPDX-License-Identifier: Apache-2.0
#include "models/tracking_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "models/make_model.h"

namespace prospect::tracking_input_test {
namespace {

Eigen::Vector4d stacked(const Twist& t) {
  return {t.linear.x(), t.linear.y(), t.linear.z(), t.yaw_rate};
}

class TrackingInput : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const MotionModel> model_ = make_model(GetParam());
  std::mt19937_64 random_{3};

  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random_);
  }

  Twist twist(double size) {
    Twist t;
    t.linear = {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    t.yaw_rate = uniform(-size, size);
    return t;
  }
  Eigen::VectorXd reached(const Eigen::VectorXd& x, const Eigen::VectorXd& u, double dt) {
    Eigen::VectorXd next(model_->nx());
    model_->step(x, u, dt, next);
    return stacked(model_->twist(next, u));
  }
};

TEST_P(TrackingInput, IsAdmissible) {
  const InputLimits& limits = model_->limits();
  for (int trial = 0; trial < 2000; ++trial) {
    const double dt = uniform(0.02, 0.6);
    const Twist now = twist(1.0);
    const Eigen::VectorXd x = model_->state({Eigen::Vector3d::Zero(), uniform(-9, 9)}, now);
    const Eigen::VectorXd before = model_->input(now).cwiseMax(limits.lower).cwiseMin(limits.upper);
    const double size = trial % 10 == 0 ? 1e6 : 1.0;
    const Eigen::VectorXd u = tracking_input(*model_, x, before, twist(size), dt);
    ASSERT_TRUE(u.allFinite());
    for (int j = 0; j < model_->nu(); ++j) {
      ASSERT_GE(u[j], limits.lower[j]);
      ASSERT_LE(u[j], limits.upper[j]);
      ASSERT_LE(std::abs(u[j] - before[j]), limits.rate[j] * dt + 1e-12);
    }
  }
}

TEST_P(TrackingInput, ReachesExactlyWhatCanBeReached) {
  const InputLimits& limits = model_->limits();
  for (int trial = 0; trial < 2000; ++trial) {
    const double dt = uniform(0.05, 0.5);
    const Twist now = twist(0.4);
    const Eigen::VectorXd x = model_->state({Eigen::Vector3d::Zero(), uniform(-9, 9)}, now);
    const Eigen::VectorXd before = model_->input(now).cwiseMax(limits.lower).cwiseMin(limits.upper);
    // A velocity that some admissible input gives.
    Eigen::VectorXd u(model_->nu());
    for (int j = 0; j < model_->nu(); ++j) {
      const double reach = std::min(limits.rate[j] * dt, 100.0);
      u[j] = std::clamp(before[j] + uniform(-reach, reach), limits.lower[j], limits.upper[j]);
    }
    const Eigen::Vector4d wanted = reached(x, u, dt);
    const Twist desired{wanted.head<3>(), wanted[3]};
    const Eigen::Vector4d got = reached(x, tracking_input(*model_, x, before, desired, dt), dt);
    ASSERT_LT((got - wanted).norm(), 1e-8);
  }
}

TEST_P(TrackingInput, ComesToRestWhenAskedForRest) {
  const InputLimits& limits = model_->limits();
  for (int trial = 0; trial < 200; ++trial) {
    const Twist now = twist(0.5);
    Eigen::VectorXd x = model_->state({Eigen::Vector3d::Zero(), uniform(-9, 9)}, now);
    Eigen::VectorXd u = model_->input(now).cwiseMax(limits.lower).cwiseMin(limits.upper);
    Eigen::VectorXd next(model_->nx());
    for (int k = 0; k < 40; ++k) {
      u = tracking_input(*model_, x, u, Twist{}, 0.25);
      model_->step(x, u, 0.25, next);
      x = next;
    }
    EXPECT_LT(stacked(model_->twist(x, u)).norm(), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, TrackingInput, ::testing::ValuesIn(model_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace prospect::tracking_input_test
