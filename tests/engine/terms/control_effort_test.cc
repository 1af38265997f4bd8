// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/control_effort.h"

#include <gtest/gtest.h>

#include <limits>

#include "engine/terms/input_rate.h"
#include "engine/terms/input_scale.h"
#include "models/multirotor.h"
#include "models/unicycle.h"
#include "tests/engine/term_derivatives.h"
#include "tests/engine/view_worlds.h"

namespace prospect::control_effort_test {
namespace {

TEST(InputScale, CountsAnInputAtItsBoundAsOne) {
  InputLimits limits;
  const double inf = std::numeric_limits<double>::infinity();
  limits.lower = Eigen::Vector4d(-0.2, -2.0, -inf, 0.0);
  limits.upper = Eigen::Vector4d(0.5, 1.0, 1.0, 0.0);
  EXPECT_TRUE(input_scale(limits).isApprox(Eigen::Vector4d(4.0, 0.25, 1.0, 1.0)));
}

TEST(ControlEffort, IsTheMeanOfTheScaledSquares) {
  std::mt19937_64 random(1);
  const Unicycle unicycle;
  const Multirotor multirotor;
  for (const MotionModel* model :
       {static_cast<const MotionModel*>(&unicycle), static_cast<const MotionModel*>(&multirotor)}) {
    Eigen::VectorXd desired(model->nu());
    for (double& v : desired) v = test::uniform(random, -0.3, 0.3);
    const ControlEffort effort(desired, model->limits());
    const InputRate rate(model->limits());
    const Eigen::VectorXd R = input_scale(model->limits());
    const TrajectoryBatch t = test::random_trajectories(*model, 7, 0.2, 5, random);
    const TermOutput e = test::evaluate(effort, t, false), d = test::evaluate(rate, t, false);
    for (int b = 0; b < 5; ++b) {
      double effort_sum = 0.0, rate_sum = 0.0;
      for (int k = 0; k < 7; ++k) {
        for (int j = 0; j < model->nu(); ++j) {
          const double before = k > 0 ? t.u(k - 1, j, b) : t.u_previous[j];
          effort_sum += R[j] * std::pow(t.u(k, j, b) - desired[j], 2);
          rate_sum += R[j] * std::pow(t.u(k, j, b) - before, 2);
        }
      }
      EXPECT_NEAR(e.value(0, b), effort_sum / 7, 1e-12);
      EXPECT_NEAR(d.value(0, b), rate_sum / 7, 1e-12);
    }
    const TrajectoryBatch one = test::random_trajectories(*model, 7, 0.2, 1, random);
    test::expect_derivative_matches_differences(effort, one, 0, 1e-5, 1e-7);
    test::expect_derivative_matches_differences(rate, one, 0, 1e-5, 1e-7);
  }
}

TEST(ControlEffort, RefusesADesiredInputThatDoesNotFit) {
  const Unicycle model;
  EXPECT_THROW(ControlEffort(Eigen::VectorXd::Zero(3), model.limits()), std::invalid_argument);
  EXPECT_THROW(ControlEffort(Eigen::Vector2d(std::nan(""), 0.0), model.limits()),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::control_effort_test
