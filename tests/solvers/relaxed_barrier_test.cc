// SPDX-License-Identifier: Apache-2.0
#include "solvers/relaxed_barrier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "problems/zoo.h"

namespace prospect::relaxed_barrier_test {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

TEST(RelaxedBarrier, IsALogarithmAboveItsWidthAndGoesOnSmoothlyBelow) {
  const double mu = 0.3, delta = 0.05, margin = 0.01;
  const RelaxedBarrier barrier(mu, delta, margin);
  EXPECT_DOUBLE_EQ(barrier.value(vec({0.51, 3.01})), -mu * (std::log(0.5) + std::log(3.0)));
  EXPECT_NEAR(barrier.multipliers(vec({0.51}))[0], mu / 0.5, 1e-15);
  const double h = 1e-7, edge = delta + margin;
  EXPECT_NEAR(barrier.value(vec({edge - h})), barrier.value(vec({edge + h})), 1e-5);
  EXPECT_NEAR(barrier.multipliers(vec({edge - h}))[0], barrier.multipliers(vec({edge + h}))[0],
              1e-4);
  for (const double c : {-3.0, -0.1, 0.0, 0.02, 0.3}) {
    const double slope = (barrier.value(vec({c + h})) - barrier.value(vec({c - h}))) / (2.0 * h);
    EXPECT_NEAR(-barrier.multipliers(vec({c}))[0], slope, 1e-6 * (1.0 + std::abs(slope))) << c;
  }
}

TEST(RelaxedBarrier, HasRowsOfItsValueGradientAndHessian) {
  const FunctionProblem p = zoo::hs43();
  const double mu = 0.2;
  const RelaxedBarrier barrier(mu, 0.5, 0.01);
  double constant = std::numeric_limits<double>::quiet_NaN();
  // Inside, near an edge, and where all three are violated.
  for (const Vector& x : {vec({0, 0, 0, 0}), vec({0, 1, 1.9, -0.9}), vec({2, -1, 3, 1})}) {
    const Vector c = p.c(x);
    const Matrix J_c = p.J(x);
    Vector r(4);
    ResidualJacobian J(4, 4);
    barrier.residuals(c, r);
    barrier.residual_jacobian(c, J_c, J);
    if (std::isnan(constant)) constant = 0.5 * r.squaredNorm() - barrier.value(c);
    EXPECT_NEAR(0.5 * r.squaredNorm() - barrier.value(c), constant, 1e-10);
    const Vector gradient = -J_c.transpose() * barrier.multipliers(c);
    EXPECT_LE((J.transpose() * r - gradient).norm(), 1e-12 * (1.0 + gradient.norm()));
    const double h = 1e-6;
    Matrix hessian = Matrix::Zero(4, 4);
    for (int i = 0; i < 3; ++i) {
      const Vector e = Vector::Unit(3, i) * h;
      const double curvature =
          (barrier.multipliers(c - e)[i] - barrier.multipliers(c + e)[i]) / (2.0 * h);
      hessian += curvature * J_c.row(i).transpose() * J_c.row(i);
    }
    EXPECT_LE((J.transpose() * J - hessian).norm(), 1e-6 * (1.0 + hessian.norm()));
  }
}

}  // namespace
}  // namespace prospect::relaxed_barrier_test
