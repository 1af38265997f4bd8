// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/speed_limit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "models/multirotor.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"
#include "tests/engine/term_derivatives.h"

namespace prospect::speed_limit_test {
namespace {

TEST(SpeedLimit, HoldsTheModelsStateBoundsAtEveryStageToChoose) {
  std::mt19937_64 random(2);
  const Unicycle unicycle;
  const UnicycleAccel accel;
  const Multirotor multirotor;
  EXPECT_EQ(SpeedLimit(unicycle).rows({&unicycle, 10, 0.25}), 0);
  for (const MotionModel* model :
       {static_cast<const MotionModel*>(&accel), static_cast<const MotionModel*>(&multirotor)}) {
    const SpeedLimit term(*model);
    const int n = model->num_state_constraints();
    ASSERT_GT(n, 0);
    const TrajectoryBatch t = test::random_trajectories(*model, 8, 0.25, 40, 0.6, random);
    const TermOutput out = test::evaluate(term, t, false);
    ASSERT_EQ(out.value.rows(), 8 * n);
    int violated = 0;
    for (int b = 0; b < 40; ++b) {
      for (int k = 1; k <= 8; ++k) {
        Eigen::VectorXd x(model->nx()), u(model->nu());
        for (int i = 0; i < model->nx(); ++i) x[i] = t.x(k, i, b);
        for (int j = 0; j < model->nu(); ++j) u[j] = 0.0;
        const double least = out.value.col(b).segment((k - 1) * n, n).minCoeff();
        const double speed = std::sqrt(model->squared_speed(x, u, nullptr, nullptr));
        if (least >= 0.0) {
          EXPECT_LE(speed, model->max_speed() + 1e-9);
        }
        if (speed > model->max_speed()) {
          EXPECT_LT(least, 0.0);
        }
        violated += least < 0.0;
      }
    }
    EXPECT_GT(violated, 0);
    EXPECT_LT(violated, 320);
    const TrajectoryBatch one = test::random_trajectories(*model, 5, 0.25, 1, 0.6, random);
    test::expect_derivative_matches_differences(term, one, 0, 1e-5, 1e-7);
  }
}

}  // namespace
}  // namespace prospect::speed_limit_test
