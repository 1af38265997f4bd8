// SPDX-License-Identifier: Apache-2.0
#include "solvers/descent_direction.h"

#include <gtest/gtest.h>

namespace prospect::descent_direction_test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const MatrixXd kNone(0, 3);
const Vector3d kInside = Vector3d::Constant(0.5);

TEST(DescentDirection, IsTheNegativeGradientInside) {
  EXPECT_EQ(descent_direction(Vector3d(1, -2, 3), kNone, kInside), Vector3d(-1, 2, -3));
}

TEST(DescentDirection, DoesNotLeaveTheBounds) {
  // At the lower bound of 0 and 2, at the upper one of 1; the cost falls outwards along 0 and 1.
  EXPECT_TRUE(descent_direction(Vector3d(1, -2, -3), kNone, Vector3d(0, 1, 0))
                  .isApprox(Vector3d(0, 0, 3), 1e-12));
}

TEST(DescentDirection, SlidesAlongActiveConstraints) {
  MatrixXd A(1, 3);
  A << 1, 1, 0;  // x + y may not fall
  const VectorXd d = descent_direction(Vector3d(2, 0, 1), A, kInside);
  EXPECT_TRUE(d.isApprox(Vector3d(-1, 1, -1), 1e-12)) << d.transpose();
  // One that the cost does not press against stays out of it.
  A << -1, -1, 0;
  EXPECT_TRUE(descent_direction(Vector3d(2, 0, 1), A, kInside).isApprox(Vector3d(-2, 0, -1)));
}

TEST(DescentDirection, IsZeroWhereMultipliersExist) {
  MatrixXd A(3, 3);
  A << 1, 0.5, 0, 0, 1, 0.25, 1, 1.5, 0.25;  // the last row is the sum of the others
  const VectorXd g = A.transpose() * Vector3d(0.3, 0.0, 2.0) + Vector3d(0, 0, 1.5);
  EXPECT_LT(descent_direction(g, A, Vector3d(0.5, 0.5, 0)).norm(), 1e-12);
  EXPECT_GT(descent_direction(g, A, kInside).norm(), 0.1);
}

}  // namespace
}  // namespace prospect::descent_direction_test
